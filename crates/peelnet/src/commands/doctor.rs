//! `peelnet doctor`: adapters, features, what will be used and why.

use super::Context;
use crate::failure::Failure;
use peelnet_gpu::adapter::{AdapterReport, INSTALL_HINT, report};
use peelnet_gpu::{AdapterRequest, Gpu};
use serde_json::json;
use std::fmt::Write as _;

pub(super) fn run(context: &Context<'_>) -> Result<(), Failure> {
    let adapters = report();
    // Opening the device is the only proof that the driver works.
    let opened = Gpu::open(&context.global.adapter);
    let used = opened.as_ref().ok().map(|gpu| gpu.info.name.clone());
    context.console.result(
        || text(&adapters, used.as_deref(), &context.global.adapter),
        || {
            json!({
                "version": env!("CARGO_PKG_VERSION"),
                "os": std::env::consts::OS,
                "arch": std::env::consts::ARCH,
                "cores": std::thread::available_parallelism().map_or(1, usize::from),
                "used": used,
                "error": opened.as_ref().err().map(|e| crate::failure::one_line(e)),
                "install": adapters.is_empty().then_some(INSTALL_HINT),
                "adapters": adapters,
            })
        },
    )?;
    opened?;
    Ok(())
}

fn text(adapters: &[AdapterReport], used: Option<&str>, request: &AdapterRequest) -> String {
    let mut t = format!(
        "peelnet {} on {} {}, {} cores\n",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH,
        std::thread::available_parallelism().map_or(1, usize::from)
    );
    if adapters.is_empty() {
        let _ = writeln!(
            t,
            "\nno GPU adapter: no Vulkan driver is installed\n{INSTALL_HINT}"
        );
        return t;
    }
    for adapter in adapters {
        let is_used = used == Some(adapter.name.as_str());
        let _ = writeln!(
            t,
            "\n{} {} ({}, {})",
            if is_used { "*" } else { " " },
            adapter.name,
            adapter.kind,
            adapter.backend
        );
        let _ = writeln!(t, "    driver            {}", adapter.driver);
        let why = match (is_used, request) {
            (true, AdapterRequest::Auto) => format!("used: {}", adapter.why),
            (true, _) => "used: --adapter asks for it".to_owned(),
            (false, AdapterRequest::Auto) => format!("not used: {}", adapter.why),
            (false, _) => "not used: --adapter asks for another".to_owned(),
        };
        let _ = writeln!(t, "    {why}");
        let _ = writeln!(
            t,
            "    storage binding   {} MiB at most: larger frames are drawn in tiles",
            adapter.max_storage_binding >> 20
        );
        let _ = writeln!(
            t,
            "    largest frame     {} pixels a side",
            adapter.max_texture_side
        );
        let _ = writeln!(
            t,
            "    features          {}",
            or_none(&adapter.features.join(", "))
        );
        for missing in &adapter.missing {
            let _ = writeln!(
                t,
                "    missing           {}: {}",
                missing.name, missing.without
            );
        }
    }
    t
}

fn or_none(text: &str) -> &str {
    if text.is_empty() { "none" } else { text }
}
