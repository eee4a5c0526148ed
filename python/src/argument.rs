//! Arguments that are an object of a class, or the path of what one is loaded from; or a list of either.

use pyo3::{PyClass, exceptions::PyTypeError, prelude::*, pyclass::boolean_struct::True};
use std::path::PathBuf;

/// A class whose objects are loaded from files.
pub trait FromFile: PyClass<Frozen = True> + Clone + Sync {
    /// What an argument may be, for people.
    const IS: &'static str;

    /// Loads what lies at a path.
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self>;
}

/// An object, or what lies at a path.
pub fn load<C: FromFile>(argument: &Bound<'_, PyAny>) -> PyResult<C> {
    if let Ok(object) = argument.cast::<C>() {
        return Ok(object.get().clone());
    }
    let path = argument.extract::<PathBuf>();
    let path = path.map_err(|_| PyTypeError::new_err(C::IS))?;
    C::from_file(argument.py(), path)
}

/// One argument, or a list of them.
pub fn load_all<C: FromFile>(argument: &Bound<'_, PyAny>) -> PyResult<Vec<C>> {
    let is_path = argument.extract::<PathBuf>().is_ok();
    match argument.try_iter() {
        Ok(items) if !is_path => items.map(|item| load(&item?)).collect(),
        _ => Ok(vec![load(argument)?]),
    }
}
