//! Fragments of views in memory, and the error of whatever composites them.

use super::Score;
use crate::{
    EvalError,
    compare::{EXACT, is_too_large},
    contours::Pairs,
    front::EXACT_MSE,
    geometric_mean,
    metrics::error_image,
};
use peelnet_core::{absorbance::DepthWarp, fragment::Fragment, methods::over};
use peelnet_gpu::Gpu;
use peelnet_peel::{Peel, harvest::Harvester, rows::RawTile};
use peelnet_render::{
    Image, MethodOptions, MethodSpec, PixelSample, RenderError, Renderer, methods::Pixel,
};
use peelnet_scene::{Camera, Scene};
use rayon::prelude::*;
use std::{
    collections::BTreeMap,
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
};

/// A pixel with transparent fragments.
#[derive(Clone, Debug)]
struct Stack {
    /// Its place in the frame, row by row.
    place: usize,
    /// Its fragments, nearest first.
    fragments: Range<usize>,
    /// Their exact composite over black.
    exact: [f64; 3],
}

/// The exact image of a view, and its pairs of pixels.
#[derive(Clone, Debug)]
struct Shown {
    image: Image,
    pairs: Pairs,
}

/// All transparent fragments of a view.
#[derive(Clone, Debug)]
pub struct View {
    scene: String,
    /// The warp of the view's depths.
    pub warp: DepthWarp,
    /// Pixels of the frame.
    frame: usize,
    stacks: Vec<Stack>,
    fragments: Vec<Fragment>,
    /// None where the surfaces need more memory than there is.
    shown: Option<Shown>,
}

/// The error of a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Mean squared error of the whole frame, linear light.
    pub mse_linear: f64,
    /// Share of contour pairs; `None` of a view without pairs.
    pub contour_pairs: Option<f64>,
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
            fragments: Vec::new(),
            shown: None,
        };
        for (place, list) in lists {
            view.push(place, list);
        }
        view
    }

    fn push(&mut self, place: usize, list: impl IntoIterator<Item = Fragment>) {
        let first = self.fragments.len();
        self.fragments.extend(list);
        let fragments = first..self.fragments.len();
        if !fragments.is_empty() {
            let exact = over::composite_f64(&self.fragments[fragments.clone()], [0.0; 3]);
            self.stacks.push(Stack {
                place,
                fragments,
                exact,
            });
        }
    }

    /// Number of fragments.
    pub const fn fragments(&self) -> usize {
        self.fragments.len()
    }

    /// The error of what gives a pixel's colour over black from its fragments, nearest first. Components that are not finite count as
    /// black.
    ///
    /// The background is none of a method's error: its share of a pixel is the same for all.
    pub fn measure(&self, composite: impl Fn(&[Fragment]) -> [f32; 3] + Sync) -> Measured {
        let colors: Vec<[f64; 3]> = self
            .stacks
            .par_iter()
            .map(|stack| {
                let color = composite(&self.fragments[stack.fragments.clone()]);
                color.map(|c| if c.is_finite() { f64::from(c) } else { 0.0 })
            })
            .collect();
        let pixels = || self.stacks.iter().zip(&colors);
        let squares = pixels().map(|(stack, color)| {
            let channels = stack.exact.iter().zip(color);
            channels.map(|(e, c)| (c - e).powi(2)).sum::<f64>()
        });
        let mse_linear = squares.sum::<f64>() / (3 * self.frame).max(1) as f64;
        let contour_pairs = self.shown.as_ref().and_then(|shown| {
            let mut image = shown.image.pixels.clone();
            for (stack, color) in pixels() {
                for (k, shown) in image[stack.place][..3].iter_mut().enumerate() {
                    *shown += (color[k] - stack.exact[k]) as f32;
                }
            }
            let errors = error_image(&shown.image.pixels, &image).ok()?;
            shown.pairs.share(&errors).ok()?
        });
        Measured {
            mse_linear,
            contour_pairs,
        }
    }

    /// The error of a method's CPU twin. What has none, or needs a network, leaves pixels black.
    pub fn measure_method(&self, method: &MethodSpec) -> Measured {
        self.measure(|fragments| {
            let pixel = Pixel {
                fragments,
                background: [0.0; 3],
                warp: self.warp,
                position: [0; 2],
                model: None,
            };
            method.twin(&pixel).unwrap_or_default()
        })
    }
}

/// Peels all views of the scenes, or the first of each, and draws their exact images.
///
/// All fragments are held in memory: about 40 bytes each.
///
/// # Errors
/// A view that cannot be drawn; [`EvalError::Interrupted`] once `stop` is set.
pub fn peel(
    gpu: &Gpu,
    scenes: &[Scene],
    size: [u32; 2],
    most: Option<usize>,
    stop: &AtomicBool,
) -> Result<Vec<View>, EvalError> {
    crate::bench::check_names(scenes)?;
    let mut views = Vec::new();
    for scene in scenes {
        let failed = |method| EvalError::render(&scene.name, method);
        let mut harvester = Harvester::new(gpu, scene, size, Peel::SBuffer, false, None)
            .map_err(EvalError::peel(&scene.name))?;
        let renderer = Renderer::new(gpu, scene).map_err(failed(EXACT))?;
        for camera in scene.views.iter().take(most.unwrap_or(usize::MAX)) {
            if stop.load(Ordering::Relaxed) {
                return Err(EvalError::Interrupted);
            }
            let frame = size[0] as usize * size[1] as usize;
            let mut view = View::new(&scene.name, harvester.depth_warp(camera), frame, []);
            let mut take = |tile: RawTile| {
                for (run, pixel) in tile.offsets.windows(2).zip(tile.first_pixel..) {
                    let run = run[0] as usize..run[1] as usize;
                    let fragments = tile.depths[run.clone()].iter().zip(&tile.colors[run]);
                    view.push(
                        pixel as usize,
                        fragments.map(|(&z, &[r, g, b, a])| Fragment::new(z, a, [r, g, b])),
                    );
                }
                Ok(())
            };
            harvester
                .harvest(camera, PixelSample::ALL, None, RawTile::default, &mut take)
                .map_err(EvalError::peel(&scene.name))?;
            view.shown = match shown(&renderer, size, camera) {
                Err(e) if is_too_large(&e) => None,
                shown => Some(shown.map_err(failed(EXACT))?),
            };
            views.push(view);
        }
    }
    Ok(views)
}

fn shown(renderer: &Renderer, size: [u32; 2], camera: &Camera) -> Result<Shown, RenderError> {
    let pairs = Pairs::drawn(renderer, size, 1, camera)?;
    let mut exact = renderer.method(&EXACT.parse()?, MethodOptions::sized(size))?;
    let image = renderer.image(&mut exact, camera)?.image;
    Ok(Shown { image, pairs })
}

/// Errors on all views as ratios to those of `moments` and `kbuffer`. Views that `moments` draws exactly count as its least error.
pub fn score(
    views: &[View],
    own: &[Measured],
    moments: &[Measured],
    kbuffer: &[Measured],
) -> Score {
    let least = |m: &Measured| m.mse_linear.max(EXACT_MSE);
    let ratio = |base: &[Measured]| {
        let ratios = own.iter().zip(base).map(|(a, b)| least(a) / least(b));
        geometric_mean(ratios)
    };
    let mut scenes: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
    for (view, (own, moments)) in views.iter().zip(own.iter().zip(moments)) {
        let sums = scenes.entry(&view.scene).or_default();
        sums[0] += least(own);
        sums[1] += least(moments);
    }
    let worst = scenes.into_iter().map(|(scene, [a, b])| (scene, a / b));
    let worst = worst.max_by(|a, b| a.1.total_cmp(&b.1));
    let contours: Vec<f64> = own.iter().filter_map(|m| m.contour_pairs).collect();
    Score {
        to_moments: ratio(moments),
        to_kbuffer: ratio(kbuffer),
        worst_scene: worst.map(|(scene, _)| scene.to_owned()),
        worst: worst.map(|(_, ratio)| ratio),
        contour_pairs: (!contours.is_empty())
            .then(|| contours.iter().sum::<f64>() / contours.len() as f64),
    }
}
