//! Training on the scene that is open.

use super::{button, digits, methods, output};
use crate::{app::App, training::Epoch};
use egui::{Align2, ComboBox, DragValue, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use peelnet_model::Recipe;

const TRAIN: &str = "Peels the scene's views and trains in the background; the picture follows";
const TRAIN_ON_ROWS: &str = "Trains in the background on the rows that are not held out; the picture of the open scene follows";
const STOP: &str = "Draws with the network of the last whole epoch";

pub(super) fn show(app: &mut App, ui: &mut Ui) {
    let busy = app.training.is_busy();
    ui.add_enabled_ui(!busy, |ui| settings(app, ui));
    ui.horizontal_wrapped(|ui| {
        if !busy {
            let is_open = app.stage.is_some();
            let (name, about) = match app.dataset {
                Some(_) => ("Train on this dataset", TRAIN_ON_ROWS),
                None => ("Train on this scene", TRAIN),
            };
            let train = egui::Button::new(name);
            let train = ui.add_enabled(is_open, train).on_hover_text(about);
            if train.clicked() {
                app.begin_training(ui.ctx(), None);
            }
        } else if app.training.is_stopping() {
            ui.label("stopping");
        } else if button(ui, "Stop training", STOP) {
            app.training.stop();
        }
        let own = app.first.own_network();
        if own.is_some() && button(ui, "Export network", output::NETWORK) {
            app.export_network();
        }
    });
    let (history, (done, all)) = (&app.training.history, app.training.peeled);
    if let Some(last) = history.last() {
        let of = &last.report;
        ui.label(format!(
            "epoch {} of {}: {}",
            of.epoch,
            of.epochs,
            of.progress()
        ));
        // All epochs take the same time.
        let each = (last.seconds - history[0].seconds) / (history.len() - 1).max(1) as f64;
        let left = each * f64::from(of.epochs - of.epoch);
        if busy && history.len() > 1 {
            ui.weak(format!("about {left:.0} s left"));
        }
        chart(ui, history);
    } else if busy {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(match all {
                0 if app.dataset.is_some() => "reading the dataset".to_owned(),
                0 => "opening a device".to_owned(),
                _ if done == all => "training the first epoch".to_owned(),
                _ => format!("peeled {done} of {all} views"),
            });
        });
    }
    if app.first.own_network().is_some() {
        output::said(app, ui);
    }
}

fn settings(app: &mut App, ui: &mut Ui) {
    let now = app.recipe();
    let list = ComboBox::from_label("Recipe").selected_text(now.name);
    list.show_ui(ui, |ui| {
        let drawn = |r: &Recipe| methods::offered().any(|m| m.name == r.method);
        for recipe in Recipe::ALL.into_iter().filter(drawn) {
            let entry = ui.selectable_label(recipe == now, recipe.name);
            if entry.on_hover_text(recipe.method).clicked() {
                (app.training.recipe, app.training.epochs) = (Some(recipe), None);
            }
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label("Epochs");
        let mut epochs = app.training.epochs.unwrap_or(now.budget.epochs);
        let drag = DragValue::new(&mut epochs).range(1..=100_000);
        if ui.add(drag).labelled_by(label.id).changed() {
            app.training.epochs = Some(epochs);
        }
    });
}

/// The loss of every epoch, on a logarithmic axis.
fn chart(ui: &mut Ui, history: &[Epoch]) {
    let size = vec2(ui.available_width().max(160.0), 90.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Loss by epoch"));
    let painter = ui.painter().with_clip_rect(rect);
    let plot = rect.shrink2(vec2(1.0, 14.0));
    let losses = || history.iter().map(|e| e.loss().max(1e-12).log10());
    let low = losses().fold(f64::INFINITY, f64::min);
    let high = losses().fold(low + 0.05, f64::max);
    let last = history.last().map_or(1, |e| e.report.epochs);
    let points = history.iter().zip(losses()).map(|(epoch, loss)| {
        let x = (epoch.report.epoch - 1) as f32 / (last - 1).max(1) as f32;
        let y = ((loss - low) / (high - low)) as f32;
        plot.left_bottom() + vec2(x * plot.width(), -y * plot.height())
    });
    let (text, weak) = (ui.visuals().text_color(), ui.visuals().weak_text_color());
    painter.rect_stroke(plot, 0.0, Stroke::new(1.0, weak), egui::StrokeKind::Inside);
    painter.add(egui::Shape::line(points.collect(), Stroke::new(1.5, text)));
    let (top, bottom) = (pos2(plot.left(), plot.top() - 1.0), plot.right_bottom());
    for (at, align, words) in [
        (
            top,
            Align2::LEFT_BOTTOM,
            format!("loss {}", digits(10f64.powf(high))),
        ),
        (
            plot.left_bottom(),
            Align2::LEFT_TOP,
            digits(10f64.powf(low)),
        ),
        (bottom, Align2::RIGHT_TOP, format!("epoch {last}")),
    ] {
        painter.text(at, align, words, egui::FontId::proportional(11.0), text);
    }
}
