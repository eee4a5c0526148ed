/// What can go wrong while peeling.
#[derive(Debug, thiserror::Error)]
pub enum PeelError {
    /// A scene, a frame, or the fragments of one.
    #[error(transparent)]
    Raster(#[from] peelnet_raster::RasterError),
    /// Coloured transmission: rows hold one transmittance.
    #[error(
        "a dataset keeps one transmittance a fragment, and this scene's transmission is coloured: make transmission_color grey"
    )]
    Tinted,
    /// The GPU.
    #[error(transparent)]
    Gpu(#[from] peelnet_gpu::GpuError),
    /// Writing.
    #[error(transparent)]
    Dataset(#[from] peelnet_dataset::DatasetError),
    /// The command asks for something that is not there.
    #[error("{0}")]
    Usage(String),
    /// Stopped from outside before the end; nothing was left behind.
    #[error("interrupted: nothing was written; run the command again")]
    Interrupted,
}

impl From<peelnet_shaders::ShaderError> for PeelError {
    fn from(e: peelnet_shaders::ShaderError) -> Self {
        Self::Raster(e.into())
    }
}
