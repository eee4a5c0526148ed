//! What can go wrong in training.

use peelnet_model::Recipe;
use std::path::{Path, PathBuf};

/// Why training did not start or did not finish.
#[allow(missing_docs, reason = "the message of each error names its fields")]
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    /// A hyper-parameter is out of its range.
    #[error("setting `{setting}` is {value}: {hint}")]
    Config {
        setting: &'static str,
        value: String,
        hint: &'static str,
    },
    /// The dataset could not be read.
    #[error("{0}")]
    Dataset(#[from] peelnet_dataset::DatasetError),
    /// Asked to stop before the first epoch.
    #[error("interrupted while the rows were read: nothing was trained")]
    Stopped,
    /// A checkpoint cannot be continued.
    #[error("{}: {problem}", path.display())]
    Checkpoint { path: PathBuf, problem: String },
    /// The model file could not be written.
    #[error(transparent)]
    Model(#[from] peelnet_model::ModelError),
    /// Rows that cannot be trained on, a file that cannot be read or written, an output that another training writes, or a loss or a weight
    /// that is no longer finite.
    #[error("{0}")]
    Failed(String),
}

impl TrainError {
    /// What is wrong with the rows of `data`.
    pub(crate) fn rows(data: &str, problem: &str) -> Self {
        Self::Failed(format!("{data}: {problem}"))
    }

    /// Nothing to learn from, of so many rows of datasets.
    pub(crate) fn no_examples(data: &str, recipe: Recipe, rows: u64) -> Self {
        let problem = match rows {
            0 => "no rows to train on: extract views with transparent objects in them, of scenes that are not held out".to_owned(),
            _ => format!(
                "no examples for recipe {recipe}: method {} draws every pixel exactly, each has so few \
                 fragments; extract scenes with more layers, or train recipe {}, which learns from every row",
                recipe.method,
                Recipe::THESIS
            ),
        };
        Self::rows(data, &problem)
    }
}

/// An error of the file system, with the file's name.
pub(crate) fn io(path: &Path) -> impl Fn(std::io::Error) -> TrainError + use<> {
    let path = path.display().to_string();
    move |error| TrainError::Failed(format!("{path}: {error}"))
}

/// `<out>.<ending>`. The ending is appended: `exp-0.5` and `exp-0.7` must not share a name.
pub(crate) fn beside(out: &Path, ending: &str) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(".");
    name.push(ending);
    name.into()
}
