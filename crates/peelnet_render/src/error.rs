use peelnet_raster::RasterError;
use std::path::PathBuf;

/// What can go wrong while drawing.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The GPU.
    #[error("{0}")]
    Gpu(#[from] peelnet_gpu::GpuError),
    /// A shader did not link.
    #[error(transparent)]
    Shader(#[from] peelnet_shaders::ShaderError),
    /// A frame, or the fragments of one.
    #[error(transparent)]
    Raster(RasterError),
    /// Not a method's name.
    #[error("there is no method '{name}'; there are: {known}")]
    UnknownMethod {
        /// The name asked for.
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
    #[error("method {0} draws with a trained network, and none was given")]
    NeedsModel(String),
    /// What a method does not draw, or not like that.
    #[error("{0}")]
    Refused(String),
    /// A target that a frame cannot be drawn onto.
    #[error("the target cannot be drawn onto: {0}")]
    Target(String),
    /// A number of samples that WebGPU does not have.
    #[error("a pixel has 1 or 4 samples, not {0}")]
    Samples(u32),
    /// An image file could not be written.
    #[error("cannot write image {path}: {message}")]
    Image {
        /// The file.
        path: PathBuf,
        /// The reason.
        message: String,
    },
}

impl From<RasterError> for RenderError {
    fn from(e: RasterError) -> Self {
        match e {
            RasterError::Gpu(e) => Self::Gpu(e),
            RasterError::Shader(e) => Self::Shader(e),
            e => Self::Raster(e),
        }
    }
}
