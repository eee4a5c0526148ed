//! The dataset that is open: its views, the rows of a pixel, and histograms.

use super::{button, digits, error, printable};
use crate::{
    app::App,
    dataset::{Looked, View},
};
use egui::{ComboBox, Grid, Rect, ScrollArea, Sense, Stroke, Ui, WidgetInfo, vec2};
use peelnet_bench::report::dataset::caption;
use peelnet_core::files::{counted, shown};
use peelnet_dataset::ColumnStatistics;

const CLOSE: &str = "The files stay as they are";

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    let Some(looked) = &mut app.dataset else {
        return;
    };
    let m = looked.dataset.manifest();
    ui.label(shown(&looked.path));
    ui.label(format!(
        "{} of {}",
        counted(m.rows, "row"),
        counted(m.pixels, "pixel")
    ));
    let closes = button(ui, "Close dataset", CLOSE);
    views(looked, ui);
    match looked.view.get(&looked.part) {
        None => drop(ui.spinner()),
        Some(Err(e)) => error(ui, e),
        Some(Ok(view)) => pixels(view, &mut looked.cell, ui),
    }
    ui.collapsing("Histograms", |ui| {
        let m = looked.dataset.manifest();
        if m.statistics.is_empty() {
            ui.weak("No statistics: the dataset is empty or of an earlier version.");
        }
        m.statistics.iter().for_each(|s| histogram(ui, s));
    });
    if closes {
        app.dataset = None;
    }
}

fn views(looked: &mut Looked, ui: &mut Ui) {
    let m = looked.dataset.manifest();
    let mut part = looked.part as usize;
    let name = |k: usize| {
        m.parts
            .get(k)
            .map_or(String::new(), |part| caption(m, part))
    };
    ComboBox::from_label("View")
        .selected_text(name(part))
        .width(ui.available_width() - 60.0)
        .truncate()
        .show_index(ui, &mut part, m.parts.len(), name);
    looked.part = part as u32;
}

/// The view's picture, and the rows of the pixel that was clicked, or of that with the most.
fn pixels(view: &View, clicked: &mut Option<[u32; 2]>, ui: &mut Ui) {
    let [width, height] = view.picture.size().map(|side| side as f32);
    let wide = ui.available_width().min(3.0 * width);
    let picture =
        egui::Image::new(&view.picture).fit_to_exact_size(vec2(wide, wide * height / width));
    let response = ui.add(
        picture
            .sense(Sense::click())
            .alt_text("A view of the dataset"),
    );
    let cell = |at: egui::Pos2| {
        let at = (at - response.rect.min) / response.rect.size();
        [(at.x * width) as u32, (at.y * height) as u32]
    };
    if response.clicked() {
        *clicked = response.interact_pointer_pos().map(cell);
    }
    if let Some([x, y]) = *clicked {
        let side = response.rect.width() / width;
        let upper_left = response.rect.min + side * vec2(x as f32, y as f32);
        let mark = Rect::from_min_size(upper_left, vec2(side, side)).expand(2.0);
        let stroke = Stroke::new(1.5, ui.visuals().error_fg_color);
        ui.painter()
            .rect_stroke(mark, 0.0, stroke, egui::StrokeKind::Outside);
    }
    let pixel = clicked.map(|cell| view.grid.pixel(cell));
    let Some(pixel) = pixel.unwrap_or_else(|| view.grid.deepest()) else {
        ui.weak("No rows here.");
        return;
    };
    ui.label(pixel.title());
    let table = pixel.table();
    ScrollArea::horizontal().show(ui, |ui| {
        Grid::new("rows").striped(true).show(ui, |ui| {
            for heading in &table.headings {
                ui.strong(heading);
            }
            ui.end_row();
            for row in &table.rows {
                row.iter().for_each(|value| drop(ui.monospace(value)));
                ui.end_row();
            }
        });
    });
}

fn histogram(ui: &mut Ui, s: &ColumnStatistics) {
    ui.label(format!(
        "{}: {} to {}, mean {}",
        printable(&s.name),
        digits(s.min),
        digits(s.max),
        digits(s.mean)
    ));
    let size = vec2(ui.available_width().max(160.0), 40.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let name = format!("Histogram of {}", printable(&s.name));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &name));
    let most = s.counts.iter().max().copied().unwrap_or(0).max(1) as f32;
    let width = rect.width() / s.counts.len().max(1) as f32;
    for (k, &count) in s.counts.iter().enumerate() {
        let height = rect.height() * count as f32 / most;
        let left = rect.left_bottom() + vec2(k as f32 * width, -height);
        let bar = Rect::from_min_size(left, vec2((width - 1.0).max(1.0), height));
        ui.painter()
            .rect_filled(bar, 0.0, ui.visuals().text_color());
    }
    let bin = response
        .hover_pos()
        .map(|at| ((at.x - rect.left()) / width) as usize);
    if let Some(k) = bin.filter(|k| *k < s.counts.len()) {
        let (edges, rows) = (
            [s.edges[k], s.edges[k + 1]].map(digits),
            counted(s.counts[k], "row"),
        );
        response.on_hover_text(format!("{} to {}: {rows}", edges[0], edges[1]));
    }
}
