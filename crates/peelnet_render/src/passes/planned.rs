//! Passes that are built, and how a frame of them is drawn.

use super::compositor::{Compositor, DrawContext, FrameStats};
use crate::RenderError;
use crate::geometry::{
    BoxPass, GeometryPipelines, Sorted,
    frame::{clear_color, depth_attachment, unwritten_attachment},
    fullscreen::FullscreenPass,
};
use crate::gpu::{Kernel, wgpu};
use peelnet_core::absorbance::DepthWarp;
use peelnet_scene::Camera;

#[derive(Debug)]
pub(super) struct Planned {
    pub passes: Vec<PlannedPass>,
    pub history: History,
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
    /// The depth that it writes, where it draws pixels, or that its surfaces must lie before.
    pub depth: Option<wgpu::TextureView>,
    /// It draws one pixel in so many, both ways.
    pub every: u32,
    /// Whether it is drawn in the first frame and where the camera jumped only.
    pub after_cuts: bool,
    pub work: Work,
}

/// What is known of the frames before.
#[derive(Debug, Default)]
pub(super) struct History {
    last: Option<(Camera, DepthWarp)>,
    /// Frames since the first, or since the camera jumped.
    frames: u32,
}

/// Frames after which a still image that is made from frame to frame has settled.
const SETTLED: u32 = 12;

/// Of a warped range of 2, what depths may move in it from frame to frame: a bin of what is seen around a pixel.
const STRETCHED: f64 = 0.125;

impl History {
    /// A camera that jumped is a cut, and so is a part that enters the frame where that stretches what all depths are mapped to.
    fn next(&mut self, camera: &Camera, warp: DepthWarp) {
        let is_next = self.last.is_some_and(|(last, before)| {
            let extent = f64::from(camera.far / camera.near);
            let mut depths =
                (0..=32).map(|k| f64::from(camera.near) * extent.powf(f64::from(k) / 32.0));
            let is_near = |depth| (warp.cut(depth) - before.cut(depth)).abs() < STRETCHED;
            !camera.is_cut_from(&last) && depths.all(is_near)
        });
        self.frames = if is_next {
            self.frames.saturating_add(1)
        } else {
            0
        };
        self.last = Some((*camera, warp));
    }
}

#[derive(Debug)]
pub(super) enum Work {
    Surfaces(GeometryPipelines),
    Boxes(BoxPass),
    Threads(Kernel, u32),
    Pixels(FullscreenPass),
}

impl PlannedPass {
    fn attachments<'c>(
        &'c self,
        cx: &DrawContext<'c, '_>,
    ) -> Vec<Option<wgpu::RenderPassColorAttachment<'c>>> {
        let colors = self.colors.iter().map(|color| match color {
            Some((view, start)) => clear_color(view, *start),
            None => cx.output(),
        });
        colors.collect()
    }

    fn depth_attachment(&self) -> Option<wgpu::RenderPassDepthStencilAttachment<'_>> {
        let load = match self.work {
            Work::Pixels(_) => wgpu::LoadOp::Clear(1.0),
            _ => wgpu::LoadOp::Load,
        };
        let attached = |view| depth_attachment(view, load, wgpu::StoreOp::Store);
        self.depth.as_ref().map(attached)
    }
}

impl Planned {
    /// The passes of this frame.
    fn drawn(&self) -> impl Iterator<Item = &PlannedPass> {
        let is_cut = self.history.frames == 0;
        self.passes.iter().filter(move |p| is_cut || !p.after_cuts)
    }

    fn count(&self, counts: impl Fn(&Work) -> bool) -> u32 {
        self.drawn().filter(|p| counts(&p.work)).count() as u32
    }

    fn draw_geometry(&self, cx: &mut DrawContext<'_, '_>, p: &PlannedPass) {
        let mut colors = p.attachments(cx);
        if colors.is_empty() {
            colors.extend(self.attachment.as_ref().map(unwritten_attachment));
        }
        if let Work::Boxes(boxes) = &p.work {
            boxes.update(cx.recorder, cx.scene);
        }
        let mut pass = (cx.recorder).render(&p.label, &colors, p.depth_attachment());
        if p.every > 1 {
            let [width, height] = cx.frame.size.map(|n| n as f32 / p.every as f32);
            pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
            // Where the pass writes no target as small, adapters may draw beyond the viewport.
            pass.set_scissor_rect(0, 0, width.ceil() as u32, height.ceil() as u32);
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
        let warp = cx.scene.depth_warp(cx.camera);
        self.history.next(cx.camera, warp);
        for p in self.drawn() {
            match &p.work {
                Work::Pixels(resolve) if p.colors.contains(&None) => cx.resolve(resolve),
                Work::Pixels(pass) => {
                    let colors = p.attachments(cx);
                    pass.draw_depth(cx.recorder, &colors, p.depth_attachment(), None);
                }
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

    fn is_settled(&self) -> bool {
        self.history.frames >= SETTLED || !self.passes.iter().any(|p| p.after_cuts)
    }
}
