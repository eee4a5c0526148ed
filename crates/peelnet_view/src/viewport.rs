//! The picture in the window, and what is done to it with pointers and fingers.

use crate::{app::App, compare::Mode, eye};
use eframe::egui_wgpu::RenderState;
use egui::{Align2, Color32, PointerButton, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

/// Radians of an orbit that a drag over the height of the picture makes.
const ORBIT: f32 = std::f32::consts::PI;
/// How much closer a step of the wheel comes: `e` to this times the points scrolled.
const WHEEL: f32 = 0.002;
/// Points beside the divider where it can be taken.
const GRIP: f32 = 8.0;

impl App {
    /// Shows the picture over the room that is left, and takes what is done to it.
    pub fn show_viewport(&mut self, ui: &mut Ui, egui: &RenderState) {
        let room = ui.available_rect_before_wrap();
        let scale = ui.ctx().pixels_per_point();
        // Whole pixels, so that each of the picture's is one of the window's.
        let snap = |x: f32| (x * scale).round() / scale;
        let min = pos2(snap(room.min.x), snap(room.min.y));
        let size = [room.width(), room.height()].map(|x| ((x * scale).floor() as u32).max(1));
        let rect = Rect::from_min_size(min, vec2(size[0] as f32, size[1] as f32) / scale);
        let picture = ui.interact(rect, ui.scope_id().with("picture"), Sense::click_and_drag());
        picture
            .widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Picture of the scene"));
        let on_divider = self.show_divider(ui, rect);
        if !on_divider {
            self.move_by_pointer(ui, &picture, rect);
        }
        if let Some(texture) = self.draw(egui, ui.ctx(), size) {
            let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture, rect, all, Color32::WHITE);
        }
        if !self.panels.bare {
            self.show_marks(ui, rect, scale);
        }
    }

    fn move_by_pointer(&mut self, ui: &Ui, picture: &egui::Response, rect: Rect) {
        let ctx = ui.ctx().clone();
        let touches = ctx.input(|i| i.multi_touch());
        if let Some(touch) = touches.filter(|_| picture.hovered() || picture.dragged()) {
            let by = touch.translation_delta / rect.height();
            self.move_eye(|camera, all| {
                eye::pan(camera, by.x, by.y);
                eye::zoom(camera, 1.0 / touch.zoom_delta.max(0.1), all);
            });
            return;
        }
        let by = picture.drag_delta() / rect.height();
        let shift = ctx.input(|i| i.modifiers.shift);
        if by != egui::Vec2::ZERO {
            if picture.dragged_by(PointerButton::Primary) && !shift {
                self.move_eye(|camera, _| eye::orbit(camera, -ORBIT * by.x, ORBIT * by.y));
            } else {
                self.move_eye(|camera, _| eye::pan(camera, by.x, by.y));
            }
        }
        if picture.hovered() {
            let (scroll, pinch) = ctx.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            let factor = (-WHEEL * scroll).exp() / pinch;
            if factor != 1.0 {
                self.move_eye(|camera, all| eye::zoom(camera, factor, all));
            }
        }
        if let Some(at) = picture.interact_pointer_pos().filter(|_| picture.clicked()) {
            let at = (at - rect.min) * ctx.pixels_per_point();
            let mut pixel = [at.x.max(0.0) as u32, at.y.max(0.0) as u32];
            if self.compare.mode == Mode::Beside {
                // Both halves show the same view.
                pixel[0] %= self.size[0].div_ceil(2).max(1);
            }
            self.inspector.pixel = Some(pixel);
        }
    }

    /// Shows the divider of split pictures; whether it is dragged.
    fn show_divider(&mut self, ui: &Ui, rect: Rect) -> bool {
        if self.compare.mode != Mode::Split {
            return false;
        }
        let x = rect.left() + self.compare.divider * rect.width();
        let grip = Rect::from_x_y_ranges(x - GRIP..=x + GRIP, rect.y_range());
        let divider = ui.interact(grip, ui.scope_id().with("divider"), Sense::drag());
        let share = f64::from(self.compare.divider);
        divider.widget_info(|| WidgetInfo::slider(true, share, "Divider"));
        if divider.hovered() || divider.dragged() {
            ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
        }
        if let Some(at) = divider.interact_pointer_pos().filter(|_| divider.dragged()) {
            let share = (at.x - rect.left()) / rect.width();
            self.compare.divider = share.clamp(0.0, 1.0);
        }
        divider.dragged()
    }

    /// Draws the divider, the names of both methods, the scale of a map and the pixel that was clicked over the picture.
    fn show_marks(&self, ui: &Ui, rect: Rect, scale: f32) {
        let painter = ui.painter().with_clip_rect(rect);
        let line = Stroke::new(1.5, Color32::WHITE);
        let write = |x: f32, align: Align2, text: String| {
            let font = egui::FontId::proportional(13.0);
            let galley = painter.layout_no_wrap(text, font, Color32::WHITE);
            let place = align.anchor_size(pos2(x, rect.top() + 6.0), galley.size());
            let back = place.expand2(vec2(5.0, 2.0));
            painter.rect_filled(back, 3.0, Color32::from_black_alpha(170));
            painter.galley(place.min, galley, Color32::WHITE);
        };
        let corner = |text: String| write(rect.left() + 10.0, Align2::LEFT_TOP, text);
        let [first, second] = [&self.first, &self.second].map(|slot| slot.spec.to_string());
        let mode = self.compare.mode_at(ui.ctx());
        match mode {
            Mode::Split | Mode::Beside => {
                let split = Some(self.compare.divider).filter(|_| mode == Mode::Split);
                let share = split.unwrap_or(0.5);
                let x = rect.left() + share * rect.width();
                painter.vline(x, rect.y_range(), line);
                write(x - 10.0, Align2::RIGHT_TOP, first);
                write(x + 10.0, Align2::LEFT_TOP, second);
            }
            Mode::Error => corner(format!(
                "|{first} - {second}|: black 0, yellow {:.0} of 255",
                self.compare.scale
            )),
            Mode::Layers => corner(match self.counter.map() {
                Some(map) => format!("layers: black 0, yellow {:.0}", map.most),
                None => "counting layers".to_owned(),
            }),
            Mode::Flicker => corner(first),
            Mode::Second => corner(second),
            Mode::One => {}
        }
        if let Some([x, y]) = self.inspector.pixel {
            let at = rect.min + vec2(x as f32 + 0.5, y as f32 + 0.5) / scale;
            painter.circle_stroke(at, 6.0, Stroke::new(3.0, Color32::BLACK));
            painter.circle_stroke(at, 6.0, line);
        }
    }
}
