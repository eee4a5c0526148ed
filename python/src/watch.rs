//! Long work on a thread of its own, while Python's thread hears Ctrl-C and shows progress.

use crate::failure::raised;
use peelnet::Failure;
use pyo3::{exceptions::PyTypeError, prelude::*, types::PyBool};
use std::{
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    time::Duration,
};

/// How long a Ctrl-C may go unheard.
const TICK: Duration = Duration::from_millis(50);

type Said<E> = (E, Option<SyncSender<()>>);

/// The worker's end: what it reports to Python.
pub struct Reporter<E>(SyncSender<Said<E>>);

impl<E> Reporter<E> {
    /// Reports without waiting; left out where Python is slower than the work.
    pub fn send(&self, event: E) {
        // A full channel or a listener that has gone: the next report says more.
        let _ = self.0.try_send((event, None));
    }

    /// Reports, and waits until Python has dealt with it: an exception there stops the work before its next step.
    pub fn ask(&self, event: E) {
        let (done, wait) = sync_channel(1);
        if self.0.send((event, Some(done))).is_ok() {
            // The other side answers or has gone.
            let _ = wait.recv();
        }
    }
}

/// Runs `work` without the GIL. Its events reach `on` with the GIL, in order. An exception of `on` and Ctrl-C set the flag that `work` looks at.
///
/// # Errors
/// The first exception of `on` or of a signal handler, once the work has ended; else what the work came to.
pub fn watch<E: Send, T: Send, F: Into<Failure> + Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool, &Reporter<E>) -> Result<T, F> + Send,
    mut on: impl FnMut(Python<'_>, E) -> PyResult<()>,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    let (send, mut receive): (_, Receiver<Said<E>>) = sync_channel(64);
    std::thread::scope(|scope| {
        let flag = &stop;
        let worker = scope.spawn(move || work(flag, &Reporter(send)));
        let mut heard = Ok(());
        loop {
            let waiting = &mut receive;
            let said = py.detach(move || waiting.recv_timeout(TICK));
            let (event, done) = match said {
                Ok((event, done)) => (Some(event), done),
                Err(RecvTimeoutError::Timeout) => (None, None),
                Err(RecvTimeoutError::Disconnected) => break,
            };
            if heard.is_ok() {
                heard = event
                    .map_or(Ok(()), |event| on(py, event))
                    .and_then(|()| py.check_signals());
                if heard.is_err() {
                    flag.store(true, Ordering::Relaxed);
                }
            }
            // Only now: the worker goes on, or sees the flag.
            drop(done);
        }
        let result = worker
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        heard.and_then(|()| py.check_signals())?;
        result.map_err(raised)
    })
}

/// A progress bar of the tqdm protocol: `total`, `update(n)`, `close()`.
pub struct Bar<'py> {
    bar: Option<Bound<'py, PyAny>>,
    done: u64,
}

impl<'py> Bar<'py> {
    /// Of `progress=`: nothing, `True` for tqdm's own, or an object with `update`.
    pub fn new(progress: Option<Bound<'py, PyAny>>) -> PyResult<Self> {
        let bar = match progress {
            Some(p) if p.is_instance_of::<PyBool>() => match p.extract()? {
                true => Some(p.py().import("tqdm.auto")?.getattr("tqdm")?.call0()?),
                false => None,
            },
            other => other.filter(|p| !p.is_none()),
        };
        if let Some(bar) = &bar
            && !bar.hasattr("update")?
        {
            return Err(PyTypeError::new_err(
                "progress needs update(n), total and close(), as tqdm has them",
            ));
        }
        Ok(Self { bar, done: 0 })
    }

    /// Moves the bar to `done` of `total`, with a text where the bar shows one.
    pub fn set(&mut self, done: u64, total: u64, text: &str) -> PyResult<()> {
        let Some(bar) = &self.bar else {
            return Ok(());
        };
        bar.setattr("total", total)?;
        if !text.is_empty() && bar.hasattr("set_postfix_str")? {
            bar.call_method1(
                "set_postfix_str",
                (peelnet_core::files::one_line(text), false),
            )?;
        }
        bar.call_method1("update", (done.saturating_sub(self.done),))?;
        self.done = done;
        Ok(())
    }

    /// Ends the bar, whatever the work came to; the work's error, else the bar's.
    pub fn close<T>(self, result: PyResult<T>) -> PyResult<T> {
        let Some(bar) = self.bar else {
            return result;
        };
        let closed = match bar.hasattr("close") {
            Ok(true) => bar.call_method0("close").map(|_| ()),
            Ok(false) => Ok(()),
            Err(e) => Err(e),
        };
        result.and_then(|value| closed.map(|()| value))
    }
}
