//! Whole frames of a [`Renderer`]: drawn again where they were too small, read back into images, or timed.

use crate::geometry::{SamplePoint, frame::Output};
use crate::gpu::{
    readback::Download,
    record::{Recorder, Timer},
};
use crate::{
    RenderError,
    frame::{Canvas, Frame, Profile},
    image::Image,
    passes::compositor::Fit,
    renderer::{Prepared, Renderer},
    target::Target,
};
use peelnet_core::srgb;
use peelnet_scene::{Blending, Camera};
use web_time::Instant;

/// Times that a frame is drawn until it has room for all of its fragments. Two do for a frame in one tile.
const MOST_TRIES: u32 = 8;

/// Frames that are drawn until a still image has settled.
const MOST_SETTLING: u32 = 16;

impl Renderer {
    /// Draws until the frame has room for all of its fragments (and, for times, no more than it needs): onto a target, or into an image
    /// of its own.
    async fn drawn(
        &self,
        method: &mut Prepared,
        view: (&Camera, SamplePoint),
        counting: bool,
        target: Option<&Target<'_>>,
    ) -> Result<Profile, RenderError> {
        let (size, output) = match target {
            Some(target) => self.output(target)?,
            None => (method.size(), Output::Image),
        };
        method.pending.clear();
        self.ready(method, size, output, None)?;
        // Passes of tries that were too small: the frame took them too.
        let mut wasted = 0;
        for _ in 0..MOST_TRIES {
            let Some(ready) = &mut method.ready else {
                break;
            };
            let only_count = !ready.compositor.is_ready();
            let start = Instant::now();
            let mut encoder = self.gpu().encoder();
            let mut timer = Timer::new(self.gpu());
            let mut recorder = Recorder::new(self.gpu(), &mut encoder, Some(&mut timer));
            let mut stats =
                self.encode(ready, &mut recorder, view, target, counting, only_count)?;
            let feedback = ready.compositor.feedback();
            let counts = (!feedback.is_empty())
                .then(|| Download::record(self.gpu(), &mut encoder, &feedback));
            let times = timer.finish(self.gpu(), &mut encoder);
            self.gpu().queue.submit([encoder.finish()]);
            self.gpu().submitted_async().await;
            let times = times.await?;
            let words = match counts {
                Some(counts) => counts.read().await?,
                None => Vec::new(),
            };
            self.gpu().check()?;
            let wall_micros = start.elapsed().as_secs_f64() * 1e6;
            let fit = method.learn(&self.scene, true, &words, &mut stats)?;
            if !only_count && (fit == Fit::Whole || (counting && fit == Fit::Loose)) {
                stats.geometry_passes += wasted;
                return Ok(Profile {
                    stats,
                    times,
                    wall_micros,
                });
            }
            wasted += stats.geometry_passes;
        }
        Err(RenderError::Refused(format!(
            "the frame was drawn {MOST_TRIES} times and never had room for all of its fragments"
        )))
    }

    /// Draws a view, counts what its statistics need, and reads the image back. A method that makes frames from those before draws it until it
    /// has settled, where the camera is not where it was, or near. Of several samples a pixel the frame is drawn once for each,
    /// through another place in every pixel, and the images are averaged: any method can, at so many times the time and no more memory.
    ///
    /// # Errors
    /// A lost device, or a frame beyond the adapter's limits.
    pub async fn image_async(
        &self,
        method: &mut Prepared,
        camera: &Camera,
    ) -> Result<Frame, RenderError> {
        let [width, height] = method.size();
        let mut pixels: Vec<[f32; 4]> = Vec::new();
        let mut sum = Profile::default();
        let points = method.points();
        for &point in &points {
            let mut drawn = self.drawn(method, (camera, point), true, None).await?;
            // Times stay those of the first frame: other methods' are, too.
            for _ in 0..MOST_SETTLING {
                if method.is_settled() {
                    break;
                }
                drawn.stats = self.drawn(method, (camera, point), true, None).await?.stats;
            }
            sum.add(drawn);
            let view = method.ready.as_ref().and_then(|r| r.frame.image.as_ref());
            let mut read: Vec<[f32; 4]> = match view {
                Some(view) => self.gpu().read_texture_async(view).await?,
                None => Vec::new(),
            };
            // Images are linear light, whatever colours were mixed in.
            if self.scene.scene().blending == Blending::Display {
                for pixel in &mut read {
                    for shown in &mut pixel[..3] {
                        *shown = srgb::decode(*shown);
                    }
                }
            }
            if pixels.is_empty() {
                pixels = read;
                continue;
            }
            let sums = pixels.as_flattened_mut().iter_mut();
            sums.zip(read.as_flattened()).for_each(|(a, b)| *a += b);
        }
        let share = 1.0 / points.len() as f32;
        pixels
            .as_flattened_mut()
            .iter_mut()
            .for_each(|c| *c *= share);
        Ok(Frame {
            image: Image {
                width,
                height,
                pixels,
            },
            times: sum.times,
            stats: sum.stats,
            wall_micros: sum.wall_micros,
        })
    }

    /// The same as [`Self::image_async`], waiting for the device. Not in a browser.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn image(&self, method: &mut Prepared, camera: &Camera) -> Result<Frame, RenderError> {
        self.gpu().block_on(self.image_async(method, camera))
    }

    /// Draws a view for its time alone, as an engine would: onto a target of 16-bit floats, over what is drawn there. Nothing is counted
    /// or read back but what the method itself needs.
    ///
    /// # Errors
    /// A lost device, or a frame beyond the adapter's limits.
    pub async fn profile_async(
        &self,
        method: &mut Prepared,
        camera: &Camera,
    ) -> Result<Profile, RenderError> {
        let (size, points) = (method.size(), method.points());
        let canvas = match method.canvas.take().filter(|c| c.size() == size) {
            Some(canvas) => canvas,
            None => Canvas::new(self.gpu(), size, method.samples())?,
        };
        let target = Target::cleared(&canvas.view);
        let mut sum = Profile::default();
        for (k, &point) in points.iter().enumerate() {
            let drawn = self.drawn(method, (camera, point), false, Some(&target));
            sum.add(drawn.await?);
            sum.add(canvas.average(self.gpu(), k == 0).await?);
        }
        sum.stats.bytes_per_pixel += canvas.mean_bytes();
        method.canvas = Some(canvas);
        Ok(sum)
    }

    /// The same as [`Self::profile_async`], waiting for the device. Not in a browser.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn profile(&self, method: &mut Prepared, camera: &Camera) -> Result<Profile, RenderError> {
        self.gpu().block_on(self.profile_async(method, camera))
    }
}
