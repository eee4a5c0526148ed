//! What can be wrong with a model file.

use std::io;
use std::path::{Path, PathBuf};

use crate::recipe::Recipe;

/// An error of loading or saving a model.
#[allow(missing_docs, reason = "the message of each error names its fields")]
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file system refused.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        path: PathBuf,
        action: &'static str,
        source: io::Error,
    },
    /// The file, or the model that was to be saved, is not a usable model.
    #[error("{}: {problem}", path.display())]
    Invalid { path: PathBuf, problem: Problem },
    /// A recipe whose network does not ship.
    #[error("no network ships for recipe {0}; train one and name its file")]
    NotShipped(Recipe),
}

impl ModelError {
    pub(crate) fn io(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io {
            path: path.to_owned(),
            action,
            source,
        }
    }

    pub(crate) fn invalid(path: &Path) -> impl FnOnce(Problem) -> Self {
        |problem| Self::Invalid {
            path: path.to_owned(),
            problem,
        }
    }
}

/// What is wrong with a model, and what to do about it.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Problem(pub(crate) String);

impl Problem {
    pub(crate) fn shapes(fault: String) -> Self {
        Self(format!("the network's shapes are wrong: {fault}"))
    }
}
