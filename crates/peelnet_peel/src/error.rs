use std::path::PathBuf;

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
    /// Nothing to peel.
    #[error("no scene to extract")]
    NoScene,
    /// Rows could not be assigned to their scene.
    #[error("two scenes are named '{name}' ({} and {}): rename one, because rows name their scene", first.display(), second.display())]
    SameName {
        /// The name of both.
        name: String,
        /// Where one comes from.
        first: PathBuf,
        /// Where the other comes from.
        second: PathBuf,
    },
    /// A scene has fewer views than were asked for.
    #[error("scene {} has {views} of the {asked} views that were asked for: ask for fewer, or add [orbit] or [[view]]", scene.display())]
    TooFewViews {
        /// Where the scene comes from.
        scene: PathBuf,
        /// Views that it has.
        views: u32,
        /// Views that were asked for.
        asked: u32,
    },
    /// The check of rows that came from the GPU.
    #[error(
        "{0} rows are nearer than the row before them in their pixel. This is a fault of peelnet or of the GPU's driver: please report it \
         with what `peelnet doctor` prints"
    )]
    Unsorted(u64),
    /// Not a fraction.
    #[error("{0} is not a fraction of the pixels: it must be above 0 and at most 1")]
    Fraction(f64),
    /// More synthetic lists than can be counted.
    #[error("{0} synthetic lists are too many: at most {most}", most = crate::synthetic::MAX_LISTS)]
    TooManyLists(u64),
    /// A part of a shard: which one, and whose.
    #[error("part {index} (scene '{scene}', view {view}) of worker {worker}: {source}")]
    Part {
        /// The work item.
        index: u32,
        /// The scene's name.
        scene: String,
        /// View of the scene.
        view: u32,
        /// This writer's name.
        worker: String,
        /// What went wrong.
        source: Box<PeelError>,
    },
    /// Stopped from outside before the end; only finished parts stay.
    #[error("interrupted: parts that were not finished are gone; run the command again")]
    Interrupted,
}

impl From<peelnet_shaders::ShaderError> for PeelError {
    fn from(e: peelnet_shaders::ShaderError) -> Self {
        Self::Raster(e.into())
    }
}
