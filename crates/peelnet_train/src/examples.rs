//! From views of a dataset to the examples of a recipe.

use peelnet_core::absorbance::DepthWarp;
use peelnet_core::features::Feature;
use peelnet_core::fragment::Fragment;
use peelnet_core::methods::anchored::{self, Place};
use peelnet_core::methods::deep::Row;
use peelnet_core::methods::dfaoit::{FRONT, Layers};
use peelnet_core::methods::moments::{self, Settings};
use peelnet_core::methods::nmt;
use peelnet_core::methods::slabs;
use peelnet_dataset::{Column, Dataset, DatasetError, FragmentBatch, Part, Split, Subset};
use peelnet_model::{Inputs, Output, Recipe};

use crate::error::TrainError;
use crate::sampler::Sample;
use crate::table::{ALPHA, COLOR, EXACT, KNOWN, LEFT, REST, SUM, TrainingData};

const ROWS_AT_A_TIME: usize = 1 << 16;

/// A pixel, nearest fragment first.
pub(crate) struct Pixel<'a> {
    /// Number of its view, x, y.
    place: [u32; 3],
    /// Linear depth and opacity.
    pub(crate) points: &'a [(f32, f32)],
    /// `T_i`.
    pub(crate) transmittance: &'a [f32],
    /// Un-premultiplied radiance.
    colors: &'a [[f32; 3]],
    /// The pixel's sum of opacities as each row has it.
    alpha_sum: &'a [f32],
    /// The number of its fragments, likewise.
    fragment_count: &'a [u32],
}

impl Pixel<'_> {
    /// `T_∞`.
    fn behind(&self) -> f64 {
        let last = self.points.last().zip(self.transmittance.last());
        last.map_or(1.0, |((_, alpha), t)| {
            f64::from(*t) * f64::from(1.0 - alpha)
        })
    }

    /// `α_i T_i`: how much of each fragment is seen.
    fn contributions(&self) -> impl Iterator<Item = f64> + '_ {
        let points = self.points.iter().zip(self.transmittance);
        points.map(|((_, alpha), t)| f64::from(*alpha) * f64::from(*t))
    }
}

/// The rows of one view of a scene, and what its pixels are for.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) dataset: &'a Dataset,
    pub(crate) part: &'a Part,
    pub(crate) split: Split,
}

impl View<'_> {
    /// The depth warp over the range of the view's fragments. The features do not depend on the warp's range; where it
    /// matters (`nmt`), this is the range that tight bounding boxes would give.
    pub(crate) fn warp(self) -> Result<DepthWarp, TrainError> {
        let [mut near, mut far] = [f32::MAX, f32::MIN_POSITIVE];
        self.dataset.read_pieces(
            &[Column::LinearDepth],
            |p| p.index == self.part.index,
            |piece| {
                for &z in &piece.linear_depth {
                    (near, far) = (near.min(z), far.max(z));
                }
            },
        )?;
        Ok(DepthWarp::new(near.min(far).into(), far.into()))
    }

    /// Batches of whole pixels.
    pub(crate) fn batches(self) -> impl Iterator<Item = Result<FragmentBatch, DatasetError>> {
        let is_ours = move |p: &Part| p.index == self.part.index;
        self.dataset.batches_where(ROWS_AT_A_TIME, is_ours)
    }
}

pub(crate) fn pixels_of(batch: &FragmentBatch, mut each: impl FnMut(&Pixel<'_>)) {
    let points = batch.linear_depth.iter().zip(&batch.one_minus_alpha);
    let points: Vec<(f32, f32)> = points.map(|(&z, &through)| (z, 1.0 - through)).collect();
    let colors: Vec<[f32; 3]> = (0..batch.len())
        .map(|i| [batch.r[i], batch.g[i], batch.b[i]])
        .collect();
    for rows in batch.pixels() {
        let first = rows.start;
        each(&Pixel {
            place: [batch.view[first], batch.x[first], batch.y[first]],
            points: &points[rows.clone()],
            transmittance: &batch.transmittance[rows.clone()],
            colors: &colors[rows.clone()],
            alpha_sum: &batch.alpha_sum[rows.clone()],
            fragment_count: &batch.fragment_count[rows],
        });
    }
}

/// Factors of the examples' weights, by view: `w_i *= mean hardness of all pixels / mean hardness of the view`.
///
/// The figure that a user looks at is a method's error over that of another on the same image. Weighing each view by the
/// inverse of its mean hardness trains for that figure: low-alpha scenes count as much as glaring ones.
#[derive(Clone, Debug, Default)]
pub(crate) struct ViewWeights {
    pub(crate) overall: f64,
    /// Divisor of each view.
    pub(crate) views: Vec<f64>,
}

impl ViewWeights {
    /// From the sum of the hardness of each view's pixels, and their number.
    fn new(views: &[(f64, u64)]) -> Self {
        let (sum, pixels) = views
            .iter()
            .fold((0.0, 0), |(s, p), view| (s + view.0, p + view.1));
        let overall = sum / pixels.max(1) as f64;
        // A view that MBOIT-4 draws almost exactly must not outweigh all others.
        let divisor = |&(sum, pixels): &(f64, u64)| sum / pixels.max(1) as f64 + 0.02 * overall;
        let views = views.iter().map(divisor);
        Self {
            overall,
            views: views.map(|d| d.max(f64::MIN_POSITIVE)).collect(),
        }
    }

    pub(crate) fn apply(&self, view: usize, weights: &mut [f32]) {
        for weight in weights {
            *weight = (f64::from(*weight) * self.overall / self.views[view]) as f32;
        }
    }
}

/// Appends the examples of views to columns. `after` gets the number of the view, that of the rows that were read since its last call, and the
/// columns, from which it may take the examples.
pub(crate) fn gather<'a>(
    recipe: Recipe,
    data: &mut TrainingData,
    views: impl IntoIterator<Item = View<'a>>,
    sample: &mut Sample,
    mut after: impl FnMut(usize, usize, &mut TrainingData) -> Result<(), TrainError>,
) -> Result<ViewWeights, TrainError> {
    let mut hardnesses = Vec::new();
    for (number, view) in views.into_iter().enumerate() {
        sample.begin(view.part.rows);
        // Columns of a dataset need none.
        let warp = match recipe.inputs {
            Inputs::Row(_) => None,
            _ => Some(view.warp()?),
        };
        let (mut sum, mut pixels) = (0.0, 0);
        for batch in view.batches() {
            let batch = batch?;
            pixels_of(&batch, |pixel| {
                let [index, x, y] = pixel.place;
                if !sample.keep([x, y], pixel.points.len()) {
                    return;
                }
                if let Some(warp) = &warp {
                    sum += hardness(recipe, pixel, warp);
                    pixels += 1;
                }
                let subset = view.split.pixel(index, x, y);
                add(recipe, data, pixel, warp.as_ref(), subset);
            });
            after(number, batch.len(), data)?;
        }
        hardnesses.push((sum, pixels));
    }
    Ok(ViewWeights::new(&hardnesses))
}

/// Squared error of a pixel without the network, mean over the channels: how hard the pixel is. Drawn by the same slabs with the middle of
/// the bounds, or by MBOIT-4.
fn hardness(recipe: Recipe, pixel: &Pixel<'_>, warp: &DepthWarp) -> f64 {
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
    let t = moments::transmittances(pixel.points, warp, &Settings::FOUR);
    let seen = pixel.points.iter().zip(t);
    let seen: Vec<f64> = seen.map(|((_, alpha), t)| f64::from(*alpha) * t).collect();
    let scale = (1.0 - pixel.behind()) / seen.iter().sum::<f64>().max(1e-12);
    let mut sum = [0.0; 3];
    for (seen, color) in seen.iter().zip(pixel.colors) {
        for (sum, &c) in sum.iter_mut().zip(color) {
            *sum += seen * scale * f64::from(c);
        }
    }
    sum
}

fn values<'f, C>(features: &'f [&Feature<C>], known: &'f C) -> impl Iterator<Item = f64> + 'f {
    features.iter().map(move |feature| (feature.value)(known))
}

/// Appends what the recipe learns from a pixel.
fn add(
    recipe: Recipe,
    data: &mut TrainingData,
    pixel: &Pixel<'_>,
    warp: Option<&DepthWarp>,
    subset: Subset,
) {
    match (recipe.inputs, warp) {
        (Inputs::Row(features), _) => {
            // Every row is an example with its transmittance as the target.
            for (i, &(linear_depth, _)) in pixel.points.iter().enumerate() {
                let row = Row {
                    linear_depth,
                    alpha_sum: pixel.alpha_sum[i],
                    // Counts are far below 2²⁴, up to which 32-bit floats hold every integer.
                    fragment_count: pixel.fragment_count[i] as f32,
                };
                data.push_row(values(features, &row), [pixel.transmittance[i].into()]);
                data.end_example(1.0, subset);
            }
        }
        (Inputs::Moments(features), Some(warp)) => {
            let all = nmt::Seen::all(pixel.points, warp);
            for ((seen, &(_, alpha)), &t) in all.iter().zip(pixel.points).zip(pixel.transmittance) {
                data.push_row(values(features, seen), [t.into()]);
                // An error of T is seen as much as the fragment is opaque.
                data.end_example(alpha * alpha, subset);
            }
        }
        (Inputs::Layers(features), _) => color_row(features, data, pixel, subset),
        (Inputs::Rest(features), Some(warp)) => {
            let apart = recipe.output == Output::AnchoredShareSeparateEnds;
            let all = anchored::seen(pixel.points, warp, recipe.sums);
            let known = all.iter().map(|seen| {
                let is_between = seen.place == Place::Between;
                let guessed = is_between.then_some((seen.rest.absorbance, &seen.rest));
                (seen.weight(|_| 0.0), guessed)
            });
            share_pixel(features, data, pixel, subset, apart, known);
        }
        (Inputs::Slabs(design, features), Some(warp)) => {
            let all = slabs::seen(pixel.points, warp, design, recipe.sums);
            let known = all.iter().map(|seen| {
                let guessed = seen.between.as_ref();
                let guessed = guessed.map(|b| (b.absorbance * (b.bounds[1] - b.bounds[0]), b));
                (seen.weight(|_| 0.0), guessed)
            });
            share_pixel(features, data, pixel, subset, design.apart, known);
        }
        (_, None) => {}
    }
}

/// What is known of a fragment's weight without the network; and the absorbance that the network says a share of, which takes from that
/// weight, and what the network reads, or none where the weight is known.
type Known<'s, C> = (f64, Option<(f64, &'s C)>);

/// The fragments of a pixel whose share the network is asked for, with the inputs of each, and what the others contribute: those are `apart`
/// where they are not normalised with the rest.
fn share_pixel<'s, C: 's>(
    features: &[&Feature<C>],
    data: &mut TrainingData,
    pixel: &Pixel<'_>,
    subset: Subset,
    apart: bool,
    all: impl Iterator<Item = Known<'s, C>>,
) {
    let all: Vec<_> = all.collect();
    let guessed = all.iter().filter(|(_, guessed)| guessed.is_some()).count();
    // Exact whatever the network says: nothing to learn.
    if guessed == 0 || (apart && guessed == 1) {
        return;
    }
    let first = data.rows_held() as u32;
    let mut left = 1.0 - pixel.behind();
    let mut fixed = [0.0f32; 8];
    for (i, exact) in pixel.contributions().enumerate() {
        let ((weight, guessed), color) = (all[i], pixel.colors[i]);
        // What is known of its weight goes with its opacity.
        let a = f64::from(pixel.points[i].1) * weight;
        if let Some((guessed, inputs)) = guessed {
            data.push_row(values(features, inputs), [exact]);
            if let Some(pixels) = &mut data.pixels {
                pixels.rows[REST].push(guessed as f32);
                pixels.rows[ALPHA].push(a as f32);
                for (column, c) in pixels.rows[COLOR..].iter_mut().zip(color) {
                    column.push(c);
                }
            }
        } else if apart {
            left -= a;
        } else {
            fixed[SUM] += a as f32;
            for (k, c) in color.into_iter().enumerate() {
                fixed[KNOWN + k] += a as f32 * c;
                fixed[EXACT + k] += exact as f32 * c;
            }
        }
    }
    fixed[LEFT] = left.max(0.0) as f32;
    if let Some(pixels) = &mut data.pixels {
        pixels.first.push(first);
        for (column, value) in pixels.fixed.iter_mut().zip(fixed) {
            column.push(value);
        }
    }
    data.end_example(1.0, subset);
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
    data.push_row(values(features, &layers), exact.map(|c| c.min(1.0)));
    data.end_example(1.0, subset);
}
