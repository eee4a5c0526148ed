use peelnet_render::RenderError;
use std::path::PathBuf;

/// What can go wrong when methods are measured.
#[derive(Debug, thiserror::Error)]
pub enum EvalError {
    /// The file system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried, as a verb: `write`, `create the folder`, …
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Drawing failed.
    #[error("scene '{scene}', method '{method}': {source}")]
    Render {
        /// The scene's name.
        scene: String,
        /// The method's name.
        method: String,
        /// The renderer's reason.
        source: Box<RenderError>,
    },
    /// Peeling failed.
    #[cfg(not(target_arch = "wasm32"))]
    #[error("scene '{scene}': {source}")]
    Peel {
        /// The scene's name.
        scene: String,
        /// The peeler's reason.
        source: Box<peelnet_peel::PeelError>,
    },
    /// A scene of the suite could not be loaded.
    #[error(transparent)]
    Scene(#[from] peelnet_scene::SceneError),
    /// An exported function could not be run.
    #[error("the network of {method}: {source}")]
    Network {
        /// The method that draws with it.
        method: String,
        /// The exporter's reason.
        source: Box<peelnet_export::ExportError>,
    },
    /// Two images that should be compared differ in size: a bug of the caller.
    #[error(
        "an image of {approximate} pixels was compared with one of {exact} pixels; draw both with the same size"
    )]
    Sizes {
        /// Pixels of the exact image.
        exact: usize,
        /// Pixels of the other one.
        approximate: usize,
    },
    /// A path whose frames would take too much memory.
    #[error(
        "a path of {frames} frames of {}x{} pixels keeps {needed} bytes, more than {most}; make --size smaller or --frames fewer",
        size[0], size[1]
    )]
    LongPath {
        /// Frames of the path.
        frames: u32,
        /// Width and height in pixels.
        size: [u32; 2],
        /// Bytes.
        needed: u64,
        /// The most bytes that are kept.
        most: u64,
    },
    /// The video metric refused what it was given.
    #[cfg(not(target_arch = "wasm32"))]
    #[error("the video metric: {0}")]
    Video(#[from] colorvideovdp::Error),
    /// An interrupted run cannot be resumed.
    #[error("{}: cannot resume: {why}", path.display())]
    Resume {
        /// The file of the interrupted run.
        path: PathBuf,
        /// What does not fit.
        why: String,
    },
    /// Rows and pictures could not be assigned to their scene.
    #[error("two scenes are named '{name}' ({} and {}): rename one, because rows and pictures name their scene", first.display(), second.display())]
    SameName {
        /// The name of both.
        name: String,
        /// Where one comes from.
        first: PathBuf,
        /// Where the other comes from.
        second: PathBuf,
    },
    /// A file of designs that cannot be used.
    #[error("{}: {what}: {why}", path.display())]
    Designs {
        /// The file.
        path: PathBuf,
        /// The entry, or what else is wrong.
        what: String,
        /// The problem, and how to fix it.
        why: String,
    },
    /// The user asked to stop.
    #[error("interrupted")]
    Interrupted,
}

#[cfg(not(target_arch = "wasm32"))]
impl EvalError {
    /// For `map_err` on file operations.
    pub(crate) fn io(
        path: impl Into<PathBuf>,
        action: &'static str,
    ) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io {
            path,
            action,
            source,
        }
    }

    /// For `map_err` on drawing a scene with a method.
    pub(crate) fn render(scene: &str, method: &str) -> impl FnOnce(RenderError) -> Self + use<> {
        let (scene, method) = (scene.to_owned(), method.to_owned());
        move |source| Self::Render {
            scene,
            method,
            source: Box::new(source),
        }
    }

    /// For `map_err` on peeling a scene.
    pub(crate) fn peel(scene: &str) -> impl FnOnce(peelnet_peel::PeelError) -> Self + use<> {
        let scene = scene.to_owned();
        move |source| Self::Peel {
            scene,
            source: Box::new(source),
        }
    }
}
