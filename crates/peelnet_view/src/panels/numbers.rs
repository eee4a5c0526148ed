//! Errors, times and memory of what is shown.

use super::digits;
use crate::app::App;
use egui::{Grid, Ui};

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    ui.checkbox(&mut app.panels.measures, "Measure when the view rests")
        .on_hover_text("Against the exact image, of the whole picture, as peelnet bench does");
    let Some(key) = app.key() else {
        return;
    };
    let numbers = match app.judge.of(&key) {
        Some(Ok(numbers)) => numbers.clone(),
        Some(Err(e)) => {
            ui.colored_label(ui.visuals().error_fg_color, e.clone());
            return;
        }
        None => {
            if app.judge.is_busy() {
                ui.horizontal(|ui| {
                    ui.spinner();
                    ui.label("measuring");
                });
            } else {
                ui.weak("not measured");
            }
            return;
        }
    };
    Grid::new("numbers").striped(true).show(ui, |ui| {
        let mut row = |name: &str, value: String, about: &str| {
            ui.label(name).on_hover_text(about);
            ui.monospace(value);
            ui.end_row();
        };
        row(
            "MSE",
            digits(numbers.mse255),
            "Mean squared error of encoded values, 0–255 each",
        );
        row(
            "RMSE of 255",
            digits(numbers.mse255.sqrt()),
            "Root of the mean squared error",
        );
        let psnr = numbers
            .psnr
            .map_or_else(|| "exact".into(), |p| format!("{p:.1} dB"));
        row("PSNR", psnr, "Peak signal-to-noise ratio");
        row(
            "FLIP",
            numbers.flip.map_or_else(|| "not in a page".into(), digits),
            "Mean difference as people see it (Andersson et al. 2020), 0 … 1",
        );
        row(
            "largest",
            digits(numbers.max_error),
            "Largest error of a channel, of 255",
        );
        if numbers.non_finite > 0 {
            row(
                "not finite",
                format!("{} pixels", numbers.non_finite),
                "Pixels with a NaN or an infinity",
            );
        }
        if let Some(fragments) = numbers.stats.fragments {
            row(
                "fragments",
                fragments.to_string(),
                "Transparent fragments of the frame",
            );
            let [w, h] = app.size.map(f64::from);
            row(
                "layers, mean",
                digits(fragments as f64 / (w * h)),
                "Fragments a pixel",
            );
        }
        if let Some(most) = numbers.stats.max_layers {
            row(
                "layers, most",
                most.to_string(),
                "Fragments of the fullest pixel",
            );
        }
    });
}

pub(super) fn passes(app: &mut App, ui: &mut Ui) {
    let slot = &app.first;
    Grid::new("passes").striped(true).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(name);
            ui.monospace(value);
            ui.end_row();
        };
        // Passes of one name count together, as peeling has many.
        let mut times: Vec<(&str, f64, u32)> = Vec::new();
        for pass in &slot.times {
            match times.iter_mut().find(|(name, _, _)| *name == pass.label) {
                Some((_, micros, n)) => {
                    *micros += pass.micros;
                    *n += 1;
                }
                None => times.push((&pass.label, pass.micros, 1)),
            }
        }
        for (name, micros, n) in times {
            // Some are named after their shader: methods::slabs::resolve.
            let name = name.rsplit("::").next().unwrap_or(name);
            let name = if n > 1 {
                format!("{name} ×{n}")
            } else {
                name.to_owned()
            };
            row(&name, format!("{:.3} ms", micros / 1e3));
        }
        match slot.gpu_ms() {
            Some(ms) => row("frame on the GPU", format!("{ms:.3} ms")),
            None => row("frame on the GPU", "no timestamps".into()),
        }
        row("frame on the CPU", format!("{:.2} ms", app.cpu_ms));
        row("made ready in", format!("{:.0} ms", slot.ready_ms));
        let stats = slot.stats();
        row(
            "passes",
            format!(
                "{} geometry, {} screen",
                stats.geometry_passes, stats.fullscreen_passes
            ),
        );
        row(
            "memory",
            format!("{:.0} bytes a pixel", stats.bytes_per_pixel),
        );
        let [w, h] = app.size;
        row("picture", format!("{w} × {h}"));
    });
}
