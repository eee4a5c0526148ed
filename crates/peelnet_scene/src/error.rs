use std::path::PathBuf;

/// Why a scene could not be had. Every message names the file, the place and the mend.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file that cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// A scene file that is not what a scene file must be.
    #[error("{path}:{line}: {message}")]
    Syntax {
        /// The scene file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// A value that a scene cannot have.
    #[error("{path}: {field}: {message}")]
    Value {
        /// The scene file.
        path: PathBuf,
        /// The key, such as `camera.near` or `object 3.material.alpha`.
        field: String,
        /// What is wrong and what would be right.
        message: String,
    },
    /// A mesh file that cannot be used.
    #[error("{path}{at}: {message}", at = line.map(|l| format!(":{l}")).unwrap_or_default())]
    Mesh {
        /// The mesh or material file.
        path: PathBuf,
        /// The line, from 1, where it is known.
        line: Option<usize>,
        /// What is wrong and what would be right.
        message: String,
    },
    /// The folder of shipped scenes.
    #[error(
        "no folder data/scenes here or in any folder above {start}: run inside the project, or name scene files"
    )]
    NoSuite {
        /// Where the search began.
        start: PathBuf,
    },
}
