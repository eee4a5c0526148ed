//! What can go wrong in training.

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
    /// The columns do not fit one another or the recipe.
    #[error("{data}: {problem}")]
    Columns { data: String, problem: String },
    /// A value is not a number that training can use.
    #[error(
        "{data}: row {row}, column `{column}` is {value}; extract the dataset again or leave the row out"
    )]
    Value {
        data: String,
        row: u64,
        column: String,
        value: f32,
    },
    /// The dataset could not be read.
    #[error("{0}")]
    Dataset(#[from] peelnet_dataset::DatasetError),
    /// A loss curve has an ending that is neither `.csv` nor `.svg`.
    #[error("{}: a loss curve ends in .csv or .svg", .0.display())]
    CurveFormat(PathBuf),
    /// A file could not be read or written.
    #[error("{}: {error}", path.display())]
    Io {
        path: PathBuf,
        error: std::io::Error,
    },
    /// The examples of a streamed training could not be written or read.
    #[error("the scratch file of streamed training in {}: {error}; it needs room for all examples", folder.display())]
    Scratch {
        folder: PathBuf,
        error: std::io::Error,
    },
    /// Asked to stop before the first epoch.
    #[error("interrupted while the rows were read: nothing was trained")]
    Stopped,
    /// Another training has the lock of the same model file.
    #[error("{}: another training writes to this file and its checkpoint; wait for it to end, or write to another file", out.display())]
    Busy { out: PathBuf },
    /// Threads could not be started.
    #[error("threads could not be started: {0}")]
    Threads(String),
    /// A checkpoint cannot be continued.
    #[error("{}: {problem}", path.display())]
    Checkpoint { path: PathBuf, problem: String },
    /// The model file could not be written.
    #[error(transparent)]
    Model(#[from] peelnet_model::ModelError),
    /// The loss or a weight became infinite or not a number.
    #[error(
        "training diverged in epoch {epoch}: {what} is not finite; a lower learning rate than {learning_rate} may help{}",
        kept.as_ref().map_or(String::new(), |p| format!("; the weights before it are in {}", p.display()))
    )]
    Diverged {
        epoch: u32,
        what: &'static str,
        learning_rate: f64,
        kept: Option<PathBuf>,
    },
}

impl TrainError {
    pub(crate) fn columns(data: &str, problem: String) -> Self {
        Self::Columns {
            data: data.to_owned(),
            problem,
        }
    }

    pub(crate) fn no_rows(data: &str) -> Self {
        let problem = "no rows to train on: extract views with transparent objects in them, of scenes that are not held out";
        Self::columns(data, problem.to_owned())
    }
}

/// An error of the file system, with the file's name.
pub(crate) fn io(path: &Path) -> impl Fn(std::io::Error) -> TrainError + use<> {
    let path = path.to_owned();
    move |error| TrainError::Io {
        path: path.clone(),
        error,
    }
}

/// `<out>.<ending>`. The ending is appended: `exp-0.5` and `exp-0.7` must not share a name.
pub(crate) fn beside(out: &Path, ending: &str) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(".");
    name.push(ending);
    name.into()
}
