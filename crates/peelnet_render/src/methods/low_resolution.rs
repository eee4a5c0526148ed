//! `scale=S`, a parameter of every method: transparency at S times the resolution, upsampled by depth.
//!
//! The method composites over black, at its own size and against its own opaque depth. What comes out is normalised,
//! premultiplied colour with coverage, which may be interpolated; sums and moments may not.

use super::{Build, Compositor, DrawContext, FrameStats};
use crate::{
    RenderError,
    passes::fullscreen::FullscreenPass,
    scene::{FrameTargets, GeometryPipelines, PixelSample, clear_color},
};
use peelnet_gpu::{bind::Bind, wgpu};

/// Colour over black, the black itself, and the opaque depth, at the lower resolution.
const BYTES_PER_SAMPLE: f64 = 16.0 + 16.0 + 4.0;

#[derive(Debug)]
struct LowResolution {
    frame: FrameTargets,
    opaque: Option<GeometryPipelines>,
    method: Box<dyn Compositor>,
    upsample: FullscreenPass,
}

pub(super) fn build(b: &Build<'_>, scale: f32) -> Result<Box<dyn Compositor>, RenderError> {
    let size = b
        .frame
        .size
        .map(|n| ((n as f32 * scale).round() as u32).max(1));
    let frame = b.scene.targets_of(b.gpu, size, b.frame.aspect)?;
    let opaque = b.scene.opaque_pipelines(b.gpu, &frame)?;
    let method = (b.spec.method().build)(&Build {
        frame: &frame,
        ..*b
    })?;
    let mut entries = vec![
        Bind::Texture(&frame.image),
        Bind::Texture(&b.frame.background),
    ];
    let mut features: &[&str] = &[];
    if let (Some(low), Some(full)) = (&frame.depth, &b.frame.depth) {
        entries.extend([
            Bind::Depth(low),
            Bind::Depth(full),
            Bind::Uniform(b.scene.camera_buffer()),
        ]);
        features = &["opaque"];
    }
    let upsample = FullscreenPass::new(
        b.gpu,
        "methods::low_resolution::upsample",
        features,
        &[],
        &entries,
        &[Some(wgpu::TextureFormat::Rgba32Float.into())],
    )?;
    Ok(Box::new(LowResolution {
        frame,
        opaque,
        method,
        upsample,
    }))
}

impl Compositor for LowResolution {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        let frame = &self.frame;
        // The opaque image is already recorded, and reads nothing of the frame's size.
        cx.scene
            .set_view(cx.recorder.gpu(), cx.camera, frame, PixelSample::ALL);
        cx.scene
            .draw_background(cx.recorder, frame, self.opaque.as_ref());
        let black = [clear_color(&frame.background, [0.0, 0.0, 0.0, 1.0])];
        drop(cx.recorder.render("black", &black, None));
        let stats = self.method.draw(&mut DrawContext {
            recorder: cx.recorder,
            frame,
            ..*cx
        })?;
        self.upsample
            .draw(cx.recorder, &[clear_color(&cx.frame.image, [0.0; 4])]);
        let samples = f64::from(frame.pixels()) / f64::from(cx.frame.pixels());
        Ok(FrameStats {
            fullscreen_passes: stats.fullscreen_passes + 2,
            bytes_per_pixel: (stats.bytes_per_pixel + BYTES_PER_SAMPLE) * samples,
            ..stats
        })
    }
}
