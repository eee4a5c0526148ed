use crate::warnings::one_line;
use peelnet_files::printable;
use std::path::{Path, PathBuf};

/// Why a scene cannot be loaded. Every message names the file, the place in it, and a fix.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file that cannot be read.
    #[error("cannot read {}: {source}", shown(path))]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// A scene file that is not TOML, or has an unknown key or a value of the wrong type.
    #[error("{}:{line}: {}", shown(path), one_line(message))]
    Syntax {
        /// The scene file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// A value that a scene cannot have.
    #[error("{}: {}: {}", shown(path), one_line(field), one_line(message))]
    Value {
        /// The scene file.
        path: PathBuf,
        /// The key, such as `camera.near` or `object 3.material.alpha`.
        field: String,
        /// What is wrong, and the values that are allowed.
        message: String,
    },
    /// A mesh file that cannot be used.
    #[error("{}{at}: {}", shown(path), one_line(message), at = line.map(|l| format!(":{l}")).unwrap_or_default())]
    Mesh {
        /// The mesh or material file.
        path: PathBuf,
        /// The line, from 1, where it is known.
        line: Option<usize>,
        /// What is wrong, and the values that are allowed.
        message: String,
    },
    /// A name that no shipped scene has.
    #[error("there is no scene '{}'; name a file, or a shipped scene: {known}", printable(name), known = shipped())]
    NotShipped {
        /// The name.
        name: String,
    },
}

fn shipped() -> String {
    let all = peelnet_data::SCENES.iter().chain(peelnet_data::EFFECTS);
    all.map(|s| s.name).collect::<Vec<_>>().join(", ")
}

/// A path in a message.
pub(crate) fn shown(path: &Path) -> String {
    one_line(&path.display().to_string())
}
