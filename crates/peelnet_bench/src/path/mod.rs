//! Methods along a path: errors of every frame, how they change from frame to frame, and how visible that is in the video.
//!
//! A method with a small error may still pop (painters, where the order of objects changes) or swim (noise and stripes that stay on the
//! screen while surfaces move). The *change* of an error image is its mean absolute difference from that of the frame before. An error that
//! is glued to its surface changes as well, by as much as the surface moves: compare methods of like errors.

mod motion;
mod strip;
mod video;

pub use crate::records::{Along, FrameRow, PathRow};

use crate::{
    EvalError,
    bench::{Progress, check_names},
    compare::{EXACT, Plan, image_name},
    contours::Pairs,
    metrics::{differences, error_image, psnr},
    perceptual::Displayed,
    rows::mean,
    stage::{Ready, Stage, Watch, exact_method},
};
use colorvideovdp::{Cvvdp, Image as VideoFrame};
use motion::{Moment, moment};
use peelnet_render::gpu::Gpu;
use peelnet_render::{Image, MethodSpec};
use peelnet_scene::Scene;
use std::sync::atomic::AtomicBool;
use strip::Strip;
use video::{DISPLAY_ABOUT, FPS};

const MAX_PATH_BYTES: u64 = 1 << 31;

/// Bytes of a pixel of a frame that are kept: the exact image in linear light (16), as it is shown (4) and as the metric sees it (12), a
/// method's frame as the metric sees it (12), and which of its neighbours show the same surfaces (1).
const BYTES_PER_PIXEL: u64 = 45;

fn mean_absolute(image: &[[f32; 3]]) -> f64 {
    let all = image.as_flattened();
    let sum: f64 = all.iter().map(|&x| f64::from(x.abs())).sum();
    sum / all.len().max(1) as f64
}

fn change_of(before: &[[f32; 3]], after: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let pixels = before.iter().zip(after);
    let changes = pixels.map(|(b, a)| std::array::from_fn(|k| a[k] - b[k]));
    changes.collect()
}

/// Means over the frames of a method; `mse_8bit` is that of all frames.
fn path_row(frames: &[FrameRow], mse_8bit: f64, jod: Option<f64>) -> PathRow {
    let values = |value: fn(&FrameRow) -> Option<f64>| frames.iter().filter_map(value);
    let all = |value| mean(values(value)).unwrap_or_default();
    PathRow {
        method: frames[0].method.clone(),
        scene: frames[0].scene.clone(),
        frames: frames.len() as u32,
        mse_linear: all(|r| Some(r.mse_linear)),
        psnr: psnr(mse_8bit),
        flip: all(|r| Some(r.flip)),
        error: all(|r| Some(r.error)),
        change: mean(values(|r| r.change)),
        change_max: values(|r| r.change).reduce(f64::max),
        contour_pairs: mean(values(|r| r.contour_pairs)),
        jod,
    }
}

#[derive(Default)]
struct Exact {
    frames: Vec<(Image, Displayed)>,
    pairs: Vec<Pairs>,
    video: Vec<VideoFrame>,
}

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
        ready.prepared.set_moving();
        for (k, moment) in self.moments.iter().enumerate() {
            self.watch.check()?;
            for (number, place) in moment.objects.iter().enumerate() {
                let moved = self.stage.renderer.set_transform(number, *place);
                moved.map_err(self.stage.failed(&ready.name))?;
            }
            take(k, self.stage.image(&mut ready, &moment.camera)?.image)?;
            self.watch.drawn(&self.stage.scene.name, &ready.name);
        }
        Ok(())
    }

    /// Draws all frames exactly, and finds which neighbours show the same surfaces.
    fn draw_exact(&mut self) -> Result<Exact, EvalError> {
        let mut exact = Exact::default();
        let surfaces = self.stage.surfaces(self.plan.size, self.plan.samples)?;
        self.draw(surfaces, &mut |_, image| {
            exact.pairs.push(Pairs::from_surfaces(&image));
            Ok(())
        })?;
        let mut strip = Strip::new(self.plan.size, self.moments.len());
        self.draw(self.ready(&exact_method())?, &mut |k, image| {
            let shown = Displayed::new(&image);
            strip.add_frame(k, &image);
            exact.video.extend(video::frame(&shown)?);
            exact.frames.push((image, shown));
            Ok(())
        })?;
        for (image, _) in &exact.frames {
            self.stage.check_exact(image)?;
        }
        self.save(&strip, EXACT)?;
        Ok(exact)
    }

    fn save(&self, strip: &Strip, method: &str) -> Result<(), EvalError> {
        let Some(folder) = self.plan.images else {
            return Ok(());
        };
        let path = folder.join(image_name(&self.stage.scene.name, method));
        let saved = strip.image().save(&path);
        saved.map_err(self.stage.failed(method))
    }

    fn measure(
        &mut self,
        method: &MethodSpec,
        exact: &Exact,
        metric: &Cvvdp,
    ) -> Result<(PathRow, Vec<FrameRow>), EvalError> {
        let (name, scene) = (method.to_string(), self.stage.scene.name.clone());
        let mut strip = Strip::new(self.plan.size, self.moments.len());
        let mut video = Vec::with_capacity(exact.video.len());
        let (mut rows, mut squares_8bit) = (Vec::new(), 0.0);
        let mut before: Option<Vec<[f32; 3]>> = None;
        self.draw(self.ready(method)?, &mut |k, image| {
            let (reference, reference_shown) = &exact.frames[k];
            let shown = Displayed::new(&image);
            let found = differences(&reference.pixels, &image.pixels);
            let errors = error_image(&reference.pixels, &image.pixels);
            let change = before.as_ref().map(|before| change_of(before, &errors));
            squares_8bit += found.mse_8bit;
            rows.push(FrameRow {
                method: name.clone(),
                scene: scene.clone(),
                frame: k as u32,
                mse_linear: found.mse_linear,
                psnr: found.psnr,
                flip: shown.flip(reference_shown),
                error: mean_absolute(&errors),
                change: change.as_deref().map(mean_absolute),
                contour_pairs: exact.pairs[k].share(&errors),
            });
            strip.add_errors(k, &errors, change.as_deref());
            before = Some(errors);
            video.extend(video::frame(&shown)?);
            Ok(())
        })?;
        self.save(&strip, &name)?;
        // Frames that are too small for the metric are no video.
        let jod = (!video.is_empty()).then(|| video::jod(metric, &video, &exact.video));
        let mse_8bit = squares_8bit / rows.len() as f64;
        Ok((path_row(&rows, mse_8bit, jod.transpose()?), rows))
    }
}

/// Measures all methods of a plan along the paths of all scenes, of so many frames as it has; strips of frames are saved as
/// `<scene>-<method>.png`. With [`Plan::lenient`], a method that has no passes is left out, too.
pub fn measure(
    gpu: &Gpu,
    scenes: &[Scene],
    plan: &Plan<'_>,
    stop: &AtomicBool,
    report: &mut dyn FnMut(Progress),
) -> Result<Along, EvalError> {
    check_names(scenes)?;
    let ([width, height], frames) = (plan.size, plan.frames.max(1));
    let factors = [width, height, frames].map(u64::from);
    let needed = (factors.into_iter()).fold(BYTES_PER_PIXEL, u64::saturating_mul);
    if needed > MAX_PATH_BYTES {
        return Err(EvalError::Unusable(format!(
            "a path of {frames} frames of {width}x{height} pixels keeps {needed} bytes, more than {MAX_PATH_BYTES}; make --size smaller or \
             --frames fewer"
        )));
    }
    if let Some(folder) = plan.images {
        std::fs::create_dir_all(folder).map_err(EvalError::io(folder, "create the folder"))?;
    }
    let methods = plan.methods.iter().filter(|m| **m != exact_method());
    let methods: Vec<&MethodSpec> = methods.collect();
    let metric = video::metric()?;
    let mut found = Along {
        size: plan.size,
        samples: plan.samples,
        frames,
        fps: FPS,
        display: DISPLAY_ABOUT.to_owned(),
        ..Along::default()
    };
    let total = (scenes.len() * (methods.len() + 2)) as u64 * u64::from(frames);
    let mut watch = Watch::new(total, stop, report);
    for scene in scenes {
        let moments = (0..frames).map(|k| moment(scene, k as f32 / frames as f32));
        let mut take = Take {
            stage: Stage::new(gpu, scene)?,
            plan,
            moments: moments.collect(),
            watch: &mut watch,
        };
        let exact = take.draw_exact()?;
        for method in &methods {
            let why = match method.method().cpu_only {
                Some(why) if plan.lenient => why.to_owned(),
                _ => match take.measure(method, &exact, &metric) {
                    Err(e) if plan.lenient && e.is_of_method() => e.reason(),
                    measured => {
                        let (row, by_frame) = measured?;
                        found.rows.push(row);
                        found.by_frame.extend(by_frame);
                        continue;
                    }
                },
            };
            let name = method.to_string();
            take.watch.left_out(&scene.name, &name, &why);
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of 10, −10, 10 and 4 levels: the mean error is 8.5, the changes are 20, 20 and 6, and PSNR is of the mean of their squares, 79.
    #[test]
    fn changes_of_a_known_sequence() {
        let images = [10.0, -10.0, 10.0, 4.0].map(|level: f32| vec![[level; 3]; 6]);
        let frame = |k: usize| FrameRow {
            error: mean_absolute(&images[k]),
            change: (k > 0).then(|| mean_absolute(&change_of(&images[k - 1], &images[k]))),
            contour_pairs: (k > 0).then_some(k as f64 / 8.0),
            ..FrameRow::default()
        };
        let frames = [0, 1, 2, 3].map(frame);
        let row = path_row(&frames, 79.0, None);
        assert_eq!((row.frames, row.error), (4, 8.5));
        assert_eq!((row.change, row.change_max), (Some(46.0 / 3.0), Some(20.0)));
        assert_eq!(row.psnr, psnr(79.0));
        // Of 1/8, 2/8 and 3/8; the first frame has no pairs.
        assert_eq!(row.contour_pairs, Some(0.25));
    }
}
