//! `peelnet doctor`: adapters, features, what will be used and why.

use super::Context;
use crate::summary_text::Lines;
use peelnet::Failure;
use peelnet_files::error_line;
use peelnet_gpu::adapter::{AdapterReport, INSTALL_HINT, report};
use peelnet_gpu::{AdapterRequest, Gpu};
use serde_json::json;

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
                "error": opened.as_ref().err().map(|e| error_line(e)),
                "install": adapters.is_empty().then_some(INSTALL_HINT),
                "adapters": adapters,
            })
        },
    )?;
    opened?;
    Ok(())
}

fn text(adapters: &[AdapterReport], used: Option<&str>, request: &AdapterRequest) -> String {
    let mut t = Lines::default();
    t.line(format!(
        "peelnet {} on {} {}, {} cores",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH,
        std::thread::available_parallelism().map_or(1, usize::from)
    ));
    if adapters.is_empty() {
        t.line("\nno GPU adapter: no Vulkan driver is installed");
        t.line(INSTALL_HINT);
    }
    for adapter in adapters {
        let is_used = used == Some(adapter.name.as_str());
        let mark = if is_used { '*' } else { ' ' };
        let (kind, backend) = (&adapter.kind, &adapter.backend);
        t.line(format!("\n{mark} {} ({kind}, {backend})", adapter.name));
        t.line(format!("    {:<17} {}", "driver", adapter.driver));
        let why = match (is_used, request) {
            (true, AdapterRequest::Auto) => format!("used: {}", adapter.why),
            (true, _) => "used: --adapter asks for it".to_owned(),
            (false, AdapterRequest::Auto) => format!("not used: {}", adapter.why),
            (false, _) => "not used: --adapter asks for another".to_owned(),
        };
        t.line(format!("    {why}"));
        let mut field = |name: &str, text: &str| t.line(format!("    {name:<17} {text}"));
        let mebibytes = adapter.max_storage_binding >> 20;
        field(
            "storage binding",
            &format!("{mebibytes} MiB at most: larger frames are drawn in tiles"),
        );
        let side = adapter.max_texture_side;
        field("largest frame", &format!("{side} pixels a side"));
        let features = match adapter.features.join(", ") {
            none if none.is_empty() => "none".to_owned(),
            features => features,
        };
        field("features", &features);
        for missing in &adapter.missing {
            field("missing", &format!("{}: {}", missing.name, missing.without));
        }
    }
    t.0
}
