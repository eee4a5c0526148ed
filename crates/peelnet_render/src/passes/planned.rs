//! Passes that are built, and how a frame of them is drawn.

use super::compositor::{Compositor, DrawContext, FrameStats};
use crate::RenderError;
use crate::geometry::{
    BoxPass, GeometryPipelines, Sorted,
    frame::{clear_color, unwritten_attachment},
    fullscreen::FullscreenPass,
};
use crate::gpu::{Kernel, wgpu};

#[derive(Debug)]
pub(super) struct Planned {
    pub passes: Vec<PlannedPass>,
    /// Storage, cleared at the start of every frame.
    pub cleared: Vec<wgpu::Buffer>,
    /// Of passes that write storage alone.
    pub attachment: Option<wgpu::TextureView>,
    pub sorted: Option<Sorted>,
    pub bytes_per_pixel: f64,
}

#[derive(Debug)]
pub(super) struct PlannedPass {
    pub label: String,
    /// What it writes with what that is cleared to; `None` for the output.
    pub colors: Vec<Option<(wgpu::TextureView, [f64; 4])>>,
    /// [`Target::every`](super::Target::every) of those.
    pub every: u32,
    pub work: Work,
}

#[derive(Debug)]
pub(super) enum Work {
    Surfaces(GeometryPipelines),
    Boxes(BoxPass),
    Threads(Kernel, u32),
    Pixels(FullscreenPass),
}

impl Planned {
    fn count(&self, counts: impl Fn(&Work) -> bool) -> u32 {
        self.passes.iter().filter(|p| counts(&p.work)).count() as u32
    }

    fn draw_geometry(&self, cx: &mut DrawContext<'_, '_>, p: &PlannedPass) {
        let colors = p.colors.iter().map(|color| match color {
            Some((view, start)) => clear_color(view, *start),
            None => cx.output(),
        });
        let mut colors: Vec<_> = colors.collect();
        if colors.is_empty() {
            colors.extend(self.attachment.as_ref().map(unwritten_attachment));
        }
        if let Work::Boxes(boxes) = &p.work {
            boxes.update(cx.recorder, cx.scene);
        }
        let mut pass = cx.recorder.render(&p.label, &colors, None);
        if p.every > 1 {
            let [width, height] = cx.frame.size.map(|n| n as f32 / p.every as f32);
            pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
        }
        match (&p.work, &self.sorted) {
            (Work::Boxes(boxes), _) => boxes.draw(&mut pass, cx.frame),
            (Work::Surfaces(pipelines), Some(sorted)) => {
                sorted.draw(&mut pass, cx.scene, cx.frame, pipelines);
            }
            (Work::Surfaces(pipelines), None) => {
                cx.scene.draw(&mut pass, cx.frame, pipelines);
            }
            (Work::Threads(..) | Work::Pixels(_), _) => {}
        }
    }
}

impl Compositor for Planned {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        if let Some(sorted) = &mut self.sorted {
            sorted.sort(cx.recorder, cx.scene, cx.camera);
        }
        for buffer in &self.cleared {
            cx.recorder.encoder().clear_buffer(buffer, 0, None);
        }
        for p in &self.passes {
            match &p.work {
                Work::Pixels(resolve) => cx.resolve(resolve),
                Work::Threads(kernel, threads) => kernel.dispatch(cx.recorder, *threads),
                Work::Surfaces(_) | Work::Boxes(_) => self.draw_geometry(cx, p),
            }
        }
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: self.count(|w| matches!(w, Work::Surfaces(_))),
            fullscreen_passes: self.count(|w| matches!(w, Work::Threads(..) | Work::Pixels(_))),
            bytes_per_pixel: self.bytes_per_pixel,
            ..Default::default()
        })
    }
}
