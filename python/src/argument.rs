//! Arguments that are an object of a class, or the path of what one is loaded from; or a list of either.

use pyo3::{PyClass, exceptions::PyTypeError, prelude::*, pyclass::boolean_struct::True};
use std::path::PathBuf;

/// A class whose objects are loaded from files.
pub trait FromFile: PyClass<Frozen = True> + Clone + Sync {
    /// What an argument may be, for people.
    const IS: &'static str;

    /// Loads what lies at a path.
    ///
    /// # Errors
    /// What does not load.
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self>;
}

/// An object, or the path of its file.
pub enum Argument<C> {
    Loaded(Box<C>),
    Path(PathBuf),
}

impl<'a, 'py, C: FromFile> FromPyObject<'a, 'py> for Argument<C> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(object) = object.cast::<C>() {
            return Ok(Self::Loaded(Box::new(object.get().clone())));
        }
        let path = object.extract::<PathBuf>();
        path.map(Self::Path)
            .map_err(|_| PyTypeError::new_err(C::IS))
    }
}

impl<C: FromFile> Argument<C> {
    /// The object.
    ///
    /// # Errors
    /// A file that does not load.
    pub fn load(self, py: Python<'_>) -> PyResult<C> {
        match self {
            Self::Loaded(object) => Ok(*object),
            Self::Path(path) => C::from_file(py, path),
        }
    }
}

/// One argument, or a list of them.
pub struct Arguments<C>(Vec<Argument<C>>);

impl<'a, 'py, C: FromFile> FromPyObject<'a, 'py> for Arguments<C> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let neither = match object.extract::<Argument<C>>() {
            Ok(one) => return Ok(Self(vec![one])),
            Err(e) => e,
        };
        let items = object.try_iter().map_err(|_| neither)?;
        let items = items.map(|item| item?.extract());
        items.collect::<PyResult<_>>().map(Self)
    }
}

impl<C: FromFile> Arguments<C> {
    /// The objects.
    ///
    /// # Errors
    /// The first file that does not load.
    pub fn load(self, py: Python<'_>) -> PyResult<Vec<C>> {
        self.0.into_iter().map(|one| one.load(py)).collect()
    }
}
