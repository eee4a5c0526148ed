use std::path::PathBuf;

/// What can go wrong while drawing.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The GPU.
    #[error(transparent)]
    Gpu(#[from] peelnet_gpu::GpuError),
    /// A shader did not link.
    #[error(transparent)]
    Shader(#[from] peelnet_shaders::ShaderError),
    /// Not a method's name.
    #[error("there is no method '{name}'; there are: {known}")]
    UnknownMethod {
        /// What was asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A parameter that the method does not have, a value it cannot take, or a model that was trained for another method.
    #[error("method {method}: {message}")]
    Parameter {
        /// The method.
        method: String,
        /// What is wrong and what would be right.
        message: String,
    },
    /// A learned method without its network.
    #[error("method {0} draws with a trained network: give its model file with --model")]
    NeedsModel(String),
    /// Light that takes a colour where it passes, and a method that keeps one transmittance for all colours.
    #[error(
        "{0} keeps one transmittance a pixel, and this scene's transmission is coloured: draw it at full resolution with one of {tinted}, \
         or make transmission_color grey",
        tinted = crate::methods::tinted()
    )]
    OneTransmittance(String),
    /// A frame without pixels.
    #[error("a frame of {width}×{height} pixels: both sides must be at least 1")]
    EmptyFrame {
        /// Width asked for.
        width: u32,
        /// Height asked for.
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
    /// More fragments than 32-bit offsets can count.
    #[error(
        "a frame holds {0} fragments or more, beyond what 32-bit offsets can count; draw it in smaller frames"
    )]
    TooManyFragments(u64),
    /// An image file could not be written.
    #[error("cannot write image {path}: {message}")]
    Image {
        /// The file.
        path: PathBuf,
        /// The reason.
        message: String,
    },
}
