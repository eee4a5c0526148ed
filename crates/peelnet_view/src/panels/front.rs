//! Error against time of all methods on this view, as a chart that is clicked.

use super::digits;
use crate::{app::App, front::Point};
use egui::{Color32, Sense, Stroke, Ui, pos2, vec2};

/// Errors below count as this on the chart's axis: an RMSE of 1/100 of a level.
const LEAST_MSE: f64 = 1e-4;

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    let Some(key) = app.key() else {
        return;
    };
    let is_busy = app.front.is_busy();
    ui.horizontal(|ui| {
        if is_busy {
            if ui.button("Stop").clicked() {
                app.front.cancel();
            }
            let measured = app.front.measured.borrow();
            ui.label(format!("{} of {}", measured.done, measured.all));
            ui.spinner();
        } else if ui
            .button("Measure all methods")
            .on_hover_text("Error and GPU time of every method and setting, on this view")
            .clicked()
            && let Some(stage) = app.stage.as_ref().filter(|s| s.layers().is_none())
        {
            app.front.measure(stage, key.clone(), app.size);
        }
    });
    if app.front.is_of_another(&key) {
        ui.weak("Measured on an earlier view.");
    }
    if let Some(failure) = app.front.failure.clone() {
        ui.colored_label(ui.visuals().error_fg_color, failure);
    }
    let points = app.front.measured.borrow().points.clone();
    if points.is_empty() {
        return;
    }
    let own = app.first.spec().to_string();
    let mut chosen = chart(ui, &points, &own);
    ui.checkbox(&mut app.panels.listed, "List");
    if app.panels.listed {
        let listed = list(ui, &points, &own);
        chosen = chosen.or(listed);
    }
    let left_out = app.front.measured.borrow().left_out.clone();
    for (method, why) in left_out {
        ui.weak(format!("{method}: {why}"));
    }
    if let Some(spec) = chosen.and_then(|m| m.parse().ok()) {
        app.first.set_spec(spec);
    }
}

/// The method that was clicked.
fn chart(ui: &mut Ui, points: &[Point], own: &str) -> Option<String> {
    let size = vec2(ui.available_width().max(160.0), 220.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Error against time"));
    let painter = ui.painter().with_clip_rect(rect);
    let plot = rect.shrink2(vec2(30.0, 22.0));
    let span = |of: &dyn Fn(&Point) -> f64| {
        let all = points.iter().map(|p| of(p).log10());
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        (low - 0.05, high.max(low + 0.1) + 0.05)
    };
    let time = |p: &Point| p.time_ms.max(1e-6);
    let error = |p: &Point| p.mse255.max(LEAST_MSE);
    let (times, errors) = (span(&time), span(&error));
    let place = |p: &Point| {
        let share = |x: f64, (low, high): (f64, f64)| ((x.log10() - low) / (high - low)) as f32;
        pos2(
            plot.left() + share(time(p), times) * plot.width(),
            plot.bottom() - share(error(p), errors) * plot.height(),
        )
    };
    let text = ui.visuals().text_color();
    let weak = ui.visuals().weak_text_color();
    painter.rect_stroke(plot, 0.0, Stroke::new(1.0, weak), egui::StrokeKind::Outside);
    let font = egui::FontId::proportional(11.0);
    let write = |at: egui::Pos2, align: egui::Align2, words: String| {
        painter.text(at, align, words, font.clone(), text);
    };
    let ms = |x: f64| format!("{} ms", digits(10f64.powf(x)));
    write(
        plot.left_bottom() + vec2(0.0, 3.0),
        egui::Align2::LEFT_TOP,
        ms(times.0),
    );
    write(
        plot.right_bottom() + vec2(0.0, 3.0),
        egui::Align2::RIGHT_TOP,
        ms(times.1),
    );
    let mse = |x: f64| format!("MSE {}", digits(10f64.powf(x)));
    write(
        plot.left_top() - vec2(0.0, 3.0),
        egui::Align2::LEFT_BOTTOM,
        mse(errors.1),
    );
    write(
        plot.left_bottom() + vec2(3.0, -2.0),
        egui::Align2::LEFT_BOTTOM,
        mse(errors.0),
    );
    let front: Vec<_> = points.iter().filter(|p| p.on_front).map(place).collect();
    painter.add(egui::Shape::line(front, Stroke::new(1.5, weak)));
    let pointer = response.hover_pos();
    let near = |p: &&Point| pointer.map_or(f32::INFINITY, |at| place(p).distance(at));
    let hovered = points.iter().min_by(|a, b| near(a).total_cmp(&near(b)));
    let hovered = hovered.filter(|p| near(p) < 12.0);
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
    let point = hovered?;
    painter.circle_stroke(place(point), 6.0, Stroke::new(1.0, text));
    let about = format!(
        "{}\n{} ms, MSE {}, {:.0} bytes a pixel",
        point.method,
        digits(point.time_ms),
        digits(point.mse255),
        point.bytes_per_pixel
    );
    let response = response.on_hover_text(about);
    response.clicked().then(|| point.method.clone())
}

fn list(ui: &mut Ui, points: &[Point], own: &str) -> Option<String> {
    let mut chosen = None;
    egui::Grid::new("front").striped(true).show(ui, |ui| {
        for head in ["method", "ms", "MSE"] {
            ui.strong(head);
        }
        ui.end_row();
        for point in points {
            let name = if point.on_front {
                egui::RichText::new(&point.method).strong()
            } else {
                egui::RichText::new(&point.method)
            };
            if ui.selectable_label(point.method == own, name).clicked() {
                chosen = Some(point.method.clone());
            }
            ui.monospace(digits(point.time_ms));
            ui.monospace(digits(point.mse255));
            ui.end_row();
        }
    });
    chosen
}
