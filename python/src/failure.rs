//! Errors of the libraries as Python exceptions, with the texts of the command line.

use peelnet::gpu::GpuError;
use pyo3::{exceptions::PyValueError, prelude::*};
use std::{borrow::Cow, error::Error, ffi::CString};

pyo3::create_exception!(
    peelnet,
    PeelnetError,
    pyo3::exceptions::PyException,
    "What the command line reports with exit code 1: a file that cannot be read, an adapter that is lost, ….\n\n\
     The text is that of the command line, one line, with control characters escaped. Wrong values raise\n\
     ValueError instead, which the command line reports with exit code 2."
);

/// A text for an exception, on one line, without what could move a terminal's cursor.
fn safe(text: &str) -> String {
    peelnet_files::printable_lines(text).into_owned()
}

/// A wrong value.
pub fn wrong(text: impl AsRef<str>) -> PyErr {
    PyValueError::new_err(safe(text.as_ref()))
}

/// Something that failed.
pub fn failed(text: impl AsRef<str>) -> PyErr {
    PeelnetError::new_err(safe(text.as_ref()))
}

/// A library's error and its sources. After a lost adapter the next call opens it anew.
#[allow(
    clippy::needless_pass_by_value,
    reason = "`map_err(raised)` passes errors by value"
)]
pub fn raised<E: Error + 'static>(error: E) -> PyErr {
    let lost = |e: &GpuError| matches!(e, GpuError::Lost(_)).then_some(());
    let mut next: Option<&(dyn Error + 'static)> = Some(&error);
    while let Some(e) = next {
        if peelnet::cause::find(e, lost).is_some() {
            crate::gpu::forget();
        }
        next = e.source();
    }
    let text = peelnet_files::error_line(&error);
    if peelnet::cause::is_wrong_value(&error) {
        wrong(text)
    } else {
        failed(text)
    }
}

/// A warning, as the command line prints it to stderr.
///
/// # Errors
/// Where Python was asked to turn warnings into errors.
pub fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let text: Cow<'_, str> = peelnet_files::printable_lines(text);
    let text = CString::new(text.replace('\0', " "))?;
    let category = py.get_type::<pyo3::exceptions::PyUserWarning>();
    PyErr::warn(py, &category, &text, 1)
}
