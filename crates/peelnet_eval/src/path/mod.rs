//! Methods along a path: errors of every frame, how they change from frame to frame, and how visible that is in the video.
//!
//! A method with a small error may still pop (painters, where the order of objects changes) or swim (noise and stripes that stay on the
//! screen while surfaces move). The *error image* of a frame is the difference of its sRGB-encoded values, on the 0–255 scale and not
//! rounded, from those of the exact image; its *change* is the mean absolute difference from the frame before, over pixels and channels.
//! An error that is glued to its surface changes as well, by as much as the surface moves: compare methods of like errors. Borders that the
//! error image has inside surfaces are counted as [`contours`](crate::contours).
//!
//! The exact frames of a scene are kept, and the frames of one method at a time: see [`Settings::bytes`].

pub mod motion;
mod strip;
pub mod video;

use crate::{
    EvalError,
    bench::{Progress, check_names},
    check_stop,
    compare::{self, EXACT, SURFACES, image_name},
    contours::Pairs,
    metrics::{Differences, differences, error_image, psnr},
    perceptual::Displayed,
};
use colorvideovdp::Image as VideoFrame;
use motion::{Moment, Motion};
use peelnet_gpu::Gpu;
use peelnet_render::{
    Image, LearnedWeight, MethodOptions, MethodSpec, Prepared, RenderError, Renderer,
};
use peelnet_scene::Scene;
use serde::{Deserialize, Serialize};
use std::path::Path as FilePath;
use std::sync::atomic::AtomicBool;
use strip::Strip;
use video::{FPS, Judge};

/// What is measured.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'a> {
    /// Width and height of every frame, pixels.
    pub size: [u32; 2],
    /// Samples a pixel, 1 or 4, of all methods and of the exact image.
    pub samples: u32,
    /// Frames of the path.
    pub frames: u32,
    /// The methods; the exact one needs no row.
    pub methods: &'a [MethodSpec],
    /// Weights for the learned methods among them, found by recipe.
    pub learned: &'a [LearnedWeight],
    /// Whether a method that needs more than this adapter allows, or has no passes, is left out and reported.
    pub lenient: bool,
    /// Where strips of frames are saved as `<scene>-<method>.png`.
    pub images: Option<&'a FilePath>,
}

/// Bytes that a path may keep.
const MAX_PATH_BYTES: u64 = 1 << 31;

/// Bytes of a pixel of a frame that are kept: the exact image in linear light (16), as it is shown (4) and as the metric sees it (12), a
/// method's frame as the metric sees it (12), and which of its neighbours show the same surfaces (1).
const BYTES_PER_PIXEL: u64 = 45;

impl Settings<'_> {
    /// Bytes that are kept: those of all frames of two videos.
    pub fn bytes(&self) -> u64 {
        let [width, height] = self.size.map(u64::from);
        let frames = u64::from(self.frames);
        width.saturating_mul(height).saturating_mul(frames) * BYTES_PER_PIXEL
    }

    fn check(&self) -> Result<(), EvalError> {
        let needed = self.bytes();
        if needed > MAX_PATH_BYTES {
            return Err(EvalError::LongPath {
                frames: self.frames,
                size: self.size,
                needed,
                most: MAX_PATH_BYTES,
            });
        }
        Ok(())
    }
}

/// A method along a scene's path.
#[allow(
    missing_docs,
    reason = "docs/results-files.md says what each field is, and its unit"
)]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PathRow {
    pub method: String,
    pub scene: String,
    pub frames: u32,
    pub mse_linear: f64,
    pub psnr: Option<f64>,
    pub flip: f64,
    pub error: f64,
    pub change: Option<f64>,
    pub change_max: Option<f64>,
    #[serde(default)]
    pub contour_pairs: Option<f64>,
    pub jod: Option<f64>,
}

/// A method in one frame of a scene's path.
#[allow(
    missing_docs,
    reason = "docs/results-files.md says what each field is, and its unit"
)]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameRow {
    pub method: String,
    pub scene: String,
    pub frame: u32,
    pub mse_linear: f64,
    pub psnr: Option<f64>,
    pub flip: f64,
    pub error: f64,
    pub change: Option<f64>,
    #[serde(default)]
    pub contour_pairs: Option<f64>,
}

/// A finished measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Along {
    /// Frame size in pixels.
    pub size: [u32; 2],
    /// Samples a pixel.
    pub samples: u32,
    /// Frames of the path.
    pub frames: u32,
    /// Frames a second that the video metric assumes.
    pub fps: f32,
    /// The display that it assumes.
    pub display: String,
    /// One row per method and scene.
    pub rows: Vec<PathRow>,
    /// One row per method, scene and frame.
    pub by_frame: Vec<FrameRow>,
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
        let n = self.rows.len().max(1) as f64;
        let mean = |value: fn(&FrameRow) -> f64| self.rows.iter().map(value).sum::<f64>() / n;
        let some = |value: fn(&FrameRow) -> Option<f64>| {
            let values: Vec<f64> = self.rows.iter().filter_map(value).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            (!values.is_empty()).then_some(mean)
        };
        let changes = self.rows.iter().filter_map(|r| r.change);
        PathRow {
            method: self.method.to_owned(),
            scene: self.scene.to_owned(),
            frames: self.rows.len() as u32,
            mse_linear: mean(|r| r.mse_linear),
            psnr: psnr(self.squares_8bit / n),
            flip: mean(|r| r.flip),
            error: mean(|r| r.error),
            change: some(|r| r.change),
            change_max: changes.reduce(f64::max),
            contour_pairs: some(|r| r.contour_pairs),
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
struct Stage<'a, 's> {
    scene: &'a Scene,
    settings: &'a Settings<'s>,
    renderer: Renderer,
    moments: Vec<Moment>,
    stop: &'a AtomicBool,
}

impl Stage<'_, '_> {
    fn failed(&self, method: &str) -> impl FnOnce(RenderError) -> EvalError + use<> {
        EvalError::render(&self.scene.name, method)
    }

    /// Draws all frames with a method, and hands each to `take`.
    fn draw(
        &mut self,
        method: &MethodSpec,
        take: &mut dyn FnMut(usize, Image) -> Result<(), EvalError>,
    ) -> Result<(), EvalError> {
        let Settings {
            size,
            samples,
            learned,
            ..
        } = *self.settings;
        let name = method.to_string();
        let weight = learned.iter().find(|l| l.recipe.method == method.name());
        let options = MethodOptions::sized(size).sampled(samples).with(weight);
        let prepared = self.renderer.method(method, options);
        let mut prepared = prepared.map_err(self.failed(&name))?;
        self.draw_prepared(&name, &mut prepared, take)
    }

    /// Draws all frames with what is ready under this name.
    fn draw_prepared(
        &mut self,
        name: &str,
        prepared: &mut Prepared,
        take: &mut dyn FnMut(usize, Image) -> Result<(), EvalError>,
    ) -> Result<(), EvalError> {
        for (k, moment) in self.moments.iter().enumerate() {
            check_stop(self.stop)?;
            for (number, place) in moment.objects.iter().enumerate() {
                let moved = self.renderer.set_transform(number, *place);
                moved.map_err(self.failed(name))?;
            }
            let frame = self.renderer.image(prepared, &moment.camera);
            take(k, frame.map_err(self.failed(name))?.image)?;
        }
        Ok(())
    }

    /// Draws all frames exactly, and finds which neighbours show the same surfaces. Returns them with the frames of the video.
    fn draw_exact(
        &mut self,
        method: &MethodSpec,
        tick: &mut dyn FnMut(),
    ) -> Result<(Vec<Exact>, Vec<VideoFrame>), EvalError> {
        let Settings { size, samples, .. } = *self.settings;
        let mut pairs = Vec::with_capacity(self.moments.len());
        let prepared = self.renderer.surfaces(size, samples);
        let mut prepared = prepared.map_err(self.failed(SURFACES))?;
        self.draw_prepared(SURFACES, &mut prepared, &mut |_, image| {
            pairs.push(Pairs::of(&image));
            Ok(())
        })?;
        drop(prepared);
        let (mut exact, mut reference) = (Vec::new(), Vec::new());
        let mut strip = Strip::new(size, pairs.len());
        let mut pairs = pairs.into_iter();
        self.draw(method, &mut |k, image| {
            let shown = Displayed::new(&image);
            strip.add_frame(k, &image);
            reference.extend(video::frame(&shown)?);
            exact.extend(pairs.next().map(|pairs| Exact {
                image,
                shown,
                pairs,
            }));
            tick();
            Ok(())
        })?;
        self.save(&strip, EXACT)?;
        Ok((exact, reference))
    }

    fn save(&self, strip: &Strip, method: &str) -> Result<(), EvalError> {
        let Some(folder) = self.settings.images else {
            return Ok(());
        };
        let path = folder.join(image_name(&self.scene.name, method));
        strip.image().save(&path).map_err(self.failed(method))
    }

    /// Measures one method against the exact frames.
    fn measure(
        &mut self,
        method: &MethodSpec,
        exact: &[Exact],
        reference: &[VideoFrame],
        judge: &Judge,
        tick: &mut dyn FnMut(),
    ) -> Result<(PathRow, Vec<FrameRow>), EvalError> {
        let name = method.to_string();
        let scene = self.scene;
        let mut all = Video {
            method: &name,
            scene: &scene.name,
            rows: Vec::new(),
            squares_8bit: 0.0,
            before: None,
        };
        let mut strip = Strip::new(self.settings.size, exact.len());
        let mut video = Vec::with_capacity(reference.len());
        self.draw(method, &mut |k, image| {
            let Exact {
                image: against,
                shown: displayed,
                pairs,
            } = &exact[k];
            let shown = Displayed::new(&image);
            let found = differences(&against.pixels, &image.pixels)?;
            let errors = error_image(&against.pixels, &image.pixels)?;
            let contours = pairs.share(&errors)?;
            let (errors, change) = all.add(errors, &found, shown.flip(displayed), contours);
            strip.add_errors(k, errors, change.as_deref());
            if !reference.is_empty() {
                video.extend(video::frame(&shown)?);
            }
            tick();
            Ok(())
        })?;
        self.save(&strip, &name)?;
        let jod = if reference.is_empty() {
            None
        } else {
            Some(judge.jod(&video, reference)?)
        };
        Ok((all.row(jod), all.rows))
    }
}

/// Measures all methods along the paths of all scenes.
///
/// # Errors
/// If a method cannot draw, a path is too long to be kept, or a picture cannot be written; [`EvalError::Interrupted`] once `stop` is set.
pub fn measure(
    gpu: &Gpu,
    scenes: &[Scene],
    settings: &Settings<'_>,
    stop: &AtomicBool,
    report: &mut dyn FnMut(Progress<'_>),
) -> Result<Along, EvalError> {
    check_names(scenes)?;
    settings.check()?;
    if let Some(folder) = settings.images {
        std::fs::create_dir_all(folder).map_err(EvalError::io(folder, "create the folder"))?;
    }
    let exact_method: MethodSpec = EXACT.parse().map_err(EvalError::render("all", EXACT))?;
    let methods = settings.methods.iter().filter(|m| **m != exact_method);
    let methods: Vec<&MethodSpec> = methods.collect();
    let total = (scenes.len() * (methods.len() + 1)) as u64 * u64::from(settings.frames);
    let judge = Judge::new()?;
    let mut found = Along {
        size: settings.size,
        samples: settings.samples,
        frames: settings.frames,
        fps: FPS,
        display: Judge::display(),
        rows: Vec::new(),
        by_frame: Vec::new(),
    };
    let mut done = 0;
    for scene in scenes {
        let motion = Motion::of(scene);
        let frames = settings.frames;
        let moments = (0..frames).map(|k| motion.at(k as f32 / frames as f32));
        let mut stage = Stage {
            scene,
            settings,
            renderer: Renderer::new(gpu, scene)
                .map_err(EvalError::render(&scene.name, "upload"))?,
            moments: moments.collect(),
            stop,
        };
        let mut tick = |method: &str, report: &mut dyn FnMut(Progress<'_>)| {
            done += 1;
            report(Progress::Drawn {
                done,
                total,
                scene: &scene.name,
                method,
            });
        };
        let mut one = || tick(EXACT, report);
        let (exact, reference) = stage.draw_exact(&exact_method, &mut one)?;
        for method in &methods {
            let name = method.to_string();
            if let (true, Some(why)) = (settings.lenient, method.method().cpu_only) {
                let why = why.to_owned();
                report(Progress::LeftOut {
                    scene: &scene.name,
                    method: &name,
                    why,
                });
                continue;
            }
            let mut one = || tick(&name, report);
            match stage.measure(method, &exact, &reference, &judge, &mut one) {
                Err(EvalError::Render { source, .. })
                    if settings.lenient && compare::is_too_large(&source) =>
                {
                    report(Progress::LeftOut {
                        scene: &scene.name,
                        method: &name,
                        why: source.to_string(),
                    });
                }
                measured => {
                    let (row, by_frame) = measured?;
                    found.rows.push(row);
                    found.by_frame.extend(by_frame);
                }
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
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

    /// A path that would not fit is refused before anything is drawn.
    #[test]
    fn a_path_is_bounded() {
        let settings = |frames| Settings {
            size: [1024, 768],
            samples: 1,
            frames,
            methods: &[],
            learned: &[],
            lenient: false,
            images: None,
        };
        settings(60).check().unwrap();
        let text = settings(63).check().unwrap_err().to_string();
        assert!(text.contains("63 frames of 1024x768"), "{text}");
    }
}
