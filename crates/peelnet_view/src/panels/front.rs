//! Error against time of all methods on this view, as a chart that is clicked.

use super::{button, digits, error};
use crate::{app::App, front::Point};
use egui::{Align2, Color32, RichText, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

/// Errors below count as this on the chart's axis: an RMSE of 1/100 of a level.
const LEAST_MSE: f64 = 1e-4;

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    let Some(key) = app.key() else { return };
    ui.horizontal(|ui| {
        let about = "Error and GPU time of every method and setting, on this view";
        if app.front.job.is_busy() {
            if ui.button("Stop").clicked() {
                app.front.job.cancel();
            }
            let measured = app.front.measured.borrow();
            let done = measured.points.len() + measured.left_out.len();
            ui.label(format!("{done} of {}", measured.all));
            ui.spinner();
        } else if button(ui, "Measure all methods", about)
            && let Some(stage) = app.stage.as_ref().filter(|s| s.shown.layers.is_none())
        {
            app.front.measure(stage, key.view);
        }
    });
    if app.front.view.is_some_and(|measured| measured != key.view) {
        ui.weak("Measured on an earlier view.");
    }
    if let Some(Err(e)) = app.front.job.get(&()) {
        error(ui, e);
    }
    let measured = std::rc::Rc::clone(&app.front.measured);
    let measured = measured.borrow();
    let points = &measured.points;
    if points.is_empty() {
        return;
    }
    let own = app.first.spec.to_string();
    let mut chosen = chart(ui, points, &own);
    ui.checkbox(&mut app.panels.listed, "List");
    if app.panels.listed {
        chosen = list(ui, points, &own).or(chosen);
    }
    for (method, why) in &measured.left_out {
        ui.weak(format!("{method}: {why}"));
    }
    if let Some(spec) = chosen.and_then(|m| m.parse().ok()) {
        app.first.set_spec(spec);
    }
}

fn chart<'a>(ui: &mut Ui, points: &'a [Point], own: &str) -> Option<&'a str> {
    let size = vec2(ui.available_width().max(160.0), 220.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Error against time"));
    let painter = ui.painter().with_clip_rect(rect);
    let plot = rect.shrink2(vec2(30.0, 22.0));
    // Logarithms of time and error.
    let at = |p: &Point| [p.time_ms.max(1e-6), p.mse255.max(LEAST_MSE)].map(f64::log10);
    let [times, errors] = [0, 1].map(|axis: usize| {
        let all = points.iter().map(|p| at(p)[axis]);
        let low = all.clone().fold(f64::INFINITY, f64::min);
        (low - 0.05, all.fold(low + 0.1, f64::max) + 0.05)
    });
    let place = |p: &Point| {
        let share = |x: f64, (low, high): (f64, f64)| ((x - low) / (high - low)) as f32;
        let [time, error] = at(p);
        pos2(
            plot.left() + share(time, times) * plot.width(),
            plot.bottom() - share(error, errors) * plot.height(),
        )
    };
    let (text, weak) = (ui.visuals().text_color(), ui.visuals().weak_text_color());
    painter.rect_stroke(plot, 0.0, Stroke::new(1.0, weak), egui::StrokeKind::Outside);
    let ms = |x: f64| format!("{} ms", digits(10f64.powf(x)));
    let mse = |x: f64| format!("MSE {}", digits(10f64.powf(x)));
    let (bottom, top) = (plot.bottom() + 3.0, plot.top() - 3.0);
    let low = pos2(plot.left() + 3.0, plot.bottom() - 2.0);
    for (at, align, words) in [
        (pos2(plot.left(), bottom), Align2::LEFT_TOP, ms(times.0)),
        (pos2(plot.right(), bottom), Align2::RIGHT_TOP, ms(times.1)),
        (pos2(plot.left(), top), Align2::LEFT_BOTTOM, mse(errors.1)),
        (low, Align2::LEFT_BOTTOM, mse(errors.0)),
    ] {
        painter.text(at, align, words, egui::FontId::proportional(11.0), text);
    }
    let front: Vec<_> = points.iter().filter(|p| p.on_front).map(place).collect();
    painter.add(egui::Shape::line(front, Stroke::new(1.5, weak)));
    for point in points {
        // Blue and orange differ for every kind of colour vision; size tells the front as well.
        let (radius, color) = if point.on_front {
            (4.0, Color32::from_rgb(230, 159, 0))
        } else {
            (2.5, Color32::from_rgb(86, 180, 233))
        };
        painter.circle_filled(place(point), radius, color);
        if point.method == own {
            painter.circle_stroke(place(point), 7.0, Stroke::new(2.0, text));
        }
    }
    let pointer = response.hover_pos()?;
    let near = |p: &&Point| place(p).distance(pointer);
    let point = points.iter().min_by(|a, b| near(a).total_cmp(&near(b)))?;
    if near(&point) >= 12.0 {
        return None;
    }
    painter.circle_stroke(place(point), 6.0, Stroke::new(1.0, text));
    let (ms, mse) = (digits(point.time_ms), digits(point.mse255));
    let (method, bytes) = (&point.method, point.bytes_per_pixel);
    let about = format!("{method}\n{ms} ms, MSE {mse}, {bytes:.0} bytes a pixel");
    let response = response.on_hover_text(about);
    response.clicked().then_some(method)
}

fn list<'a>(ui: &mut Ui, points: &'a [Point], own: &str) -> Option<&'a str> {
    let mut chosen = None;
    egui::Grid::new("front").striped(true).show(ui, |ui| {
        for head in ["method", "ms", "MSE"] {
            ui.strong(head);
        }
        ui.end_row();
        for point in points {
            let mut name = RichText::new(&point.method);
            if point.on_front {
                name = name.strong();
            }
            if ui.selectable_label(point.method == own, name).clicked() {
                chosen = Some(point.method.as_str());
            }
            ui.monospace(digits(point.time_ms));
            ui.monospace(digits(point.mse255));
            ui.end_row();
        }
    });
    chosen
}
