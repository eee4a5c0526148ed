use super::Context;
use peelnet::Failure;
use peelnet_core::files::error_line;
use peelnet_render::gpu::adapter::{AdapterReport, INSTALL_HINT, report, why_none};
use peelnet_render::gpu::{AdapterRequest, Gpu};
use serde_json::json;

pub(super) fn run(context: &Context<'_>) -> Result<(), Failure> {
    let adapters = report();
    // Opening the device is the only proof that the driver works.
    let opened = Gpu::open(&context.global.adapter);
    let used = opened.as_ref().ok().map(|gpu| gpu.info.name.clone());
    let version = env!("CARGO_PKG_VERSION");
    let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let text = || {
        let mut t = format!("peelnet {version} on {os} {arch}, {cores} cores\n");
        if adapters.is_empty() {
            t += &format!("\nno GPU adapter: {}\n", why_none());
        }
        for adapter in &adapters {
            let is_used = used.as_ref() == Some(&adapter.name);
            t += &adapter_text(adapter, is_used, &context.global.adapter);
        }
        t
    };
    context.console.result(text, || {
        json!({
            "version": version,
            "os": os,
            "arch": arch,
            "cores": cores,
            "used": used,
            "error": opened.as_ref().err().map(|e| error_line(e)),
            "install": adapters.is_empty().then_some(INSTALL_HINT),
            "adapters": adapters,
        })
    })?;
    opened?;
    Ok(())
}

fn adapter_text(adapter: &AdapterReport, is_used: bool, request: &AdapterRequest) -> String {
    let mark = if is_used { '*' } else { ' ' };
    let why = match (is_used, request) {
        (true, AdapterRequest::Auto) => format!("used: {}", adapter.why),
        (true, _) => "used: --adapter asks for it".to_owned(),
        (false, AdapterRequest::Auto) => format!("not used: {}", adapter.why),
        (false, _) => "not used: --adapter asks for another".to_owned(),
    };
    let features = match adapter.features.join(", ") {
        none if none.is_empty() => "none".to_owned(),
        features => features,
    };
    let mut t = format!(
        "\n{mark} {} ({}, {})\n    \
         driver            {}\n    \
         {why}\n    \
         storage binding   {} MiB at most: larger frames are drawn in tiles\n    \
         largest frame     {} pixels a side\n    \
         features          {features}\n",
        adapter.name,
        adapter.kind,
        adapter.backend,
        adapter.driver,
        adapter.max_storage_binding >> 20,
        adapter.max_texture_side
    );
    for missing in &adapter.missing {
        let (name, without) = (missing.name, missing.without);
        t += &format!("    missing           {name}: {without}\n");
    }
    t
}
