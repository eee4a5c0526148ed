use peelnet_render::RenderError;
use std::path::PathBuf;

/// What can go wrong when methods are measured.
#[allow(missing_docs, reason = "the message of each error names its fields")]
#[derive(Debug, thiserror::Error)]
pub enum EvalError {
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        path: PathBuf,
        action: &'static str,
        source: std::io::Error,
    },
    #[error("scene '{scene}', method '{method}': {source}")]
    Render {
        scene: String,
        method: String,
        source: Box<RenderError>,
    },
    #[cfg(not(target_arch = "wasm32"))]
    #[error("scene '{scene}': {source}")]
    Peel {
        scene: String,
        source: Box<peelnet_peel::PeelError>,
    },
    /// A scene of the suite could not be loaded.
    #[error(transparent)]
    Scene(#[from] peelnet_scene::SceneError),
    #[error("the network of {method}: {source}")]
    Network {
        method: String,
        source: Box<peelnet_export::ExportError>,
    },
    /// Two images that should be compared differ in size: a bug of the caller.
    #[error(
        "an image of {approximate} pixels was compared with one of {exact} pixels; draw both with the same size"
    )]
    Sizes { exact: usize, approximate: usize },
    #[error(
        "a path of {frames} frames of {}x{} pixels keeps {needed} bytes, more than {most}; make --size smaller or --frames fewer",
        size[0], size[1]
    )]
    LongPath {
        frames: u32,
        size: [u32; 2],
        needed: u64,
        most: u64,
    },
    #[cfg(not(target_arch = "wasm32"))]
    #[error("the video metric: {0}")]
    Video(#[from] colorvideovdp::Error),
    #[error("{}: cannot resume: {why}", path.display())]
    Resume { path: PathBuf, why: String },
    /// Rows and pictures could not be assigned to their scene.
    #[error("two scenes are named '{name}' ({} and {}): rename one, because rows and pictures name their scene", first.display(), second.display())]
    SameName {
        name: String,
        first: PathBuf,
        second: PathBuf,
    },
    #[error("{}: {what}: {why}", path.display())]
    Designs {
        path: PathBuf,
        what: String,
        why: String,
    },
    /// The user asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl EvalError {
    /// Two images that should be compared differ in size.
    pub(crate) const fn sizes(exact: usize, approximate: usize) -> Result<(), Self> {
        if exact == approximate {
            return Ok(());
        }
        Err(Self::Sizes { exact, approximate })
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl EvalError {
    /// For `map_err` on file operations.
    pub(crate) fn io(
        path: &std::path::Path,
        action: &'static str,
    ) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io {
            path,
            action,
            source,
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

    /// For `map_err` on drawing a scene with a method.
    pub(crate) fn render(scene: &str, method: &str) -> impl FnOnce(RenderError) -> Self + use<> {
        let (scene, method) = (scene.to_owned(), method.to_owned());
        move |source| Self::Render {
            scene,
            method,
            source: Box::new(source),
        }
    }

    /// Why a scene could not be drawn, without the scene and the method.
    pub(crate) fn reason(&self) -> String {
        match self {
            Self::Render { source, .. } => source.to_string(),
            other => other.to_string(),
        }
    }

    /// Whether it is memory that a frame lacks: another adapter, or a smaller frame, has it.
    pub(crate) fn is_too_large(&self) -> bool {
        let Self::Render { source, .. } = self else {
            return false;
        };
        use peelnet_gpu::GpuError::{OutOfMemory, TooLarge};
        matches!(
            **source,
            RenderError::Gpu(TooLarge { .. } | OutOfMemory { .. })
        )
    }
}
