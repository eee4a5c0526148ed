//! Signals: SIGINT (Ctrl-C), SIGTERM and SIGHUP end every command within [`GRACE`] and leave whole files or none.
//!
//! A signal sets the flag that long loops look at, so that they end by themselves: a training after its epoch, a comparison after its
//! frame. What has not ended when [`GRACE`] is over, such as a file that is being decoded, is ended, and unfinished files are removed.

use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::time::{Duration, Instant};

/// What a command has to end by itself. One second is promised.
const GRACE: Duration = Duration::from_millis(600);

/// What the message of an end may take: whoever reads stderr can have stopped reading.
const MESSAGE_TIME: Duration = Duration::from_millis(300);

static STOP: AtomicBool = AtomicBool::new(false);

/// The number of the signal that came, 0 for none.
static SIGNAL: AtomicI32 = AtomicI32::new(0);

/// Installs the handlers and gives the flag that long loops look at.
pub fn install() -> std::io::Result<&'static AtomicBool> {
    listen()?;
    Ok(&STOP)
}

#[cfg(unix)]
fn listen() -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    // With a handler, a file beyond `ulimit -f` is an error of writing like a full disk.
    signal_hook::flag::register(SIGXFSZ, std::sync::Arc::default())?;
    let ignored = ignored();
    let heard = [SIGINT, SIGTERM, SIGHUP].into_iter();
    let heard = heard.filter(|signal| ignored & (1 << (signal - 1)) == 0);
    let mut signals = signal_hook::iterator::Signals::new(heard)?;
    let listens = std::thread::Builder::new();
    listens.spawn(move || signals.forever().for_each(on_signal))?;
    Ok(())
}

/// A bit for each signal that this process was started to ignore, as by `nohup`; none where the system does not say.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mut lines = status.lines();
    let bits = lines.find_map(|line| line.strip_prefix("SigIgn:"));
    bits.map_or(0, |bits| u64::from_str_radix(bits.trim(), 16).unwrap_or(0))
}

#[cfg(not(unix))]
fn listen() -> std::io::Result<()> {
    const SIGINT: i32 = 2;
    ctrlc::set_handler(|| on_signal(SIGINT)).map_err(std::io::Error::other)
}

/// The first signal asks, the second one or the end of [`GRACE`] ends.
fn on_signal(signal: i32) {
    SIGNAL.store(signal, Ordering::SeqCst);
    if STOP.swap(true, Ordering::SeqCst) {
        end();
    }
    let ends = std::thread::Builder::new().spawn(|| {
        std::thread::sleep(GRACE);
        end();
    });
    // Where the system makes no thread more, this one waits: a second signal is not heard then.
    if ends.is_err() {
        std::thread::sleep(GRACE);
        end();
    }
}

/// Ends the process while its other threads still work: nothing of theirs is waited for but files that are moving into place.
fn end() -> ! {
    peelnet_core::files::remove_unfinished();
    let code = code().unwrap_or(1);
    let message = std::thread::Builder::new().spawn(|| crate::console::error(MESSAGE));
    let deadline = Instant::now() + MESSAGE_TIME;
    while message.as_ref().is_ok_and(|m| !m.is_finished()) && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(1));
    }
    #[cfg(unix)]
    signal_hook::low_level::exit(code.into());
    #[cfg(not(unix))]
    std::process::exit(code.into());
}

pub const MESSAGE: &str = "interrupted; files that were not finished are gone";

/// 128 and the number of the signal that came: 130 for SIGINT, 143 for SIGTERM.
fn code() -> Option<u8> {
    let signal = SIGNAL.load(Ordering::SeqCst);
    (signal != 0).then(|| 128 + signal as u8)
}

/// The exit code that a signal demands, otherwise this one.
pub fn exit_code(otherwise: ExitCode) -> ExitCode {
    code().map_or(otherwise, ExitCode::from)
}
