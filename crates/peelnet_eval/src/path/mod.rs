//! Methods along a path: errors of every frame, how they change from frame to frame, and how visible that is in the video.
//!
//! A method with a small error may still pop (painters, where the order of objects changes) or swim (noise and stripes that stay on the
//! screen while surfaces move). The *error image* of a frame is the difference of its sRGB-encoded values, on the 0–255 scale and not
//! rounded, from those of the exact image; its *change* is the mean absolute difference from the frame before, over pixels and channels.
//! An error that is glued to its surface changes as well, by as much as the surface moves: compare methods of like errors. Borders that the
//! error image has inside surfaces are counted as [`contours`](crate::contours).
//!
//! The exact frames of a scene are kept, and the frames of one method at a time: 45 bytes a pixel.

pub mod motion;
mod strip;
pub mod video;

pub use crate::records::{Along, FrameRow, PathRow};

use crate::{
    EvalError,
    bench::{Progress, check_names},
    compare::{EXACT, Plan, image_name},
    contours::{Pairs, SURFACES},
    metrics::{Differences, differences, error_image, psnr},
    perceptual::Displayed,
    rows::mean,
    stage::{Ready, Stage, Watch, exact_method},
};
use colorvideovdp::Image as VideoFrame;
use motion::{Moment, moment};
use peelnet_gpu::Gpu;
use peelnet_render::{Image, MethodSpec, Renderer};
use peelnet_scene::Scene;
use std::sync::atomic::AtomicBool;
use strip::Strip;
use video::{FPS, Judge};

/// Bytes that a path may keep.
const MAX_PATH_BYTES: u64 = 1 << 31;

/// Bytes of a pixel of a frame that are kept: the exact image in linear light (16), as it is shown (4) and as the metric sees it (12), a
/// method's frame as the metric sees it (12), and which of its neighbours show the same surfaces (1).
const BYTES_PER_PIXEL: u64 = 45;

/// # Errors
/// All frames of two videos that do not fit.
fn check_length(size: [u32; 2], frames: u32) -> Result<(), EvalError> {
    let factors = [size[0], size[1], frames].map(u64::from);
    let needed = factors
        .into_iter()
        .fold(BYTES_PER_PIXEL, u64::saturating_mul);
    if needed > MAX_PATH_BYTES {
        return Err(EvalError::LongPath {
            frames,
            size,
            needed,
            most: MAX_PATH_BYTES,
        });
    }
    Ok(())
}

/// Mean absolute value over pixels and channels.
pub fn mean_absolute(image: &[[f32; 3]]) -> f64 {
    let all = image.as_flattened();
    let sum: f64 = all.iter().map(|&x| f64::from(x.abs())).sum();
    sum / all.len().max(1) as f64
}

/// By how much an error image changed.
fn change_of(before: &[[f32; 3]], after: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let pixels = before.iter().zip(after);
    pixels
        .map(|(b, a)| std::array::from_fn(|k| a[k] - b[k]))
        .collect()
}

/// Takes a method's frames one after the other.
struct Video<'a> {
    method: &'a str,
    scene: &'a str,
    rows: Vec<FrameRow>,
    squares_8bit: f64,
    before: Option<Vec<[f32; 3]>>,
}

impl Video<'_> {
    /// Adds the next frame, with its ꟻLIP and its share of contour pairs. Returns its error image and how that changed.
    fn add(
        &mut self,
        errors: Vec<[f32; 3]>,
        found: &Differences,
        flip: f64,
        contour_pairs: Option<f64>,
    ) -> (&[[f32; 3]], Option<Vec<[f32; 3]>>) {
        let change = self
            .before
            .as_ref()
            .map(|before| change_of(before, &errors));
        self.squares_8bit += found.mse_8bit;
        self.rows.push(FrameRow {
            method: self.method.to_owned(),
            scene: self.scene.to_owned(),
            frame: self.rows.len() as u32,
            mse_linear: found.mse_linear,
            psnr: found.psnr,
            flip,
            error: mean_absolute(&errors),
            change: change.as_deref().map(mean_absolute),
            contour_pairs,
        });
        (self.before.insert(errors), change)
    }

    fn row(&self, jod: Option<f64>) -> PathRow {
        let values = |value: fn(&FrameRow) -> Option<f64>| self.rows.iter().filter_map(value);
        let all = |value| mean(values(value)).unwrap_or_default();
        PathRow {
            method: self.method.to_owned(),
            scene: self.scene.to_owned(),
            frames: self.rows.len() as u32,
            mse_linear: all(|r| Some(r.mse_linear)),
            psnr: psnr(self.squares_8bit / self.rows.len().max(1) as f64),
            flip: all(|r| Some(r.flip)),
            error: all(|r| Some(r.error)),
            change: mean(values(|r| r.change)),
            change_max: values(|r| r.change).reduce(f64::max),
            contour_pairs: mean(values(|r| r.contour_pairs)),
            jod,
        }
    }
}

/// The exact frame and what it is compared as.
struct Exact {
    image: Image,
    shown: Displayed,
    pairs: Pairs,
}

/// A scene's path under measurement.
struct Take<'a, 'w> {
    stage: Stage<'a>,
    plan: &'a Plan<'a>,
    moments: Vec<Moment>,
    watch: &'a mut Watch<'w>,
}

impl Take<'_, '_> {
    fn ready(&self, method: &MethodSpec) -> Result<Ready, EvalError> {
        self.stage.ready(method, self.plan.options(method))
    }

    /// Draws all frames with what is ready, and hands each to `take`.
    fn draw(
        &mut self,
        mut ready: Ready,
        take: &mut dyn FnMut(usize, Image) -> Result<(), EvalError>,
    ) -> Result<(), EvalError> {
        for (k, moment) in self.moments.iter().enumerate() {
            self.watch.check()?;
            for (number, place) in moment.objects.iter().enumerate() {
                let moved = self.stage.renderer.set_transform(number, *place);
                moved.map_err(self.stage.failed(&ready.name))?;
            }
            take(k, self.stage.image(&mut ready, &moment.camera)?.image)?;
            if ready.name != SURFACES {
                self.watch.drawn(&self.stage.scene.name, &ready.name);
            }
        }
        Ok(())
    }

    /// Draws all frames exactly, and finds which neighbours show the same surfaces. Returns them with the frames of the video.
    fn draw_exact(&mut self) -> Result<(Vec<Exact>, Vec<VideoFrame>), EvalError> {
        let Plan { size, samples, .. } = *self.plan;
        let surfaces = |r: &Renderer| r.surfaces(size, samples);
        let surfaces = self.stage.prepare(SURFACES, surfaces)?;
        let mut pairs = Vec::with_capacity(self.moments.len());
        self.draw(surfaces, &mut |_, image| {
            pairs.push(Pairs::of(&image));
            Ok(())
        })?;
        let (mut exact, mut reference) = (Vec::new(), Vec::new());
        let mut strip = Strip::new(size, pairs.len());
        let mut pairs = pairs.into_iter();
        self.draw(self.ready(&exact_method())?, &mut |k, image| {
            let shown = Displayed::new(&image);
            strip.add_frame(k, &image);
            reference.extend(video::frame(&shown)?);
            exact.extend(pairs.next().map(|pairs| Exact {
                image,
                shown,
                pairs,
            }));
            Ok(())
        })?;
        self.save(&strip, EXACT)?;
        Ok((exact, reference))
    }

    fn save(&self, strip: &Strip, method: &str) -> Result<(), EvalError> {
        let Some(folder) = self.plan.images else {
            return Ok(());
        };
        let path = folder.join(image_name(&self.stage.scene.name, method));
        let saved = strip.image().save(&path);
        saved.map_err(self.stage.failed(method))
    }

    /// Measures one method against the exact frames.
    fn measure(
        &mut self,
        method: &MethodSpec,
        exact: &[Exact],
        reference: &[VideoFrame],
        judge: &Judge,
    ) -> Result<(PathRow, Vec<FrameRow>), EvalError> {
        let name = method.to_string();
        let mut all = Video {
            method: &name,
            scene: &self.stage.scene.name,
            rows: Vec::new(),
            squares_8bit: 0.0,
            before: None,
        };
        let mut strip = Strip::new(self.plan.size, exact.len());
        let mut video = Vec::with_capacity(reference.len());
        self.draw(self.ready(method)?, &mut |k, image| {
            let against = &exact[k];
            let shown = Displayed::new(&image);
            let found = differences(&against.image.pixels, &image.pixels)?;
            let errors = error_image(&against.image.pixels, &image.pixels)?;
            let contours = against.pairs.share(&errors)?;
            let flip = shown.flip(&against.shown);
            let (errors, change) = all.add(errors, &found, flip, contours);
            strip.add_errors(k, errors, change.as_deref());
            if !reference.is_empty() {
                video.extend(video::frame(&shown)?);
            }
            Ok(())
        })?;
        self.save(&strip, &name)?;
        let jod = match reference {
            [] => None,
            reference => Some(judge.jod(&video, reference)?),
        };
        Ok((all.row(jod), all.rows))
    }
}

/// Measures all methods of a plan along the paths of all scenes, of so many frames as it has; strips of frames are saved as
/// `<scene>-<method>.png`. With [`Plan::lenient`], a method that has no passes is left out, too.
///
/// # Errors
/// If a method cannot draw, a path is too long to be kept, or a picture cannot be written; [`EvalError::Interrupted`] once `stop` is set.
pub fn measure(
    gpu: &Gpu,
    scenes: &[Scene],
    plan: &Plan<'_>,
    stop: &AtomicBool,
    report: &mut dyn FnMut(Progress<'_>),
) -> Result<Along, EvalError> {
    check_names(scenes)?;
    check_length(plan.size, plan.frames)?;
    if let Some(folder) = plan.images {
        std::fs::create_dir_all(folder).map_err(EvalError::io(folder, "create the folder"))?;
    }
    let frames = plan.frames;
    let methods = plan.methods.iter().filter(|m| **m != exact_method());
    let methods: Vec<&MethodSpec> = methods.collect();
    let judge = Judge::new()?;
    let mut found = Along {
        size: plan.size,
        samples: plan.samples,
        frames,
        fps: FPS,
        display: Judge::display(),
        rows: Vec::new(),
        by_frame: Vec::new(),
    };
    let total = (scenes.len() * (methods.len() + 1)) as u64 * u64::from(frames);
    let mut watch = Watch::new(total, stop, report);
    for scene in scenes {
        let moments = (0..frames).map(|k| moment(scene, k as f32 / frames as f32));
        let mut take = Take {
            stage: Stage::new(gpu, scene)?,
            plan,
            moments: moments.collect(),
            watch: &mut watch,
        };
        let (exact, reference) = take.draw_exact()?;
        for method in &methods {
            let why = match method.method().cpu_only {
                Some(why) if plan.lenient => why.to_owned(),
                _ => match take.measure(method, &exact, &reference, &judge) {
                    Err(e) if plan.lenient && e.is_too_large() => e.reason(),
                    measured => {
                        let (row, by_frame) = measured?;
                        found.rows.push(row);
                        found.by_frame.extend(by_frame);
                        continue;
                    }
                },
            };
            let name = method.to_string();
            take.watch.left_out(&scene.name, &name, why);
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::ERROR_ROUNDING;
    use peelnet_core::srgb;

    fn gray(level: f32) -> Vec<[f32; 4]> {
        vec![[srgb::decode(level / 255.0); 4]; 6]
    }

    /// A video of one exact grey and of these levels.
    fn row_of(exact: &[f32], levels: &[f32]) -> PathRow {
        let mut video = Video {
            method: "m",
            scene: "s",
            rows: Vec::new(),
            squares_8bit: 0.0,
            before: None,
        };
        for (&exact, &level) in exact.iter().zip(levels) {
            let errors = error_image(&gray(exact), &gray(level)).unwrap();
            let found = differences(&gray(exact), &gray(level)).unwrap();
            let frame = video.rows.len();
            let contour_pairs = (frame > 0).then_some(frame as f64 / 8.0);
            video.add(errors, &found, 0.0, contour_pairs);
        }
        video.row(None)
    }

    /// Errors of 10, −10, 10 and 4 levels: the mean error is 8.5, the changes are 20, 20 and 6, and PSNR is of the mean of their squares, 79.
    #[test]
    fn changes_of_a_known_sequence() {
        let row = row_of(&[100.0; 4], &[110.0, 90.0, 110.0, 104.0]);
        assert!((row.error - 8.5).abs() < ERROR_ROUNDING, "{}", row.error);
        assert!((row.change.unwrap() - 46.0 / 3.0).abs() < 2.0 * ERROR_ROUNDING);
        assert!((row.change_max.unwrap() - 20.0).abs() < 2.0 * ERROR_ROUNDING);
        let want = 10.0 * (255.0f64 * 255.0 / 79.0).log10();
        assert!((row.psnr.unwrap() - want).abs() < 1e-9);
        assert_eq!(row.frames, 4);
        // Of 1/8, 2/8 and 3/8; the first frame has no pairs.
        assert_eq!(row.contour_pairs, Some(0.25));
    }
}
