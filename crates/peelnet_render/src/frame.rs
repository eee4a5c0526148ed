//! What becomes of a frame: its image, its times and what the method reports.
//!
//! A frame of several samples a pixel is drawn once for each sample, and the pixel is their mean in linear light. Every sample is
//! composited by itself: statistics and sums are never averaged over samples, which would mix what belongs to different surfaces at
//! their edges.

use crate::geometry::{
    BACKGROUND_PASS, Blend,
    frame::{attachment, clear_color},
    fullscreen::FullscreenPass,
};
use crate::gpu::{
    Gpu,
    bind::Bind,
    record::{PassTime, Recorder, Timer},
    wgpu,
};
use crate::{
    RenderError,
    image::Image,
    passes::{Target, compositor::FrameStats},
};
use peelnet_core::files::counted;
use web_time::Instant;

/// A finished frame.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Linear colour and coverage.
    pub image: Image,
    /// GPU time of every pass, where the adapter measures it.
    pub times: Vec<PassTime>,
    /// What the method reports.
    pub stats: FrameStats,
    /// Clock time from the first command to the last result, read-back of the image not included.
    pub wall_micros: f64,
}

impl Frame {
    /// What is wrong with the picture.
    pub fn warnings(&self) -> Vec<String> {
        let all = [
            (self.stats.lost, "not in the image", "fragment"),
            (self.image.non_finite() as u64, "not finite", "pixel"),
        ];
        let found = all.into_iter().filter(|(count, ..)| *count > 0);
        found
            .map(|(count, what, unit)| format!("{what}: {}", counted(count, unit)))
            .collect()
    }
}

/// A frame that was drawn for its time alone, or the sum of several.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// GPU time of every pass, where the adapter measures it.
    pub times: Vec<PassTime>,
    /// What the method reports.
    pub stats: FrameStats,
    /// Clock time from the first command to the last result, microseconds.
    pub wall_micros: f64,
}

impl Profile {
    /// Adds a repetition: passes, fragments and times add up, memory is used again. The background is one pass, of all repetitions.
    pub(crate) fn add(&mut self, mut next: Self) {
        let (a, b) = (self.stats, next.stats);
        let fragments = [a.fragments, b.fragments].into_iter().flatten();
        self.stats = FrameStats {
            fragments: fragments.reduce(|a, b| a + b),
            max_layers: a.max_layers.max(b.max_layers),
            lost: a.lost + b.lost,
            tiles: a.tiles.max(b.tiles),
            geometry_passes: a.geometry_passes + b.geometry_passes,
            fullscreen_passes: a.fullscreen_passes + b.fullscreen_passes,
            bytes_per_pixel: a.bytes_per_pixel.max(b.bytes_per_pixel),
        };
        let is_background = |t: &PassTime| t.label == BACKGROUND_PASS;
        if let (Some(all), Some(place)) = (
            self.times.iter_mut().find(|t| is_background(t)),
            next.times.iter().position(is_background),
        ) {
            all.micros += next.times.remove(place).micros;
        }
        self.times.append(&mut next.times);
        self.wall_micros += next.wall_micros;
    }
}

/// The passes of the method itself, with its work on the CPU: without the first pass of that name that draws the background and the opaque
/// surfaces, whatever the method.
pub fn of_method(times: &[PassTime]) -> Vec<PassTime> {
    let mut times = times.to_vec();
    if let Some(place) = times.iter().position(|t| t.label == BACKGROUND_PASS) {
        times.remove(place);
    }
    times
}

/// GPU time of passes; none without timestamps.
pub fn milliseconds(times: &[PassTime]) -> Option<f64> {
    let micros: f64 = times.iter().map(|t| t.micros).sum();
    (micros > 0.0).then_some(micros / 1e3)
}

/// As engines draw transparency onto before they map tones.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The target of a [`crate::Renderer::profile`].
#[derive(Debug)]
pub(crate) struct Canvas {
    pub view: wgpu::TextureView,
    /// The pass that averages several samples, and what it writes.
    mean: Option<(FullscreenPass, wgpu::TextureView)>,
}

impl Canvas {
    pub fn new(gpu: &Gpu, size: [u32; 2], samples: u32) -> Result<Self, RenderError> {
        let none = wgpu::TextureUsages::empty();
        let view = gpu.texture("canvas", FORMAT, size, 1, none)?;
        let mean = if samples > 1 {
            let (shader, entries) = (
                "passes::samples::average",
                [("repetition", Bind::Texture(&view))],
            );
            let mean = Target::half("mean", 4, Blend::Add);
            let target = [Some(mean.state())];
            let pass = FullscreenPass::new(gpu, shader, &[], &[], &entries, &target, 1)?;
            let view = gpu.texture(mean.name, mean.format(), size, 1, none)?;
            Some((pass, view))
        } else {
            None
        };
        Ok(Self { view, mean })
    }

    pub fn size(&self) -> [u32; 2] {
        let texture = self.view.texture();
        [texture.width(), texture.height()]
    }

    /// Adds a quarter of the canvas to the mean of the samples, to nothing if it is the `first`: what an engine would do with them.
    /// Nothing happens where there is one sample.
    pub async fn average(&self, gpu: &Gpu, first: bool) -> Result<Profile, RenderError> {
        let Some((pass, view)) = &self.mean else {
            return Ok(Profile::default());
        };
        let start = Instant::now();
        let mut encoder = gpu.encoder();
        let mut timer = Timer::new(gpu);
        let mut recorder = Recorder::new(gpu, &mut encoder, Some(&mut timer));
        let target = if first {
            clear_color(view, [0.0; 4])
        } else {
            attachment(view, wgpu::LoadOp::Load)
        };
        pass.draw(&mut recorder, &[target], None);
        let times = timer.finish(gpu, &mut encoder);
        gpu.queue.submit([encoder.finish()]);
        gpu.submitted_async().await;
        Ok(Profile {
            stats: FrameStats {
                fullscreen_passes: 1,
                ..FrameStats::default()
            },
            times: times.await?,
            wall_micros: start.elapsed().as_secs_f64() * 1e6,
        })
    }

    /// Bytes a pixel of what samples are averaged in.
    pub fn mean_bytes(&self) -> f64 {
        if self.mean.is_some() { 8.0 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Work on the CPU comes before all passes. The first pass of the background is none of the method's; one at a lower resolution is.
    #[test]
    fn the_background_is_not_the_methods() {
        let times: Vec<PassTime> = ["sort", BACKGROUND_PASS, BACKGROUND_PASS, "blend"]
            .iter()
            .zip([8.0, 4.0, 2.0, 1.0])
            .map(|(label, micros)| PassTime {
                label: (*label).to_owned(),
                micros,
            })
            .collect();
        let left: f64 = of_method(&times).iter().map(|t| t.micros).sum();
        assert_eq!(left, 8.0 + 2.0 + 1.0);
        assert_eq!(of_method(&times[3..]), times[3..]);
    }
}
