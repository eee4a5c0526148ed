//! Frames of several samples a pixel: the frame is drawn once for each sample, and the pixel is their mean in linear light.
//!
//! Every sample is composited by itself: statistics and sums are never averaged over samples, which would mix what belongs to different
//! surfaces at their edges.

use crate::{error::RenderError, frame::PROFILED, methods::compositor::FrameStats};
use peelnet_gpu::{
    Gpu,
    bind::Bind,
    record::{PassTime, Recorder, Timer},
    wgpu,
};
use peelnet_raster::{
    BACKGROUND_PASS,
    frame::{attachment, clear_color},
    fullscreen::FullscreenPass,
};
use web_time::Instant;

/// What a frame, or several repetitions of it, came to.
#[derive(Debug, Default)]
pub(crate) struct Drawn {
    pub stats: FrameStats,
    pub times: Vec<PassTime>,
    pub wall_micros: f64,
}

impl Drawn {
    /// Adds a repetition: passes, fragments and times add up, memory is used again. The background is one pass, of all repetitions.
    pub fn add(&mut self, next: Self) {
        let Self { stats: a, .. } = self;
        let b = next.stats;
        let fragments = [a.fragments, b.fragments].into_iter().flatten();
        *a = FrameStats {
            fragments: fragments.reduce(|a, b| a + b),
            max_layers: a.max_layers.max(b.max_layers),
            lost: a.lost + b.lost,
            tiles: a.tiles.max(b.tiles),
            geometry_passes: a.geometry_passes + b.geometry_passes,
            fullscreen_passes: a.fullscreen_passes + b.fullscreen_passes,
            bytes_per_pixel: a.bytes_per_pixel.max(b.bytes_per_pixel),
        };
        let mut new = next.times;
        let is_background = |t: &PassTime| t.label == BACKGROUND_PASS;
        if let (Some(all), Some(place)) = (
            self.times.iter_mut().find(|t| is_background(t)),
            new.iter().position(is_background),
        ) {
            all.micros += new.remove(place).micros;
        }
        self.times.append(&mut new);
        self.wall_micros += next.wall_micros;
    }
}

/// The sum of two images; an empty one is black.
pub(crate) fn sum(mut all: Vec<[f32; 4]>, next: Vec<[f32; 4]>) -> Vec<[f32; 4]> {
    if all.is_empty() {
        return next;
    }
    for (a, b) in all.as_flattened_mut().iter_mut().zip(next.as_flattened()) {
        *a += b;
    }
    all
}

/// The mean of the repetitions on the GPU, for times: what an engine would do with them.
#[derive(Debug)]
pub(crate) struct Mean {
    of: wgpu::TextureView,
    pass: FullscreenPass,
    view: wgpu::TextureView,
}

/// Bytes a pixel of the target that repetitions are averaged in.
pub(crate) const MEAN_BYTES: f64 = 8.0;

impl Mean {
    /// Makes the target and the pass ready that reads `canvas`.
    pub fn new(gpu: &Gpu, canvas: &wgpu::TextureView) -> Result<Self, RenderError> {
        let texture = canvas.texture();
        let size = [texture.width(), texture.height()];
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let target = wgpu::ColorTargetState {
            format: PROFILED,
            blend: Some(wgpu::BlendState {
                color: add,
                alpha: add,
            }),
            write_mask: wgpu::ColorWrites::ALL,
        };
        Ok(Self {
            of: canvas.clone(),
            pass: FullscreenPass::new(
                gpu,
                "methods::samples::average",
                &[],
                &[],
                &[Bind::Texture(canvas)],
                &[Some(target)],
            )?,
            view: gpu.texture("mean", PROFILED, size, 1, wgpu::TextureUsages::empty())?,
        })
    }

    /// Whether it reads this target.
    pub fn is_of(&self, canvas: &wgpu::TextureView) -> bool {
        self.of == *canvas
    }

    /// Adds a quarter of the canvas, to nothing if it is the `first`.
    pub async fn take(&self, gpu: &Gpu, first: bool) -> Result<Drawn, RenderError> {
        let start = Instant::now();
        let mut encoder = gpu.encoder();
        let mut timer = Timer::new(gpu);
        let mut recorder = Recorder::new(gpu, &mut encoder, Some(&mut timer));
        let target = if first {
            clear_color(&self.view, [0.0; 4])
        } else {
            attachment(&self.view, wgpu::LoadOp::Load)
        };
        self.pass.draw(&mut recorder, &[target]);
        let times = timer.finish(gpu, &mut encoder);
        gpu.queue.submit([encoder.finish()]);
        gpu.submitted_async().await;
        let times = times.read().await?;
        Ok(Drawn {
            stats: FrameStats {
                fullscreen_passes: 1,
                ..FrameStats::default()
            },
            times,
            wall_micros: start.elapsed().as_secs_f64() * 1e6,
        })
    }
}
