//! Ctrl-C: the first asks to stop cleanly, the second stops at once.

use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// Installs the handler and gives the flag that long loops look at.
pub fn install() -> &'static AtomicBool {
    // A failure means that another handler is installed already, which only happens when this is called twice.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            std::process::exit(1);
        }
        eprintln!("stopping cleanly; press Ctrl-C again to stop at once");
    });
    &STOP
}

/// Whether Ctrl-C was pressed.
pub fn requested() -> bool {
    STOP.load(Ordering::Relaxed)
}
