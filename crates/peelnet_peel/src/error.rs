/// What can go wrong while peeling.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say what the fields are")]
pub enum PeelError {
    /// A scene, a frame, or the fragments of one.
    #[error("{0}")]
    Render(#[from] peelnet_render::geometry::RenderError),
    /// Coloured transmission: rows hold one transmittance.
    #[error(
        "a dataset keeps one transmittance a fragment, and this scene's transmission is coloured: make transmission_color grey"
    )]
    Tinted,
    #[error("{0}")]
    Gpu(#[from] peelnet_render::gpu::GpuError),
    #[error("{0}")]
    Dataset(#[from] peelnet_dataset::DatasetError),
    /// A wrong value of what is asked for: `scenes`, `views`, `augment`, `pixels`, `max_passes` or `lists`.
    #[error("{reason}")]
    Setting {
        setting: &'static str,
        reason: String,
    },
    /// The check of rows that came from the GPU.
    #[error(
        "{0} rows are nearer than the row before them in their pixel. This is a fault of peelnet or of the GPU's driver: please report it \
         with what `peelnet doctor` prints"
    )]
    Unsorted(u64),
    /// A part of a shard: which one, and whose.
    #[error("part {index} (scene '{scene}', view {view}) of worker {worker}: {source}")]
    Part {
        index: u32,
        scene: String,
        view: u32,
        worker: String,
        source: Box<PeelError>,
    },
    #[error("a thread could not be started: {0}")]
    Thread(std::io::Error),
    #[error("interrupted: parts that were not finished are gone; run the command again")]
    Interrupted,
}

impl PeelError {
    pub(crate) fn setting(setting: &'static str, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self::Setting { setting, reason }
    }
}
