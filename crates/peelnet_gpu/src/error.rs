/// What can go wrong between us and a GPU.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No driver offers any adapter.
    #[error("no GPU adapter: {}", crate::adapter::why_none())]
    NoAdapter,
    /// The adapter that was asked for is not there.
    #[error("no adapter matches '{wanted}'; the adapters are: {available}")]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// Names of the adapters there are.
        available: String,
    },
    /// The adapter refused to open a device.
    #[error("adapter '{adapter}' gave no device: {source}")]
    Device {
        /// Adapter name.
        adapter: String,
        /// wgpu's reason.
        source: wgpu::RequestDeviceError,
    },
    /// Something needs an optional feature that the adapter lacks.
    #[error("{what} needs {feature}, which adapter '{adapter}' does not have; {hint}")]
    MissingFeature {
        /// Who needs it.
        what: String,
        /// The feature's name.
        feature: &'static str,
        /// Adapter name.
        adapter: String,
        /// What to do instead.
        hint: &'static str,
    },
    /// A buffer or texture beyond the adapter's limits.
    #[error("{what} needs {needed} {unit} but adapter '{adapter}' allows {limit}; {hint}")]
    TooLarge {
        /// What was to be made.
        what: String,
        /// What it needs.
        needed: u64,
        /// What is allowed.
        limit: u64,
        /// What both are counted in: bytes, or pixels a side.
        unit: &'static str,
        /// Adapter name.
        adapter: String,
        /// What to do instead.
        hint: &'static str,
    },
    /// The GPU's memory is full.
    #[error(
        "{what}: adapter '{adapter}' has no {needed} bytes of memory left; close other programs, draw a smaller frame, or use a software adapter"
    )]
    OutOfMemory {
        /// What was to be made.
        what: String,
        /// Bytes it needs.
        needed: u64,
        /// Adapter name.
        adapter: String,
    },
    /// The GPU's memory is full, and the driver does not say what did not fit.
    #[error(
        "adapter '{0}' has no memory left for what was to be drawn; close other programs, or draw a smaller scene or frame"
    )]
    MemoryFull(String),
    /// The device stopped answering.
    #[error("the GPU device was lost or did not answer: {0}; run again, or use a software adapter")]
    Lost(String),
    /// wgpu refused a command: a bug in this project, never the user's fault.
    #[error("the GPU refused a command (this is a bug in peelnet): {0}")]
    Validation(String),
}
