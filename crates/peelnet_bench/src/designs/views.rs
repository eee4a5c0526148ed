//! Fragments of views in memory, and the error of whatever composites them.

use super::{
    MOTIONS, Score,
    ranges::{Source, moved, of_boxes, of_tiles},
};
use crate::{
    EvalError,
    bench::check_names,
    contours::{LIMIT, Pairs},
    front::EXACT_MSE,
    metrics::error_image,
    rows::{geometric_mean, mean},
    stage::{Stage, check_stop, exact_method},
    transmittance::Peeled,
};
use peelnet_core::{
    absorbance::DepthWarp,
    fragment::Fragment,
    methods::{over, slabs::Extent},
};
use peelnet_model::Model;
use peelnet_render::gpu::Gpu;
use peelnet_render::{Image, MethodOptions, MethodSpec, PixelSample, methods::Pixel};
use peelnet_scene::{Camera, Scene};
use rayon::prelude::*;
use std::{collections::BTreeMap, sync::atomic::AtomicBool};

/// A pixel with transparent fragments.
pub(super) struct Stack {
    /// Its place in the frame, row by row.
    pub place: usize,
    /// Nearest first.
    pub fragments: Vec<Fragment>,
    /// Their exact composite over black.
    exact: [f64; 3],
}

struct Shown {
    image: Image,
    pairs: Pairs,
}

pub struct View {
    scene: String,
    pub warp: DepthWarp,
    /// Pixels of the frame.
    frame: usize,
    pub(super) stacks: Vec<Stack>,
    /// None where the surfaces need more memory than there is.
    shown: Option<Shown>,
    /// Of each pixel with fragments, the scales of depth that boxes and what is seen around it give it. Empty of a view of lists.
    boxes: Vec<Extent>,
    tiles: Vec<Extent>,
    /// The same view after each of [`MOTIONS`]; empty of a view of lists.
    after: Vec<View>,
}

pub struct Stacked<'a> {
    view: &'a View,
    number: usize,
}

impl Stacked<'_> {
    /// Nearest first.
    pub fn fragments(&self) -> &[Fragment] {
        &self.view.stacks[self.number].fragments
    }

    /// What a design's slabs are cut by here.
    pub(super) fn extent(&self, source: Source, of_design: Extent) -> Extent {
        let found: &[Extent] = match source {
            Source::Tiles => &self.view.tiles,
            Source::Boxes => &self.view.boxes,
            Source::Pixel | Source::Ends | Source::Frame => &[],
        };
        found.get(self.number).copied().unwrap_or(of_design)
    }

    /// A depth on the scale that is cut.
    pub(super) fn zeta(&self, depth: f32) -> f64 {
        self.view.warp.cut(depth.into())
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Mean squared error of the whole frame, linear light.
    pub mse_linear: f64,
    /// Share of contour pairs; `None` of a view without pairs.
    pub contour_pairs: Option<f64>,
    /// Share of the frame's pixels whose error changes by more than [`crate::contours::THRESHOLD`] with each of [`MOTIONS`]; `None` where that was not asked.
    pub flicker: [Option<f64>; MOTIONS.len()],
}

impl View {
    /// A view of `frame` pixels with these lists of fragments, each with its place in the frame, and without an image.
    pub fn new(
        scene: &str,
        warp: DepthWarp,
        frame: usize,
        lists: impl IntoIterator<Item = (usize, Vec<Fragment>)>,
    ) -> Self {
        let mut view = Self {
            scene: scene.to_owned(),
            warp,
            frame,
            stacks: Vec::new(),
            shown: None,
            boxes: Vec::new(),
            tiles: Vec::new(),
            after: Vec::new(),
        };
        for (place, list) in lists {
            view.push(place, list);
        }
        view
    }

    fn push(&mut self, place: usize, fragments: Vec<Fragment>) {
        if !fragments.is_empty() {
            self.stacks.push(Stack {
                place,
                exact: over::composite_f64(&fragments, [0.0; 3]),
                fragments,
            });
        }
    }

    /// The error of what gives a pixel's colour over black. Components that are not finite count as black.
    ///
    /// The background is none of a method's error: its share of a pixel is the same for all.
    pub fn measure(&self, composite: impl Fn(&Stacked<'_>) -> [f32; 3] + Sync) -> Measured {
        self.measured(&self.colors(&composite)).0
    }

    /// The same, with the change of the error by each of [`MOTIONS`].
    pub fn measure_moving(&self, composite: impl Fn(&Stacked<'_>) -> [f32; 3] + Sync) -> Measured {
        let (mut measured, still) = self.measured(&self.colors(&composite));
        for (view, flicker) in self.after.iter().zip(&mut measured.flicker) {
            let (Some(still), Some(after)) = (&still, view.errors(&view.colors(&composite))) else {
                continue;
            };
            let changes = still.iter().zip(&after);
            let changes =
                changes.filter(|(a, b)| (0..3).any(|k| f64::from((a[k] - b[k]).abs()) > LIMIT));
            *flicker = Some(changes.count() as f64 / self.frame.max(1) as f64);
        }
        measured
    }

    fn measured(&self, colors: &[[f64; 3]]) -> (Measured, Option<Vec<[f32; 3]>>) {
        let pixels = self.stacks.iter().zip(colors);
        let squares = pixels.map(|(stack, color)| {
            let channels = stack.exact.iter().zip(color);
            channels.map(|(e, c)| (c - e).powi(2)).sum::<f64>()
        });
        let mse_linear = squares.sum::<f64>() / (3 * self.frame).max(1) as f64;
        let errors = self.errors(colors);
        let contour_pairs = match (&self.shown, &errors) {
            (Some(shown), Some(errors)) => shown.pairs.share(errors),
            _ => None,
        };
        let measured = Measured {
            mse_linear,
            contour_pairs,
            flicker: [None; MOTIONS.len()],
        };
        (measured, errors)
    }

    fn colors(&self, composite: &(impl Fn(&Stacked<'_>) -> [f32; 3] + Sync)) -> Vec<[f64; 3]> {
        let of = |number| {
            let color = composite(&Stacked { view: self, number });
            color.map(|c| if c.is_finite() { f64::from(c) } else { 0.0 })
        };
        (0..self.stacks.len()).into_par_iter().map(of).collect()
    }

    /// The error image of the frame; `None` of a view without an image.
    fn errors(&self, colors: &[[f64; 3]]) -> Option<Vec<[f32; 3]>> {
        let shown = self.shown.as_ref()?;
        let mut image = shown.image.pixels.clone();
        for (stack, color) in self.stacks.iter().zip(colors) {
            for (k, shown) in image[stack.place][..3].iter_mut().enumerate() {
                *shown += (color[k] - stack.exact[k]) as f32;
            }
        }
        Some(error_image(&shown.image.pixels, &image))
    }

    /// The error of a method's CPU reference. What has none, or lacks its network, leaves pixels black.
    pub fn measure_method(&self, method: &MethodSpec, model: Option<&Model>) -> Measured {
        self.measure_moving(|stack| {
            let pixel = Pixel {
                fragments: stack.fragments(),
                background: [0.0; 3],
                warp: stack.view.warp,
                position: [0; 2],
                model,
            };
            method.reference(&pixel).unwrap_or_default()
        })
    }
}

/// Peels all views of the scenes, or the first of each, and draws their exact images; and once more after each of [`MOTIONS`].
///
/// All fragments are held in memory: about 120 bytes each.
pub fn peel(
    gpu: &Gpu,
    scenes: &[Scene],
    size: [u32; 2],
    most: Option<usize>,
    stop: &AtomicBool,
) -> Result<Vec<View>, EvalError> {
    check_names(scenes)?;
    let mut views = Vec::new();
    for scene in scenes {
        let mut peeled = Peeled::new(gpu, scene, size, false)?;
        let stage = Stage::new(gpu, scene)?;
        let mut of_camera = |camera: &Camera| -> Result<View, EvalError> {
            check_stop(stop)?;
            let mut view = peel_one(&mut peeled, &stage, size, camera)?;
            view.boxes = of_boxes(&view, scene, camera, size);
            view.tiles = of_tiles(&view, size);
            Ok(view)
        };
        for camera in scene.views.iter().take(most.unwrap_or(usize::MAX)) {
            let mut view = of_camera(camera)?;
            for pixels in MOTIONS {
                view.after.push(of_camera(&moved(camera, size, pixels))?);
            }
            views.push(view);
        }
    }
    Ok(views)
}

fn peel_one(
    peeled: &mut Peeled<'_>,
    stage: &Stage<'_>,
    size: [u32; 2],
    camera: &Camera,
) -> Result<View, EvalError> {
    let frame = size[0] as usize * size[1] as usize;
    let mut view = View::new(&stage.scene.name, peeled.depth_warp(camera), frame, []);
    peeled.each_pixel(camera, PixelSample::ALL, |pixel, mut fragments| {
        // They are in order already: no method asks for the triangle.
        fragments.iter_mut().for_each(|f| f.triangle = 0);
        view.push(pixel, fragments);
    })?;
    if let Some(pairs) = Pairs::where_they_fit(stage, size, 1, camera)? {
        match stage.draw(&exact_method(), MethodOptions::sized(size), camera) {
            Err(e) if e.is_of_method() => {}
            image => {
                let image = image?;
                view.shown = Some(Shown { image, pairs });
            }
        }
    }
    Ok(view)
}

/// Errors on all views as ratios to those of `moments` and `kbuffer`, but for views that the design and the other method draw exactly. Views that
/// `moments` alone draws exactly count as its least error.
pub fn score(
    views: &[View],
    own: &[Measured],
    moments: &[Measured],
    kbuffer: &[Measured],
) -> Score {
    let least = |m: &Measured| m.mse_linear.max(EXACT_MSE);
    let ratio = |base: &[Measured]| {
        let ratios = own.iter().zip(base).map(|(a, b)| [a, b].map(least));
        let ratios = ratios.filter(|both| both.iter().any(|e| *e > EXACT_MSE));
        geometric_mean(ratios.map(|[a, b]| a / b))
    };
    let mut scenes: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
    for (view, (own, moments)) in views.iter().zip(own.iter().zip(moments)) {
        let sums = scenes.entry(&view.scene).or_default();
        sums[0] += least(own);
        sums[1] += least(moments);
    }
    let worst = scenes.into_iter().map(|(scene, [a, b])| (scene, a / b));
    let worst = worst.max_by(|a, b| a.1.total_cmp(&b.1));
    let mean = |of: &dyn Fn(&Measured) -> Option<f64>| mean(own.iter().filter_map(of));
    Score {
        to_moments: ratio(moments),
        to_kbuffer: ratio(kbuffer),
        worst_scene: worst.map(|(scene, _)| scene.to_owned()),
        worst: worst.map(|(_, ratio)| ratio),
        contour_pairs: mean(&|m| m.contour_pairs),
        flicker: std::array::from_fn(|k| mean(&|m| m.flicker[k])),
    }
}
