//! From views of a dataset to the examples of a recipe.

use std::ops::Range;

use peelnet_core::features::Feature;
use peelnet_core::methods::deep::Row;
use peelnet_dataset::{FragmentBatch, Split, Subset};
use peelnet_model::{Inputs, Recipe};

use crate::error::TrainError;
use crate::pixels::{self, View};
use crate::sample::Sample;
use crate::training_data::{PixelColumns, TrainingData};

/// How hard the pixels of a view are, see [`pixels::hardness`].
#[derive(Clone, Copy, Debug, Default)]
struct Hardness {
    sum: f64,
    pixels: u64,
}

/// Factors of the examples' weights, by view: the weights of a view are divided by its mean hardness, and all multiplied by the mean of
/// all.
#[derive(Clone, Debug, Default)]
pub(crate) struct ViewWeights {
    /// Mean hardness of all pixels.
    overall: f64,
    /// Divisor of each view.
    views: Vec<f64>,
}

impl ViewWeights {
    fn of(views: &[Hardness]) -> Self {
        let (sum, pixels) = views
            .iter()
            .fold((0.0, 0), |(s, p), view| (s + view.sum, p + view.pixels));
        let overall = sum / pixels.max(1) as f64;
        // A view that MBOIT-4 draws almost exactly must not outweigh all others.
        let divisor = |view: &Hardness| view.sum / view.pixels.max(1) as f64 + 0.02 * overall;
        Self {
            overall,
            views: views
                .iter()
                .map(|view| divisor(view).max(f64::MIN_POSITIVE))
                .collect(),
        }
    }

    /// Factors 1, 2 and 3.
    #[cfg(test)]
    pub(crate) fn for_tests() -> Self {
        Self {
            overall: 6.0,
            views: vec![6.0, 3.0, 2.0],
        }
    }

    /// Applies the factor of a view to weights of its examples.
    pub(crate) fn apply(&self, view: usize, weights: &mut [f32]) {
        for weight in weights {
            *weight = (f64::from(*weight) * self.overall / self.views[view]) as f32;
        }
    }
}

/// Turns views into the examples of a recipe.
pub(crate) struct Gather {
    recipe: Recipe,
    data: TrainingData,
    views: Vec<Hardness>,
}

impl Gather {
    pub(crate) fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            data: TrainingData::of_recipe(recipe),
            views: Vec::new(),
        }
    }

    /// Appends the examples of one view. After every batch of its rows, `after` gets all examples that it did not take before, and the
    /// view's number.
    pub(crate) fn view(
        &mut self,
        view: View<'_>,
        split: Split,
        sample: &mut Sample,
        mut after: impl FnMut(usize, &mut TrainingData) -> Result<(), TrainError>,
    ) -> Result<(), TrainError> {
        let Self {
            recipe,
            data,
            views,
        } = self;
        let recipe = *recipe;
        let number = views.len();
        let mut found = Hardness::default();
        sample.begin(view.rows());
        if let Inputs::Row(features) = recipe.inputs {
            view.for_each_batch(|batch| {
                rows(features, data, sample, split, batch);
                after(number, data)
            })?;
        } else {
            let warp = view.warp()?;
            view.for_each_batch(|batch| {
                pixels::pixels_of(batch, |[view, x, y], pixel| {
                    if !sample.keep([x, y], pixel.points.len()) {
                        return;
                    }
                    found.sum += pixels::hardness(recipe, pixel, &warp);
                    found.pixels += 1;
                    pixels::add(recipe, data, pixel, &warp, split.pixel(view, x, y));
                });
                after(number, data)
            })?;
        }
        views.push(found);
        Ok(())
    }

    /// Factors of the weights of the views so far.
    pub(crate) fn weights(&self) -> ViewWeights {
        ViewWeights::of(&self.views)
    }
}

/// Reads views, each with the split of its pixels, into memory.
pub(crate) fn in_memory<'a>(
    recipe: Recipe,
    sample: &mut Sample,
    views: impl IntoIterator<Item = (View<'a>, Split)>,
) -> Result<TrainingData, TrainError> {
    let mut gather = Gather::new(recipe);
    let mut first = Vec::new();
    for (view, split) in views {
        first.push(gather.data.examples());
        gather.view(view, split, sample, |_, _| Ok(()))?;
    }
    let factors = gather.weights();
    let mut data = gather.data;
    if let Some(weights) = &mut data.weights {
        first.push(weights.len());
        for (view, ends) in first.windows(2).enumerate() {
            factors.apply(view, &mut weights[ends[0]..ends[1]]);
        }
    }
    Ok(data)
}

/// Every row is an example with its transmittance as the target.
fn rows(
    features: &[&Feature<Row>],
    data: &mut TrainingData,
    sample: &mut Sample,
    split: Split,
    batch: &FragmentBatch,
) {
    for pixel in batch.pixels() {
        let first = pixel.start;
        let (view, x, y) = (batch.view[first], batch.x[first], batch.y[first]);
        if sample.keep([x, y], pixel.len()) {
            append(data, features, split.pixel(view, x, y), batch, pixel);
        }
    }
}

/// Appends the rows of a pixel as examples.
fn append(
    data: &mut TrainingData,
    features: &[&Feature<Row>],
    subset: Subset,
    batch: &FragmentBatch,
    pixel: Range<usize>,
) {
    for i in pixel.clone() {
        let row = Row {
            linear_depth: batch.linear_depth[i],
            alpha_sum: batch.alpha_sum[i],
            // Counts are far below 2²⁴, up to which 32-bit floats hold every integer.
            fragment_count: batch.fragment_count[i] as f32,
        };
        for (column, feature) in data.inputs.iter_mut().zip(features) {
            column.push((feature.value)(&row) as f32);
        }
        data.subsets.iter_mut().for_each(|all| all.push(subset));
    }
    data.targets[0].extend_from_slice(&batch.transmittance[pixel]);
}

impl TrainingData {
    /// No rows, with the columns of a recipe.
    pub(crate) fn of_recipe(recipe: Recipe) -> Self {
        let weighed = !matches!(recipe.inputs, Inputs::Row(_));
        Self {
            source: String::new(),
            inputs: vec![Vec::new(); recipe.inputs.about().len()],
            targets: vec![Vec::new(); recipe.output.count()],
            weights: weighed.then(Vec::new),
            pixels: recipe.loss.map(|_| PixelColumns::default()),
            subsets: Some(Vec::new()),
            used: None,
            split: None,
            dataset: None,
        }
    }
}
