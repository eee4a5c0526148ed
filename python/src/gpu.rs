//! Adapters, opened once a process.

use crate::failure::raised;
use peelnet::{AdapterRequest, Gpu};
use pyo3::prelude::*;
use std::{
    collections::BTreeMap,
    sync::{Mutex, PoisonError},
};

/// By process and request: a forked process cannot use its parent's.
static OPEN: Mutex<BTreeMap<(u32, String), Gpu>> = Mutex::new(BTreeMap::new());

/// The adapter of a request: `auto`, `software`, or a part of a name.
pub fn open(py: Python<'_>, request: &str) -> PyResult<Gpu> {
    py.detach(|| {
        let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (std::process::id(), request.to_owned());
        if let Some(gpu) = open.get(&key) {
            return Ok(gpu.clone());
        }
        let Ok(wanted) = request.parse::<AdapterRequest>();
        let gpu = Gpu::open(&wanted)?;
        open.insert(key, gpu.clone());
        Ok(gpu)
    })
    .map_err(|e: peelnet::gpu::GpuError| raised(e))
}

/// Opens every adapter anew when it is next asked for.
pub fn forget() {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner).clear();
}

/// The name of the adapter that a request gets.
///
/// Args:
///     adapter: "auto" (the fastest kind), "software" (such as lavapipe), or a part of an adapter's name.
#[pyfunction]
#[pyo3(signature = (adapter="auto"))]
pub fn adapter_name(py: Python<'_>, adapter: &str) -> PyResult<String> {
    Ok(open(py, adapter)?.info.name)
}
