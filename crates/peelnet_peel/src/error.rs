use std::path::PathBuf;

/// What can go wrong while peeling.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say what the fields are")]
pub enum PeelError {
    /// A scene, a frame, or the fragments of one.
    #[error("{0}")]
    Render(#[from] peelnet_raster::RenderError),
    /// Coloured transmission: rows hold one transmittance.
    #[error(
        "a dataset keeps one transmittance a fragment, and this scene's transmission is coloured: make transmission_color grey"
    )]
    Tinted,
    #[error("{0}")]
    Gpu(#[from] peelnet_gpu::GpuError),
    #[error("{0}")]
    Dataset(#[from] peelnet_dataset::DatasetError),
    #[error("no scene to extract")]
    NoScene,
    #[error("two scenes are named '{name}' ({} and {}): rename one, because rows name their scene", first.display(), second.display())]
    SameName {
        name: String,
        first: PathBuf,
        second: PathBuf,
    },
    #[error("scene {} has {views} of the {asked} views that were asked for: ask for fewer, or add [orbit] or [[view]]", scene.display())]
    TooFewViews {
        scene: PathBuf,
        views: u32,
        asked: u32,
    },
    /// The check of rows that came from the GPU.
    #[error(
        "{0} rows are nearer than the row before them in their pixel. This is a fault of peelnet or of the GPU's driver: please report it \
         with what `peelnet doctor` prints"
    )]
    Unsorted(u64),
    #[error("{0} is not a fraction of the pixels: it must be above 0 and at most 1")]
    Fraction(f64),
    #[error("{0} synthetic lists are too many: at most {most}", most = crate::synthetic::MAX_LISTS)]
    TooManyLists(u64),
    /// A part of a shard: which one, and whose.
    #[error("part {index} (scene '{scene}', view {view}) of worker {worker}: {source}")]
    Part {
        index: u32,
        scene: String,
        view: u32,
        worker: String,
        source: Box<PeelError>,
    },
    #[error("interrupted: parts that were not finished are gone; run the command again")]
    Interrupted,
}

impl From<peelnet_shaders::ShaderError> for PeelError {
    fn from(e: peelnet_shaders::ShaderError) -> Self {
        Self::Render(e.into())
    }
}
