//! From whole pixels of a dataset to the examples of the recipes that learn from pixels.

use std::collections::BTreeSet;
use std::ops::Range;

use peelnet_core::absorbance::{DepthWarp, absorbance};
use peelnet_core::features::{Feature, Rest};
use peelnet_core::fragment::Fragment;
use peelnet_core::methods::anchored::{self, Place};
use peelnet_core::methods::dfaoit::{FRONT, Layers};
use peelnet_core::methods::moments::{MomentSums, Settings};
use peelnet_core::methods::slabs::{self, Between};
use peelnet_core::methods::{mboit4, nmt};
use peelnet_dataset::{Column, Dataset, FragmentBatch, Part, Subset};
use peelnet_model::{Inputs, Output, Recipe};

use crate::error::TrainError;
use crate::training_data::{PixelFixed, TrainingData};

/// Rows that are read at once.
const ROWS_AT_A_TIME: usize = 1 << 16;

/// A pixel, nearest fragment first.
pub(crate) struct Pixel<'a> {
    /// Linear depth and opacity.
    pub(crate) points: &'a [(f32, f32)],
    /// `T_i`.
    pub(crate) transmittance: &'a [f32],
    /// Un-premultiplied radiance.
    pub(crate) colors: &'a [[f32; 3]],
}

impl Pixel<'_> {
    /// `T_∞`.
    fn behind(&self) -> f64 {
        self.points
            .last()
            .zip(self.transmittance.last())
            .map_or(1.0, |((_, alpha), t)| {
                f64::from(*t) * f64::from(1.0 - alpha)
            })
    }

    /// `α_i T_i`: how much of each fragment is seen.
    fn contributions(&self) -> impl Iterator<Item = f64> + '_ {
        self.points
            .iter()
            .zip(self.transmittance)
            .map(|((_, alpha), t)| f64::from(*alpha) * f64::from(*t))
    }
}

/// The rows of one view of a scene.
#[derive(Clone, Copy)]
pub(crate) enum View<'a> {
    /// A part of a dataset.
    Stored(&'a Dataset, &'a Part),
    /// Batches of whole pixels in memory.
    Held(&'a [FragmentBatch]),
}

impl View<'_> {
    /// The depth warp over the range of the view's fragments. The features do not depend on the warp's range; where it
    /// matters (`nmt`), this is the range that tight bounding boxes would give.
    pub(crate) fn warp(self) -> Result<DepthWarp, TrainError> {
        let range = |[near, far]: [f32; 2], depths: &[f32]| {
            depths
                .iter()
                .fold([near, far], |[a, b], &z| [a.min(z), b.max(z)])
        };
        let none = [f32::MAX, f32::MIN_POSITIVE];
        let [near, far] = match self {
            Self::Stored(dataset, part) => {
                let mut known = none;
                dataset.read_pieces(
                    &[Column::LinearDepth],
                    |p| p.index == part.index,
                    |piece| known = range(known, &piece.linear_depth),
                )?;
                known
            }
            Self::Held(batches) => batches
                .iter()
                .fold(none, |known, batch| range(known, &batch.linear_depth)),
        };
        Ok(DepthWarp::new(near.min(far).into(), far.into()))
    }

    /// Calls `each` with every pixel of the view, and its place (view, x, y).
    pub(crate) fn for_each_pixel(
        self,
        mut each: impl FnMut([u32; 3], &Pixel<'_>),
    ) -> Result<(), TrainError> {
        self.for_each_batch(|batch| {
            pixels_of(batch, &mut each);
            Ok(())
        })
    }

    /// Calls `each` with batches of whole pixels, until it fails.
    pub(crate) fn for_each_batch(
        self,
        mut each: impl FnMut(&FragmentBatch) -> Result<(), TrainError>,
    ) -> Result<(), TrainError> {
        match self {
            Self::Stored(dataset, part) => dataset
                .batches_where(ROWS_AT_A_TIME, |p| p.index == part.index)
                .try_for_each(|batch| each(&batch?)),
            Self::Held(batches) => batches.iter().try_for_each(each),
        }
    }

    /// Number of rows.
    pub(crate) fn rows(self) -> u64 {
        match self {
            Self::Stored(_, part) => part.rows,
            Self::Held(batches) => batches.iter().map(|b| b.len() as u64).sum(),
        }
    }
}

pub(crate) fn pixels_of(batch: &FragmentBatch, mut each: impl FnMut([u32; 3], &Pixel<'_>)) {
    let points: Vec<(f32, f32)> = batch
        .linear_depth
        .iter()
        .zip(&batch.one_minus_alpha)
        .map(|(&z, &through)| (z, 1.0 - through))
        .collect();
    let colors: Vec<[f32; 3]> = (0..batch.len())
        .map(|i| [batch.r[i], batch.g[i], batch.b[i]])
        .collect();
    for Range { start, end } in batch.pixels() {
        each(
            [batch.view[start], batch.x[start], batch.y[start]],
            &Pixel {
                points: &points[start..end],
                transmittance: &batch.transmittance[start..end],
                colors: &colors[start..end],
            },
        );
    }
}

/// Squared error of a pixel without the network, mean over the channels: how hard the pixel is. Drawn by the same slabs with the middle of
/// the bounds, or by MBOIT-4.
///
/// The figure that a user looks at is a method's error over that of another on the same image. Weighing each view by the
/// inverse of its mean hardness trains for that figure: faint scenes count as much as glaring ones.
pub(crate) fn hardness(recipe: Recipe, pixel: &Pixel<'_>, warp: &DepthWarp) -> f64 {
    let found: [f64; 3] = if let Inputs::Slabs(design, _) = recipe.inputs {
        let points = pixel.points.iter().zip(pixel.colors);
        let fragments: Vec<_> = points
            .map(|(&(depth, alpha), &color)| Fragment::new(depth, alpha, color))
            .collect();
        slabs::composite(&fragments, [0.0; 3], warp, design, slabs::middle).map(f64::from)
    } else {
        by_moments(pixel, warp)
    };
    let mut error = found;
    for (exact, color) in pixel.contributions().zip(pixel.colors) {
        for (e, &c) in error.iter_mut().zip(color) {
            *e -= exact * f64::from(c);
        }
    }
    error.iter().map(|e| e * e / 3.0).sum()
}

/// The colour of a pixel over black that MBOIT-4 draws.
fn by_moments(pixel: &Pixel<'_>, warp: &DepthWarp) -> [f64; 3] {
    let mut moments = mboit4::Moments::default();
    let zetas: Vec<f64> = pixel
        .points
        .iter()
        .map(|&(depth, alpha)| {
            let zeta = warp.apply(depth.into());
            moments.add(absorbance(alpha), zeta);
            zeta
        })
        .collect();
    let shares: Vec<f64> = pixel
        .points
        .iter()
        .zip(&zetas)
        .map(|((_, alpha), &zeta)| {
            f64::from(*alpha) * moments.transmittance(zeta, &Settings::PAPER)
        })
        .collect();
    let scale = (1.0 - pixel.behind()) / shares.iter().sum::<f64>().max(1e-12);
    let mut sum = [0.0; 3];
    for (share, color) in shares.iter().zip(pixel.colors) {
        for (sum, &c) in sum.iter_mut().zip(color) {
            *sum += share * scale * f64::from(c);
        }
    }
    sum
}

/// Appends what the recipe learns from a pixel.
pub(crate) fn add(
    recipe: Recipe,
    data: &mut TrainingData,
    pixel: &Pixel<'_>,
    warp: &DepthWarp,
    subset: Subset,
) {
    match recipe.inputs {
        Inputs::Moments(features) => transmittance_rows(features, data, pixel, warp, subset),
        Inputs::Layers(features) => color_row(features, data, pixel, subset),
        Inputs::Rest(features) => {
            let apart = recipe.output == Output::AnchoredShareSeparateEnds;
            let all = anchored::seen(pixel.points, warp, recipe.sums);
            let all = all.iter().map(of_anchored);
            share_pixel(features, data, pixel, subset, apart, all);
        }
        Inputs::Slabs(design, features) => {
            let all = slabs::seen(pixel.points, warp, design, recipe.sums);
            let all = all.iter().map(of_slabs);
            share_pixel(features, data, pixel, subset, design.apart, all);
        }
        // Columns of the dataset, read without whole pixels.
        Inputs::Row(_) => {}
    }
}

/// Appends the inputs of an example.
fn push_inputs<C>(data: &mut TrainingData, features: &[&Feature<C>], known: &C) {
    push(&mut data.inputs, features.iter().map(|f| (f.value)(known)));
}

fn push(columns: &mut [Vec<f32>], values: impl IntoIterator<Item = f64>) {
    for (column, value) in columns.iter_mut().zip(values) {
        column.push(value as f32);
    }
}

/// What is known of a fragment's weight without the network.
struct Known {
    weight: f64,
    /// The absorbance that the network says a share of, which takes from that weight; none where the weight is known.
    guessed: Option<f64>,
}

/// The fragments of a pixel whose share the network is asked for, with the inputs of each, and what the others contribute: those are `apart`
/// where they are not normalised with the rest.
fn share_pixel<'s, C: 's>(
    features: &[&Feature<C>],
    data: &mut TrainingData,
    pixel: &Pixel<'_>,
    subset: Subset,
    apart: bool,
    all: impl Iterator<Item = (Known, Option<&'s C>)>,
) {
    let all: Vec<_> = all.collect();
    let Some(columns) = &mut data.pixels else {
        return;
    };
    let asked = all.iter().filter(|(k, _)| k.guessed.is_some()).count();
    // Exact whatever the network says: nothing to learn.
    if asked == 0 || (apart && asked == 1) {
        return;
    }
    let first = data.targets[0].len();
    let mut left = 1.0 - pixel.behind();
    let mut fixed = PixelFixed::default();
    for (i, exact) in pixel.contributions().enumerate() {
        let ((known, inputs), color) = (&all[i], pixel.colors[i]);
        // What is known of its weight goes with its opacity.
        let a = f64::from(pixel.points[i].1) * known.weight;
        if let (Some(guessed), Some(inputs)) = (known.guessed, inputs) {
            push(&mut data.inputs, features.iter().map(|f| (f.value)(inputs)));
            push(&mut data.targets, [exact]);
            columns.rest.push(guessed as f32);
            columns.alpha.push(a as f32);
            for (column, c) in columns.color.iter_mut().zip(color) {
                column.push(c);
            }
        } else if apart {
            left -= a;
        } else {
            fixed.sum += a as f32;
            for (k, c) in color.into_iter().enumerate() {
                fixed.color[k] += a as f32 * c;
                fixed.exact[k] += exact as f32 * c;
            }
        }
    }
    fixed.left = left.max(0.0) as f32;
    columns.first.push(first as u32);
    columns.fixed.push(fixed);
    if let (Some(weights), Some(subsets)) = (&mut data.weights, &mut data.subsets) {
        weights.push(1.0);
        subsets.push(subset);
    }
}

fn of_anchored(seen: &anchored::Seen) -> (Known, Option<&Rest<f64>>) {
    let between = seen.place == Place::Between;
    let known = Known {
        weight: seen.weight(|_| 0.0),
        guessed: between.then_some(seen.rest.absorbance),
    };
    (known, between.then_some(&seen.rest))
}

fn of_slabs(seen: &slabs::Seen) -> (Known, Option<&Between>) {
    let between = seen.between.as_ref();
    let known = Known {
        weight: seen.weight(|_| 0.0),
        guessed: between.map(|b| b.absorbance * (b.bounds[1] - b.bounds[0])),
    };
    (known, between)
}

fn transmittance_rows(
    features: &[&Feature<nmt::Seen>],
    data: &mut TrainingData,
    pixel: &Pixel<'_>,
    warp: &DepthWarp,
    subset: Subset,
) {
    let all = nmt::Seen::all(pixel.points, warp);
    for ((seen, &(_, alpha)), &t) in all.iter().zip(pixel.points).zip(pixel.transmittance) {
        push_inputs(data, features, seen);
        data.targets[0].push(t);
        if let (Some(weights), Some(subsets)) = (&mut data.weights, &mut data.subsets) {
            // An error of T is seen as much as the fragment is opaque.
            weights.push(alpha * alpha);
            subsets.push(subset);
        }
    }
}

/// One row for a pixel that shows more fragments than are composited exactly.
fn color_row(
    features: &[&Feature<Layers>],
    data: &mut TrainingData,
    pixel: &Pixel<'_>,
    subset: Subset,
) {
    if pixel.points.len() <= FRONT || pixel.behind() >= 1.0 {
        return;
    }
    let mut exact = [0.0f64; 3];
    for (seen, color) in pixel.contributions().zip(pixel.colors) {
        for (sum, &c) in exact.iter_mut().zip(color) {
            *sum += seen * f64::from(c);
        }
    }
    let alphas = pixel.points.iter().map(|&(_, alpha)| alpha);
    let layers = Layers::of(alphas.zip(pixel.colors.iter().copied()));
    push_inputs(data, features, &layers);
    push(&mut data.targets, exact.map(|c| c.min(1.0)));
    if let (Some(weights), Some(subsets)) = (&mut data.weights, &mut data.subsets) {
        weights.push(1.0);
        subsets.push(subset);
    }
}

/// Names of the scenes that are trained on.
pub(crate) fn training_scenes<'a>(datasets: impl Iterator<Item = &'a Dataset>) -> BTreeSet<String> {
    datasets
        .flat_map(|dataset| {
            let manifest = dataset.manifest();
            manifest
                .parts
                .iter()
                .filter(|part| !dataset.is_held_out(part))
                .map(|part| manifest.scenes[part.scene as usize].name.clone())
        })
        .collect()
}
