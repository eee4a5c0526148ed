use crate::warnings::one_line;
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
    /// A file that cannot be used: no TOML, an unknown key, a damaged mesh.
    #[error("{}{at}: {}", shown(path), one_line(message), at = line.map(|l| format!(":{l}")).unwrap_or_default())]
    File {
        /// The file.
        path: PathBuf,
        /// The line, from 1, where it is known.
        line: Option<usize>,
        /// What is wrong, and the values that are allowed.
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
}

impl SceneError {
    /// What is wrong with a file that the message names already.
    pub(crate) fn reason(&self) -> String {
        match self {
            Self::Read { source, .. } => format!("cannot be read: {source}"),
            Self::File { message, .. } => message.clone(),
            other => other.to_string(),
        }
    }

    pub(crate) fn file(path: &Path, line: Option<usize>, message: impl Into<String>) -> Self {
        Self::File {
            path: path.to_owned(),
            line,
            message: message.into(),
        }
    }

    pub(crate) fn value(path: &Path, field: &str, message: impl Into<String>) -> Self {
        Self::Value {
            path: path.to_owned(),
            field: field.to_owned(),
            message: message.into(),
        }
    }
}

/// A path in a message.
pub(crate) fn shown(path: &Path) -> String {
    one_line(&path.display().to_string())
}

/// A key of a scene file's table, and what is wrong with its value.
pub(crate) type Fault = (&'static str, String);

pub(crate) fn require(holds: bool, key: &'static str, message: &str) -> Result<(), Fault> {
    if holds {
        return Ok(());
    }
    Err((key, message.to_owned()))
}

/// Checks that a number lies between two others, of which the higher may be the largest there is.
pub(crate) fn within(key: &'static str, x: f32, low: f32, high: f32) -> Result<(), Fault> {
    if (low..=high).contains(&x) {
        return Ok(());
    }
    let message = if high == f32::MAX {
        format!("{x} must be finite and at least {low}")
    } else {
        format!("{x} must lie in {low} … {high}")
    };
    Err((key, message))
}

pub(crate) fn check_color(color: [f32; 3]) -> Result<(), Fault> {
    let outside = color.into_iter().find(|x| !(0.0..=1.0).contains(x));
    let message = "must lie in 0 … 1: divide numbers of 0 … 255 by 255; what is brighter than white has an emission or an intensity";
    outside.map_or(Ok(()), |x| Err(("color", format!("{x} {message}"))))
}
