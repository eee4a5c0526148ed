//! What serialises to JSON, as Python's objects.

use crate::failure::failed;
use pyo3::prelude::*;

/// Lists, dicts and numbers.
pub fn to_python<'py>(
    py: Python<'py>,
    value: &impl serde::Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|e| failed(e.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}
