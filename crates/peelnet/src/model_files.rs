//! Model files on this machine and in object stores.

use peelnet_dataset::{DatasetError, create_object, is_remote, read_object};
use peelnet_model::{MAX_BYTES, Model, ModelError};
use std::{
    io::{Error, ErrorKind},
    path::Path,
};

/// Loads a model file: a path, or an address such as `s3://bucket/prefix/model.safetensors`, as datasets have them.
///
/// # Errors
/// As [`Model::load`], or an object store that cannot be asked.
pub fn load_model(path: impl AsRef<Path>) -> Result<Model, ModelError> {
    let path = path.as_ref();
    if !is_remote(path) {
        return Model::load(path);
    }
    let action = "read the model";
    let bytes = read_object(path, MAX_BYTES).map_err(|e| remote(path, action, e))?;
    let bytes = bytes.ok_or_else(|| ModelError::Io {
        path: path.to_owned(),
        action,
        source: ErrorKind::NotFound.into(),
    })?;
    Model::from_bytes(&bytes, path)
}

/// Writes a model to a path, or to an address where there is nothing yet.
///
/// # Errors
/// As [`Model::save`]; an object store that cannot be asked; an object that is there already, unless it has the same bytes.
pub fn save_model(model: &Model, path: impl AsRef<Path>) -> Result<(), ModelError> {
    let path = path.as_ref();
    if !is_remote(path) {
        return model.save(path);
    }
    let bytes = model.to_bytes().map_err(|problem| ModelError::Invalid {
        path: path.to_owned(),
        problem,
    })?;
    let action = "write the model";
    let is_new = create_object(path, &bytes).map_err(|e| remote(path, action, e))?;
    // A request whose answer was lost is sent again, and then finds its own bytes.
    if is_new || read_object(path, MAX_BYTES).is_ok_and(|there| there.is_some_and(|b| b == bytes)) {
        return Ok(());
    }
    Err(taken(path))
}

/// Refuses an address at which there is something: models there are never replaced. Paths are not looked at.
///
/// # Errors
/// An address that is none or is taken, or an object store that cannot be asked.
pub fn check_model_place(path: &Path) -> Result<(), ModelError> {
    if !is_remote(path) {
        return Ok(());
    }
    match read_object(path, MAX_BYTES) {
        Ok(None) => Ok(()),
        Ok(Some(_)) => Err(taken(path)),
        Err(e) => Err(remote(path, "write the model", e)),
    }
}

fn taken(path: &Path) -> ModelError {
    ModelError::Io {
        path: path.to_owned(),
        action: "write the model",
        source: Error::new(
            ErrorKind::AlreadyExists,
            "there is another object, and none is replaced; choose another name",
        ),
    }
}

fn remote(path: &Path, action: &'static str, error: DatasetError) -> ModelError {
    let (path, source) = match error {
        DatasetError::Io { path, source, .. } => (path, source),
        // Its path is without what could be a password.
        DatasetError::Usage { path, reason } => (path, Error::other(reason)),
        other => (path.to_owned(), Error::other(other)),
    };
    ModelError::Io {
        path,
        action,
        source,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use peelnet_model::Recipe;

    #[test]
    fn a_model_at_an_address_is_written_once_and_read() {
        let folder = tempfile::tempdir().unwrap();
        let address = |name: &str| format!("file://{}/{name}", folder.path().display());
        let (small, medium) = (Recipe::SMALL, Recipe::MEDIUM);
        let [small, medium] = [small, medium].map(|r| Model::shipped(r).unwrap());
        let place = address("m.safetensors");
        check_model_place(Path::new(&place)).unwrap();
        save_model(&small, &place).unwrap();
        assert_eq!(load_model(&place).unwrap(), small);
        save_model(&small, &place).unwrap();
        let error = save_model(&medium, &place).unwrap_err().to_string();
        assert!(error.contains("none is replaced"), "{error}");
        let error = check_model_place(Path::new(&place))
            .unwrap_err()
            .to_string();
        assert!(error.contains("none is replaced"), "{error}");
        assert_eq!(load_model(&place).unwrap(), small);
        assert_eq!(
            std::fs::read(folder.path().join("m.safetensors")).unwrap(),
            small.to_bytes().unwrap()
        );
        let error = load_model(address("none")).unwrap_err().to_string();
        assert!(error.contains("cannot read the model"), "{error}");
        let error = load_model("s3://hunter2").unwrap_err().to_string();
        assert!(error.contains("scheme://bucket/prefix/name"), "{error}");
        assert!(!error.contains("hunter2"), "{error}");
    }
}
