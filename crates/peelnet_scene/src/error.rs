use std::path::PathBuf;

/// Why a scene cannot be loaded. Every message names the file, the place in it, and a fix.
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
    /// A scene file that is not TOML, or has an unknown key or a value of the wrong type.
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
        /// What is wrong, and the values that are allowed.
        message: String,
    },
    /// A mesh file that cannot be used.
    #[error("{path}{at}: {message}", at = line.map(|l| format!(":{l}")).unwrap_or_default())]
    Mesh {
        /// The mesh or material file.
        path: PathBuf,
        /// The line, from 1, where it is known.
        line: Option<usize>,
        /// What is wrong, and the values that are allowed.
        message: String,
    },
    /// A name that no shipped scene has.
    #[error("there is no scene '{name}'; name a file, or a shipped scene: {known}", known = shipped())]
    NotShipped {
        /// The name.
        name: String,
    },
}

fn shipped() -> String {
    let all = peelnet_data::SCENES.iter().chain(peelnet_data::EFFECTS);
    all.map(|s| s.name).collect::<Vec<_>>().join(", ")
}
