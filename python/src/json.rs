//! What serialises to JSON, as Python's objects.

use crate::failure::failed;
use pyo3::prelude::*;

/// Lists, dicts and numbers.
///
/// # Errors
/// A value that JSON cannot hold.
pub fn to_python<'py>(
    py: Python<'py>,
    value: &impl serde::Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|e| failed(e.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

/// What JSON says of a Python object.
///
/// # Errors
/// An object that JSON cannot hold, or that is not of this type.
pub fn from_python<T: serde::de::DeserializeOwned>(object: &Bound<'_, PyAny>) -> PyResult<T> {
    let json = object.py().import("json")?;
    let text: String = json.call_method1("dumps", (object,))?.extract()?;
    serde_json::from_str(&text).map_err(|e| failed(e.to_string()))
}
