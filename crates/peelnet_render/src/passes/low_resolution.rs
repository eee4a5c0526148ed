//! `scale=S`, a parameter of every method: transparency at S times the resolution, upsampled by depth.
//!
//! The method composites over black, at its own size and against its own opaque depth. The result is normalised,
//! premultiplied colour with coverage, which may be interpolated; sums and moments may not.

use super::compositor::{Build, Compositor, DrawContext, Fit, FrameStats, resolve};
use crate::RenderError;
use crate::geometry::{
    FrameTargets, PixelSample,
    frame::{Output, clear_color},
    fullscreen::FullscreenPass,
};
use crate::gpu::{bind::Bind, wgpu};

/// Colour over black, the black itself, and the opaque depth, at the lower resolution.
const BYTES_PER_SAMPLE: f64 = 16.0 + 16.0 + 4.0;

#[derive(Debug)]
struct LowResolution {
    frame: FrameTargets,
    method: Box<dyn Compositor>,
    upsample: FullscreenPass,
}

pub(crate) fn build(b: &Build<'_>, scale: f32) -> Result<Box<dyn Compositor>, RenderError> {
    let full = b.frame;
    let fault = match &full.depth {
        Some(depth) if depth.is_callers => Some(
            "draws at a lower resolution, against opaque surfaces of the scene: leave the target's depth out",
        ),
        Some(depth) if depth.samples() > 1 => Some(
            "upsamples by the depth of opaque surfaces, which has several samples a pixel here: use a target of one sample",
        ),
        _ => None,
    };
    if let Some(fault) = fault {
        return Err(RenderError::Target(format!("{} {fault}", b.spec)));
    }
    let size = full
        .size
        .map(|n| ((n as f32 * scale).round() as u32).max(1));
    let gpu = &b.scene.gpu;
    let mut frame = b.scene.targets(size, Output::Image, None)?;
    // Rounded sides make pixels that are not square.
    frame.aspect = full.aspect;
    let method = b.spec.method().build(&Build {
        frame: &frame,
        ..*b
    })?;
    let [width, height] = full.size;
    let extent = [width, height, 0, 0];
    let extent = gpu.upload("full extent", &extent, wgpu::BufferUsages::UNIFORM);
    let mut entries = vec![
        // Its output is one.
        (
            "low",
            Bind::Texture(frame.image.as_ref().unwrap_or(&frame.background)),
        ),
        ("background", Bind::Texture(&full.background)),
        ("full", Bind::Uniform(&extent)),
    ];
    let mut features: &[&str] = &[];
    if let (Some(low), Some(full)) = (&frame.depth, &full.depth) {
        entries.extend([
            ("low_depth", Bind::Texture(&low.view)),
            ("full_depth", Bind::Texture(&full.view)),
            ("camera", Bind::Uniform(&b.scene.camera)),
        ]);
        features = &["opaque"];
    }
    let shader = "passes::low_resolution::upsample";
    Ok(Box::new(LowResolution {
        upsample: resolve(gpu, full, shader, features, &[], &entries)?,
        frame,
        method,
    }))
}

impl Compositor for LowResolution {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        let output = cx.output();
        let frame = &self.frame;
        cx.scene
            .set_view(cx.recorder, cx.camera, frame, PixelSample::ALL, cx.point);
        cx.scene.draw_background(cx.recorder, frame, None, true);
        let black = [clear_color(&frame.background, [0.0, 0.0, 0.0, 1.0])];
        drop(cx.recorder.render("black", &black, None));
        let stats = self.method.draw(&mut DrawContext {
            recorder: cx.recorder,
            frame,
            target: None,
            ..*cx
        })?;
        self.upsample.draw(cx.recorder, &[output], None);
        let samples = f64::from(frame.pixels()) / f64::from(cx.frame.pixels());
        Ok(FrameStats {
            fullscreen_passes: stats.fullscreen_passes + 2,
            bytes_per_pixel: (stats.bytes_per_pixel + BYTES_PER_SAMPLE) * samples,
            ..stats
        })
    }

    fn is_ready(&self) -> bool {
        self.method.is_ready()
    }

    fn is_settled(&self) -> bool {
        self.method.is_settled()
    }

    fn feedback(&self) -> Vec<wgpu::Buffer> {
        self.method.feedback()
    }

    fn learn(
        &mut self,
        b: &Build<'_>,
        exact: bool,
        words: &[Vec<u32>],
        stats: &mut FrameStats,
    ) -> Result<Fit, RenderError> {
        let samples = f64::from(self.frame.pixels()) / f64::from(b.frame.pixels());
        let b = Build {
            frame: &self.frame,
            ..*b
        };
        // What is known only now is counted by pixels of the low resolution.
        let drawn = std::mem::take(&mut stats.bytes_per_pixel);
        let fit = self.method.learn(&b, exact, words, stats)?;
        stats.bytes_per_pixel = drawn + stats.bytes_per_pixel * samples;
        Ok(fit)
    }
}
