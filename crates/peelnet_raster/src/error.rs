/// What can go wrong between a scene and its fragments.
#[derive(Debug, thiserror::Error)]
pub enum RasterError {
    /// The GPU.
    #[error("{0}")]
    Gpu(#[from] peelnet_gpu::GpuError),
    /// A shader did not link.
    #[error(transparent)]
    Shader(#[from] peelnet_shaders::ShaderError),
    /// A frame without pixels.
    #[error("a frame of {width}×{height} pixels: both sides must be at least 1")]
    EmptyFrame {
        /// Requested width.
        width: u32,
        /// Requested height.
        height: u32,
    },
    /// One pixel alone has more fragments than storage holds.
    #[error(
        "{fragments} fragments lie in one pixel but storage holds {capacity}; \
         raise the budget, or use single peeling, which needs no storage per fragment"
    )]
    PixelOverBudget {
        /// Fragments in the fullest pixel.
        fragments: u64,
        /// Fragments that storage holds.
        capacity: u64,
    },
    /// The check of a frame's fragments found some that are wrong.
    #[error(
        "the fragments of this frame are wrong: {} out of order, {} lost, {} found twice, the last at pixel ({}, {}). This is a fault of \
         peelnet or of the GPU's driver: please report it with what `peelnet doctor` prints. Depth peeling needs no sort",
        .0.unsorted, .0.lost, .0.uncounted, .0.pixel[0], .0.pixel[1]
    )]
    Faults(crate::count::Faults),
    /// More fragments than 32-bit offsets can count.
    #[error(
        "a frame holds {0} fragments or more, beyond what 32-bit offsets can count; draw it in smaller frames"
    )]
    TooManyFragments(u64),
    /// More lights than a shader loops over.
    #[error("the scene has {0} lights, and at most {most} are drawn; give it fewer, brighter ones", most = peelnet_scene::MAX_LIGHTS)]
    TooManyLights(usize),
    /// An object or a part of one that the scene does not have.
    #[error("the scene has no {what} {index}; it has {count}")]
    NoSuch {
        /// `object`, or `part` of an object.
        what: &'static str,
        /// The index asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
}
