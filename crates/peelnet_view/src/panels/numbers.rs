//! Errors, times and memory of what is shown.

use super::{digits, error};
use crate::{app::App, numbers::Numbers};
use egui::{Grid, Ui};

const MSE: &str = "Mean squared error of encoded values, 0–255 each";
const FLIP: &str = "Mean difference as people see it (Andersson et al. 2020), 0 … 1";

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    ui.checkbox(&mut app.panels.measures, "Measure when the view rests")
        .on_hover_text("Against the exact image, of the whole picture, as peelnet bench does");
    let Some(key) = app.key() else { return };
    match app.errors.get(&key) {
        Some(Ok(numbers)) => table(ui, "numbers", errors(numbers, app.size)),
        Some(Err(e)) => error(ui, e),
        None if app.errors.is_busy() => {
            // While a network is trained, its last error stays: there is a new one every epoch.
            if let Some((of, Ok(numbers))) = &app.errors.last
                && (&of.view, &of.method) == (&key.view, &key.method)
            {
                table(ui, "numbers", errors(numbers, app.size));
            }
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label("measuring");
            });
        }
        None => drop(ui.weak("not measured")),
    }
}

fn table<N: Into<String>>(ui: &mut Ui, name: &str, rows: Vec<(N, String, &str)>) {
    Grid::new(name).striped(true).show(ui, |ui| {
        for (name, value, about) in rows {
            let label = ui.label(name.into());
            if !about.is_empty() {
                label.on_hover_text(about);
            }
            ui.monospace(value);
            ui.end_row();
        }
    });
}

fn errors(numbers: &Numbers, size: [u32; 2]) -> Vec<(&'static str, String, &'static str)> {
    let of = &numbers.differences;
    let psnr = of.psnr.map_or("exact".into(), |p| format!("{p:.1} dB"));
    let flip = numbers.flip.map_or("not in a page".into(), digits);
    let rmse = digits(of.mse255.sqrt());
    let largest = digits(of.max_error);
    let mut rows = vec![
        ("MSE", digits(of.mse255), MSE),
        ("RMSE of 255", rmse, "Root of the mean squared error"),
        ("PSNR", psnr, "Peak signal-to-noise ratio"),
        ("FLIP", flip, FLIP),
        ("largest", largest, "Largest error of a channel, of 255"),
    ];
    if of.non_finite_pixels > 0 {
        let value = format!("{} pixels", of.non_finite_pixels);
        rows.push(("not finite", value, "Pixels with a NaN or an infinity"));
    }
    if let Some(fragments) = numbers.stats.fragments {
        let value = fragments.to_string();
        rows.push(("fragments", value, "Transparent fragments of the frame"));
        let [w, h] = size.map(f64::from);
        let mean = digits(fragments as f64 / (w * h));
        rows.push(("layers, mean", mean, "Fragments a pixel"));
    }
    if let Some(most) = numbers.stats.max_layers {
        let value = most.to_string();
        rows.push(("layers, most", value, "Fragments of the fullest pixel"));
    }
    rows
}

pub(super) fn passes(app: &mut App, ui: &mut Ui) {
    let slot = &app.first;
    // Passes of one name count together, as peeling has many.
    let mut times: Vec<(&str, f64, u32)> = Vec::new();
    for pass in &slot.times {
        match times.iter_mut().find(|(name, _, _)| *name == pass.label) {
            Some((_, micros, n)) => (*micros, *n) = (*micros + pass.micros, *n + 1),
            None => times.push((&pass.label, pass.micros, 1)),
        }
    }
    let mut rows = Vec::new();
    for (name, micros, n) in times {
        // Some are named after their shader: methods::slabs::resolve.
        let name = name.rsplit("::").next().unwrap_or(name);
        let mut name = name.to_owned();
        if n > 1 {
            name += &format!(" ×{n}");
        }
        rows.push((name, format!("{:.3} ms", micros / 1e3), ""));
    }
    let gpu = slot.gpu_ms().map(|ms| format!("{ms:.3} ms"));
    let stats = slot.stats();
    let (geometry, screen) = (stats.geometry_passes, stats.fullscreen_passes);
    let bytes = stats.bytes_per_pixel;
    let [w, h] = app.size;
    let frame = [
        ("frame on the GPU", gpu.unwrap_or("no timestamps".into())),
        ("frame on the CPU", format!("{:.2} ms", app.cpu_ms)),
        ("made ready in", format!("{:.0} ms", slot.ready_ms)),
        ("passes", format!("{geometry} geometry, {screen} screen")),
        ("memory", format!("{bytes:.0} bytes a pixel")),
        ("picture", format!("{w} × {h}")),
    ];
    rows.extend(frame.map(|(name, value)| (name.to_owned(), value, "")));
    table(ui, "passes", rows);
}
