//! From views of a dataset to the examples of a recipe.

use std::collections::BTreeMap;

use peelnet_core::absorbance::DepthWarp;
use peelnet_core::files::shown;
use peelnet_core::methods::known::KnownFragment;
use peelnet_core::methods::one::Around;
use peelnet_core::methods::quantiles::{Quantiles, Seen, TILE, Tiles, seen_behind_nearest};
use peelnet_core::methods::slabs::points;
use peelnet_core::statistics::SumPrecision;
use peelnet_dataset::{
    Column, Dataset, DatasetError, FragmentBatch, Part, Split, Subset, check_rows,
};
use peelnet_model::Recipe;
use peelnet_model::inputs::{Examples, Observed, PeeledPixel, PixelSums};

use crate::draws::Sample;
use crate::error::TrainError;
use crate::table::{EXACT, KNOWN, LEFT, SUM, TrainingData};

const ROWS_AT_A_TIME: usize = 1 << 16;

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

    /// What its pixels have in common, as a recipe's networks know it.
    pub(crate) fn frame(self, recipe: Recipe) -> Result<Frame, TrainError> {
        let warp = self.warp()?;
        let around = recipe.inputs.reads_around();
        let tiles = around.then(|| self.tiles(&warp)).transpose()?;
        Ok(Frame { warp, tiles })
    }

    /// The quantiles of its tiles, of each the pixel of the dataset that is nearest to the one that a renderer looks at.
    fn tiles(self, warp: &DepthWarp) -> Result<Tiles, TrainError> {
        let mut best: BTreeMap<[u32; 2], (u32, Seen)> = BTreeMap::new();
        for batch in self.batches() {
            let batch = batch?;
            for pixel in batch.pixels() {
                let (x, y) = (batch.x[pixel.start], batch.y[pixel.start]);
                let from_middle = |n: u32| (n % TILE).abs_diff(TILE / 2).pow(2);
                let distance = from_middle(x) + from_middle(y);
                let tile = [x / TILE, y / TILE];
                if best.get(&tile).is_none_or(|best| distance < best.0) {
                    let rows = batch.linear_depth[pixel.clone()].iter();
                    let rows = rows.zip(&batch.one_minus_alpha[pixel]);
                    let fragments: Vec<_> = rows.map(|(&z, &t)| (z, 1.0 - t)).collect();
                    let seen = seen_behind_nearest(&points(&fragments, warp));
                    best.insert(tile, (distance, seen));
                }
            }
        }
        let seen = best.into_iter().map(|(tile, (_, seen))| (tile, seen));
        Ok(Tiles::new(
            [self.part.width, self.part.height],
            &seen.collect(),
        ))
    }

    /// Batches of whole pixels.
    pub(crate) fn batches(self) -> impl Iterator<Item = Result<FragmentBatch, DatasetError>> {
        let is_ours = move |p: &Part| p.index == self.part.index;
        self.dataset.batches_where(ROWS_AT_A_TIME, is_ours)
    }
}

/// What the pixels of a view have in common.
pub(crate) struct Frame {
    pub(crate) warp: DepthWarp,
    pub(crate) tiles: Option<Tiles>,
}

impl Frame {
    fn around(&self, place: [u32; 2]) -> Around {
        let tiles = self.tiles.as_ref();
        let quantiles = tiles.map_or(Quantiles::EVEN, |tiles| tiles.at(place));
        Around::new(quantiles, place)
    }
}

/// Calls `each` with every pixel of a batch and its place: the number of its view, x, y.
pub(crate) fn each_pixel(
    batch: &FragmentBatch,
    frame: &Frame,
    precision: SumPrecision,
    mut each: impl FnMut([u32; 3], &PeeledPixel<'_>),
) {
    let points = batch.linear_depth.iter().zip(&batch.one_minus_alpha);
    let points: Vec<(f32, f32)> = points.map(|(&z, &through)| (z, 1.0 - through)).collect();
    let colors: Vec<[f32; 3]> = (0..batch.len())
        .map(|i| [batch.r[i], batch.g[i], batch.b[i]])
        .collect();
    for rows in batch.pixels() {
        let first = rows.start;
        let place = [batch.view[first], batch.x[first], batch.y[first]];
        let pixel = PeeledPixel {
            observed: Observed {
                fragments: &points[rows.clone()],
                warp: frame.warp,
                precision,
                around: frame.around([place[1], place[2]]),
            },
            transmittance: &batch.transmittance[rows.clone()],
            colors: &colors[rows.clone()],
            alpha_sum: &batch.alpha_sum[rows.clone()],
            fragment_count: &batch.fragment_count[rows],
        };
        each(place, &pixel);
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
        // Columns of a dataset need no warp, and have no weights.
        let is_weighed = data.weights.is_some();
        let frame = if is_weighed {
            view.frame(recipe)?
        } else {
            let warp = DepthWarp::new(1.0, 1.0);
            Frame { warp, tiles: None }
        };
        let (mut sum, mut pixels) = (0.0, 0);
        for batch in view.batches() {
            let batch = batch?;
            check_rows(&batch, view.part).map_err(|problem| {
                let file = view.dataset.path().join(&view.part.files[0].name);
                TrainError::rows(&shown(&file), &problem)
            })?;
            each_pixel(&batch, &frame, recipe.sums, |[index, x, y], pixel| {
                if !sample.keep([x, y], pixel.observed.fragments.len()) {
                    return;
                }
                if is_weighed {
                    sum += hardness(recipe, pixel);
                    pixels += 1;
                }
                let subset = view.split.pixel(index, x, y);
                match recipe.inputs.examples(pixel) {
                    Examples::Rows(rows) => {
                        for row in rows {
                            data.push_row(row.inputs, row.targets);
                            data.end_example(1.0, subset);
                        }
                    }
                    Examples::Pixel(fragments) => {
                        pixel_example(data, pixel, subset, recipe.inputs.known_apart(), &fragments);
                    }
                    Examples::Sums(pixel) => sums_example(data, subset, pixel),
                }
            });
            after(number, batch.len(), data)?;
        }
        hardnesses.push((sum, pixels));
    }
    Ok(ViewWeights::new(&hardnesses))
}

/// Squared error of a pixel without the network, mean over the channels: how hard the pixel is.
fn hardness(recipe: Recipe, pixel: &PeeledPixel<'_>) -> f64 {
    let mut error = recipe.inputs.baseline(pixel);
    for (exact, color) in pixel.contributions().zip(pixel.colors) {
        for (e, &c) in error.iter_mut().zip(color) {
            *e -= exact * f64::from(c);
        }
    }
    error.iter().map(|e| e * e / 3.0).sum()
}

/// The fragments of a pixel whose share the network is asked for, with the inputs of each, and what the others contribute: those are `apart`
/// where they are not normalised with the rest.
fn pixel_example(
    data: &mut TrainingData,
    pixel: &PeeledPixel<'_>,
    subset: Subset,
    apart: bool,
    fragments: &[KnownFragment<Vec<f64>>],
) {
    let guessed = fragments.iter().filter(|f| f.unknown.is_some()).count();
    // Exact whatever the network says: nothing to learn.
    if guessed == 0 || (apart && guessed == 1) {
        return;
    }
    let first = data.rows_held() as u32;
    let mut left = 1.0 - pixel.transmittance_behind();
    let mut fixed = [0.0f32; 8];
    for (i, exact) in pixel.contributions().enumerate() {
        let (fragment, color) = (&fragments[i], pixel.colors[i]);
        // What is known of its weight goes with its opacity.
        let a = f64::from(pixel.observed.fragments[i].1) * fragment.weight(|_| 0.0);
        if let Some(inputs) = &fragment.unknown {
            let [low, high] = fragment.bounds;
            let residual = fragment.absorbance * (high - low);
            guessed_row(data, inputs, exact, [residual, a], color);
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
    end_pixel(data, first, fixed, subset);
}

/// The sums of a pixel. What is known is left out of the exact colour.
fn sums_example(data: &mut TrainingData, subset: Subset, pixel: PixelSums) {
    let first = data.rows_held() as u32;
    let mut fixed = [0.0f32; 8];
    fixed[LEFT] = pixel.left as f32;
    for (fixed, c) in fixed[EXACT..].iter_mut().zip(pixel.color) {
        *fixed = c as f32;
    }
    for sum in pixel.sums {
        let numbers = [sum.absorbance, sum.weight];
        let color = sum.color.map(|c| c as f32);
        guessed_row(data, &sum.inputs, sum.exact, numbers, color);
        // The loss counts what is exact of each row once more.
        for (fixed, c) in fixed[EXACT..].iter_mut().zip(sum.color) {
            *fixed -= (c * sum.exact) as f32;
        }
    }
    end_pixel(data, first, fixed, subset);
}

/// A row of a pixel that the network is asked about; the numbers are those of the columns `RESIDUAL` and `ALPHA`, which come first.
fn guessed_row(
    data: &mut TrainingData,
    inputs: &[f64],
    exact: f64,
    numbers: [f64; 2],
    color: [f32; 3],
) {
    data.push_row(inputs.iter().copied(), [exact]);
    if let Some(pixels) = &mut data.pixels {
        let [residual, alpha] = numbers.map(|x| x as f32);
        let [r, g, b] = color;
        for (column, value) in pixels.rows.iter_mut().zip([residual, alpha, r, g, b]) {
            column.push(value);
        }
    }
}

/// The pixel of the rows from the first on.
fn end_pixel(data: &mut TrainingData, first: u32, fixed: [f32; 8], subset: Subset) {
    if let Some(pixels) = &mut data.pixels {
        pixels.first.push(first);
        for (column, value) in pixels.fixed.iter_mut().zip(fixed) {
            column.push(value);
        }
    }
    data.end_example(1.0, subset);
}
