//! What a writer is called in records and errors.

/// The machine's name, as the system says it.
pub(crate) fn host() -> String {
    let file = || std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let variable = || {
        ["HOSTNAME", "COMPUTERNAME"]
            .iter()
            .find_map(|name| std::env::var(name).ok())
    };
    let name = file().or_else(variable).unwrap_or_default();
    let name = peelnet_files::printable(name.trim());
    if name.is_empty() {
        "host".to_owned()
    } else {
        name.into_owned()
    }
}

/// The name of this process as a writer: what the variable `PEELNET_WORKER` says, or the machine's name and the process's number.
pub fn worker_name() -> String {
    match std::env::var("PEELNET_WORKER") {
        Ok(name) if !name.trim().is_empty() => peelnet_files::printable(name.trim()).into_owned(),
        _ => format!("{}:{}", host(), std::process::id()),
    }
}
