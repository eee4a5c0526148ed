use peelnet_render::RenderError;
use peelnet_render::gpu::GpuError::{OutOfMemory, TooLarge};
use std::{
    error::Error,
    path::{Path, PathBuf},
};

#[derive(Debug, thiserror::Error)]
pub enum EvalError {
    #[error("{place}: {source}")]
    At {
        place: String,
        source: Box<dyn Error + Send + Sync>,
    },
    #[error(transparent)]
    Scene(#[from] peelnet_scene::SceneError),
    #[error("the video metric: {0}")]
    Video(#[from] colorvideovdp::Error),
    #[error("{}: cannot resume: {why}", path.display())]
    Resume { path: PathBuf, why: String },
    #[error("two scenes are named '{name}' ({} and {}): rename one, because rows and pictures name their scene", first.display(), second.display())]
    SameName {
        name: String,
        first: PathBuf,
        second: PathBuf,
    },
    #[error("method {0} is named twice, and rows name their method; name it once")]
    SameMethod(String),
    /// Anything else that cannot be measured: a path that is too long, a file of designs.
    #[error("{0}")]
    Unusable(String),
    #[error("{}: is not the picture that was drawn with these rows, but one of another run; measure again, or move the folder of pictures away", .0.display())]
    OtherPicture(PathBuf),
    #[error("{0}")]
    Peel(#[from] peelnet_peel::PeelError),
    #[error("{0}")]
    Dataset(#[from] peelnet_dataset::DatasetError),
    #[error("interrupted")]
    Interrupted,
}

impl EvalError {
    pub(crate) fn at<E: Error + Send + Sync + 'static>(place: String) -> impl FnOnce(E) -> Self {
        |source| Self::At {
            place,
            source: source.into(),
        }
    }

    pub(crate) fn io<E>(path: &Path, action: &str) -> impl FnOnce(E) -> Self + use<E>
    where
        E: Error + Send + Sync + 'static,
    {
        Self::at(format!("{}: cannot {action}", path.display()))
    }

    pub(crate) fn render(scene: &str, method: &str) -> impl FnOnce(RenderError) -> Self + use<> {
        Self::at(format!("scene '{scene}', method '{method}'"))
    }

    /// Why a scene could not be drawn, without the scene and the method.
    pub(crate) fn reason(&self) -> String {
        match self {
            Self::At { source, .. } => source.to_string(),
            other => other.to_string(),
        }
    }

    /// Whether it is of a method alone: memory that a frame lacks, which another adapter, or a smaller frame, has; or what a scene holds.
    pub(crate) fn is_of_method(&self) -> bool {
        let Self::At { source, .. } = self else {
            return false;
        };
        matches!(
            source.downcast_ref(),
            Some(RenderError::Gpu(TooLarge { .. } | OutOfMemory { .. }) | RenderError::Scene(_))
        )
    }
}
