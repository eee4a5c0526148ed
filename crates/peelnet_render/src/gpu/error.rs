/// What can go wrong between us and a GPU.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say what the fields are")]
pub enum GpuError {
    #[error("no GPU adapter: {}", crate::gpu::adapter::why_none())]
    NoAdapter,
    #[error("no adapter matches '{wanted}'; the adapters are: {available}")]
    NoSuchAdapter { wanted: String, available: String },
    #[error("adapter '{adapter}' gave no device: {source}")]
    Device {
        adapter: String,
        source: wgpu::RequestDeviceError,
    },
    #[error("{what} needs {feature}, which adapter '{adapter}' does not have; {hint}")]
    MissingFeature {
        what: String,
        feature: &'static str,
        adapter: String,
        hint: &'static str,
    },
    #[error("{what} needs {needed} {unit} but adapter '{adapter}' allows {limit}; {hint}")]
    TooLarge {
        what: String,
        needed: u64,
        limit: u64,
        unit: &'static str,
        adapter: String,
        hint: &'static str,
    },
    #[error(
        "{what}: adapter '{adapter}' has no {needed} bytes of memory left; close other programs, draw a smaller frame, or use a software adapter"
    )]
    OutOfMemory {
        what: String,
        needed: u64,
        adapter: String,
    },
    #[error(
        "adapter '{0}' has no memory left for what was to be drawn; close other programs, or draw a smaller scene or frame"
    )]
    MemoryFull(String),
    #[error("the GPU device was lost or did not answer: {0}; run again, or use a software adapter")]
    Lost(String),
    #[error("the GPU refused a command (this is a bug in peelnet): {0}")]
    Validation(String),
}
