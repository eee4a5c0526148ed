//! The window of a native system.

use crate::{
    app::{App, Start, configuration},
    memory,
    stage::Source,
};
use peelnet_render::gpu::Gpu;

/// Opens the window and runs it until it is closed. `size` is that of its content, in pixels. Returns what the frames of a script cost, as a
/// sentence.
///
/// # Errors
/// No display to open a window on, or what a script of `start` came to; one line.
pub fn open(gpu: &Gpu, start: Start, size: [u32; 2]) -> Result<Option<String>, String> {
    let script = start.script.clone();
    // A script neither sees nor changes what is remembered, such as the size of text.
    let name = format!("peelnet-view-{}.ron", std::process::id());
    let scratch = script.is_some().then(|| std::env::temp_dir().join(name));
    let viewport = egui::ViewportBuilder::default()
        .with_title("peelnet")
        .with_inner_size(size.map(|n| n as f32))
        .with_min_inner_size([320.0, 240.0])
        .with_drag_and_drop(true);
    let options = eframe::NativeOptions {
        viewport,
        // The size is what was asked for.
        persist_window: false,
        persistence_path: scratch.clone(),
        wgpu_options: configuration(gpu),
        ..Default::default()
    };
    let gpu = gpu.clone();
    let run = eframe::run_native(
        "peelnet",
        options,
        Box::new(move |cc| {
            let recent = memory::load(cc.storage);
            if start.script.is_some() {
                // One pixel of the picture is one of the window.
                cc.egui_ctx.set_pixels_per_point(1.0);
            }
            let source = Source::named(&start.scene);
            Ok(Box::new(App::new(&gpu, start, source, recent)))
        }),
    );
    if let Some(scratch) = scratch {
        // There is none where nothing was to be remembered.
        let _ = std::fs::remove_file(scratch);
    }
    run.map_err(|e| {
        format!(
            "no window can be opened ({e}); where there is no display, peelnet render draws images, and xvfb-run lends a display"
        )
    })?;
    let closed = || Err("the window was closed before the script ended".into());
    let outcome = script.map(|script| script.outcome().unwrap_or_else(closed));
    outcome.transpose()
}
