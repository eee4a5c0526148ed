use std::path::PathBuf;

/// What can go wrong while a scene is drawn.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The GPU.
    #[error("{0}")]
    Gpu(#[from] crate::gpu::GpuError),
    /// A shader did not link.
    #[error(transparent)]
    Shader(#[from] crate::shaders::ShaderError),
    /// Not a method's name, a parameter that the method does not have, a value it cannot take, or a model of another method.
    #[error("{0}")]
    WrongValue(String),
    /// A learned method without its network.
    #[error("method {0} draws with a trained network, and none was given")]
    NeedsModel(String),
    /// What is not drawn, or not like that.
    #[error("{0}")]
    Refused(String),
    /// A scene that holds what a method cannot draw.
    #[error("{0}")]
    Scene(String),
    /// A target that a frame cannot be drawn onto.
    #[error("the target cannot be drawn onto: {0}")]
    Target(String),
    /// An image file could not be written.
    #[error("cannot write image {path}: {message}")]
    Image {
        /// The file.
        path: PathBuf,
        /// The reason.
        message: String,
    },
}

/// One pixel alone has more fragments than storage holds.
pub(crate) fn over_budget(fragments: u64, capacity: u64) -> RenderError {
    RenderError::Refused(format!(
        "{fragments} fragments lie in one pixel but storage holds {capacity}; raise the budget, or use single peeling, which needs no \
         storage per fragment"
    ))
}
