use peelnet_gpu::GpuError::{OutOfMemory, TooLarge};
use peelnet_peel::PeelError;
use peelnet_render::RenderError;
use std::path::{Path, PathBuf};

/// What can go wrong when methods are measured.
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
    #[error("scene '{scene}': {source}")]
    Peel {
        scene: String,
        source: Box<PeelError>,
    },
    /// A scene of the suite could not be loaded.
    #[error(transparent)]
    Scene(#[from] peelnet_scene::SceneError),
    #[error("the network of {method}: {source}")]
    Network {
        method: String,
        source: Box<peelnet_export::ExportError>,
    },
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
    /// Anything else that cannot be measured: a path that is too long, a file of designs.
    #[error("{0}")]
    Unusable(String),
    /// The user asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl EvalError {
    /// For `map_err` on file operations.
    pub(crate) fn io(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::Io {
            path: path.to_owned(),
            action,
            source,
        }
    }

    /// For `map_err` on peeling a scene.
    pub(crate) fn peel(scene: &str) -> impl FnOnce(PeelError) -> Self {
        move |source| Self::Peel {
            scene: scene.to_owned(),
            source: Box::new(source),
        }
    }

    /// For `map_err` on drawing a scene with a method.
    pub(crate) fn render(scene: &str, method: &str) -> impl FnOnce(RenderError) -> Self {
        move |source| Self::Render {
            scene: scene.to_owned(),
            method: method.to_owned(),
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
        matches!(
            **source,
            RenderError::Gpu(TooLarge { .. } | OutOfMemory { .. })
        )
    }
}
