//! What `peelnet inspect` says about a dataset: counts, ranges, histograms, and whether the rows agree with one
//! another.

use std::ops::Range;

use peelnet_core::tolerance::{self, UNIT_ROUNDOFF};
use serde::{Deserialize, Serialize};

use crate::column::{Column, ColumnSlice, FragmentBatch};
use crate::error::DatasetError;
use crate::manifest::{Manifest, Part};
use crate::reader::Dataset;

/// Violations that are listed; the rest is counted only.
const LISTED: usize = 20;
const ALPHA_BINS: usize = 20;

/// What a row must say, given the other rows of its pixel: column and property with its tolerance.
const CHECKS: [(Column, &str); 5] = [
    (Column::Transmittance, "|T_i − ∏_{j<i}(1 − α_j)| ≤ 2·n·2⁻²⁴"),
    (Column::AlphaSum, "|alpha_sum − Σα| ≤ n·2⁻²⁴·(Σα + 1)"),
    (Column::FragmentCount, "fragment_count = rows of the pixel"),
    (Column::Layer, "layer = 0, 1, … n − 1"),
    (Column::LinearDepth, "z_i ≥ z_{i−1}"),
];

/// A dataset in figures.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Hash of the dataset.
    pub hash: String,
    /// Number of rows, that is fragments.
    pub rows: u64,
    /// Number of pixels with at least one fragment.
    pub pixels: u64,
    /// Fragments that peeling left out.
    pub lost_fragments: u64,
    /// Pairs of neighbouring fragments at the same depth.
    pub coplanar_ties: u64,
    /// Rows of each scene.
    pub scenes: Vec<SceneRows>,
    /// Smallest and largest value of each column; empty without rows.
    pub columns: Vec<ColumnRange>,
    /// Pixels by their number of fragments, in bins 1, 2, 3–4, 5–8, 9–16, … up to the largest.
    pub fragments_per_pixel: Vec<Bin>,
    /// Rows by α, in bins of 0.05; the last one includes 1. Empty without rows.
    pub alpha: Vec<Bin>,
    /// The checks of the sums.
    pub checks: Vec<Check>,
    /// The first violations of any check.
    pub violations: Vec<Violation>,
    /// Parts of which the sums cannot be recomputed, because peeling left fragments out.
    pub parts_not_checked: u64,
}

/// Rows of one scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneRows {
    /// The scene's name.
    pub name: String,
    /// Whether it must not be trained on.
    pub held_out: bool,
    /// Its rows, of all views and copies.
    pub rows: u64,
}

/// Range of a column's values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ColumnRange {
    /// The column's name.
    pub name: String,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}

/// A bin of a histogram.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bin {
    /// Lower bound, included.
    pub from: f64,
    /// Upper bound: included for counts of fragments, not included for α (but for the last bin).
    pub to: f64,
    /// Number of pixels or rows.
    pub count: u64,
}

/// One property of the rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Its name.
    pub name: String,
    /// The property and its tolerance, as a formula.
    pub formula: String,
    /// The largest deviation found.
    pub worst: f64,
    /// The largest ratio of a deviation to its tolerance; 1 or less is a pass.
    pub worst_ratio: f64,
    /// How many rows violate it.
    pub violations: u64,
}

/// A row that violates a check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Violation {
    /// The part's first file.
    pub file: String,
    /// Row in the part, counted from 1.
    pub row: u64,
    /// The check.
    pub check: String,
    /// The value found.
    pub found: f64,
    /// The value recomputed from the other rows.
    pub expected: f64,
    /// The deviation that was allowed.
    pub tolerance: f64,
}

impl Summary {
    /// Reads the whole dataset once.
    ///
    /// # Errors
    /// If a file cannot be read or a value is out of range. Rows that contradict one another are no error but
    /// [`Summary::violations`].
    pub fn from_dataset(dataset: &Dataset) -> Result<Self, DatasetError> {
        let mut summary = Self::empty(dataset.manifest());
        for part in &dataset.manifest().parts {
            let mut row = 1;
            let lossy = part.lost_fragments > 0;
            summary.parts_not_checked += u64::from(lossy);
            for batch in dataset.batches_where(1 << 16, |p| p.index == part.index) {
                let batch = batch?;
                summary.add(&batch);
                for pixel in batch.pixels() {
                    summary.check_pixel(&batch, pixel, &part.files[0].name, row, lossy);
                }
                row += batch.len() as u64;
            }
        }
        Ok(summary)
    }

    /// Whether no check was violated.
    pub fn passes(&self) -> bool {
        self.checks.iter().all(|c| c.violations == 0)
    }

    fn empty(manifest: &Manifest) -> Self {
        let checks = CHECKS.iter().map(|(column, formula)| Check {
            name: column.name().to_owned(),
            formula: (*formula).to_owned(),
            ..Check::default()
        });
        let rows_by_scene = manifest.rows_by_scene();
        let scenes = manifest.scenes.iter().map(|scene| SceneRows {
            name: scene.name.clone(),
            held_out: scene.held_out,
            rows: rows_by_scene.get(scene.name.as_str()).copied().unwrap_or(0),
        });
        Self {
            hash: manifest.hash.clone(),
            lost_fragments: manifest.lost_fragments,
            coplanar_ties: manifest.coplanar_ties,
            scenes: scenes.collect(),
            checks: checks.collect(),
            ..Self::default()
        }
    }

    /// Counts rows, which are whole pixels, in the figures that need no other row: rows, pixels, ranges and histograms.
    pub fn add(&mut self, batch: &FragmentBatch) {
        if batch.is_empty() {
            return;
        }
        self.add_ranges(batch);
        self.rows += batch.len() as u64;
        for pixel in batch.pixels() {
            self.pixels += 1;
            let bin = pixel.len().next_power_of_two().ilog2() as usize;
            let bins = &mut self.fragments_per_pixel;
            while bins.len() <= bin {
                let before = bins.last().map_or(0.0, |b| b.to);
                bins.push(Bin {
                    from: before + 1.0,
                    to: (before * 2.0).max(1.0),
                    count: 0,
                });
            }
            bins[bin].count += 1;
        }
    }

    fn add_ranges(&mut self, batch: &FragmentBatch) {
        if self.columns.is_empty() {
            let column = |column: Column| ColumnRange {
                name: column.name().to_owned(),
                min: f64::INFINITY,
                max: f64::NEG_INFINITY,
            };
            self.columns = Column::ALL.map(column).into();
            let bin = |k: usize| Bin {
                from: k as f64 / ALPHA_BINS as f64,
                to: (k + 1) as f64 / ALPHA_BINS as f64,
                count: 0,
            };
            self.alpha = (0..ALPHA_BINS).map(bin).collect();
        }
        for (column, range) in Column::ALL.into_iter().zip(&mut self.columns) {
            let mut add = |value: f64| {
                range.min = range.min.min(value);
                range.max = range.max.max(value);
            };
            match batch.column(column) {
                ColumnSlice::F32(v) => v.iter().for_each(|&x| add(x.into())),
                ColumnSlice::U32(v) => v.iter().for_each(|&x| add(x.into())),
            }
        }
        for &v in &batch.one_minus_alpha {
            let bin = (1.0 - f64::from(v)) * ALPHA_BINS as f64;
            self.alpha[(bin as usize).min(ALPHA_BINS - 1)].count += 1;
        }
    }

    /// Checks the rows of one pixel. `first_row` is the number of the batch's first row.
    fn check_pixel(
        &mut self,
        batch: &FragmentBatch,
        pixel: Range<usize>,
        file: &str,
        first_row: u64,
        lossy: bool,
    ) {
        implied(batch, pixel, lossy, |i, k, values| {
            self.check(k, (file, first_row + i as u64), values);
        });
    }

    /// Compares a row's value with what the others say, and the deviation with its tolerance, for the check of this number.
    fn check(
        &mut self,
        check: usize,
        (file, row): (&str, u64),
        (found, expected, tolerance): (f64, f64, f64),
    ) {
        let check = &mut self.checks[check];
        let deviation = (found - expected).abs();
        check.worst = check.worst.max(deviation);
        if deviation > 0.0 {
            // An exact property has no tolerance to relate to: its ratio is the deviation in units of one.
            let unit = if tolerance > 0.0 { tolerance } else { 1.0 };
            check.worst_ratio = check.worst_ratio.max(deviation / unit);
        }
        if deviation > tolerance {
            check.violations += 1;
            if self.violations.len() < LISTED {
                self.violations.push(Violation {
                    file: file.to_owned(),
                    row,
                    check: check.name.clone(),
                    found,
                    expected,
                    tolerance,
                });
            }
        }
    }
}

/// Calls `each` with what the rows of a pixel say and what the others imply: the row, the number of the check, and the value found, the one
/// expected and the tolerance.
fn implied(
    batch: &FragmentBatch,
    pixel: Range<usize>,
    lossy: bool,
    mut each: impl FnMut(usize, usize, (f64, f64, f64)),
) {
    let n = pixel.len();
    let alphas = batch.one_minus_alpha[pixel.clone()].iter();
    let alpha_sum: f64 = alphas.map(|&v| 1.0 - f64::from(v)).sum();
    // Σα summed in 32 bits in any order, against a 64-bit sum over the stored 1 − α: n − 1 additions err by at most one unit roundoff
    // of the sum each, and n times α is recovered from a rounded 1 − α, at most one unit roundoff of 1.
    let sum_tolerance = n as f64 * UNIT_ROUNDOFF * (alpha_sum + 1.0);
    // ∏(1 − α_j) over the rows before this one.
    let mut transmittance = 1.0;
    let mut before = 0.0f32;
    for (layer, i) in pixel.enumerate() {
        let depth = batch.linear_depth[i];
        let checked = [
            (
                batch.transmittance[i].into(),
                transmittance,
                tolerance::transmittance(n),
            ),
            (batch.alpha_sum[i].into(), alpha_sum, sum_tolerance),
            (batch.fragment_count[i].into(), n as f64, 0.0),
            (batch.layer[i].into(), layer as f64, 0.0),
            (depth.into(), depth.max(before).into(), 0.0),
        ];
        // All but the order of depths are of all fragments of the pixel.
        let first = if lossy { 4 } else { 0 };
        for (k, values) in checked.into_iter().enumerate().skip(first) {
            each(i, k, values);
        }
        transmittance *= f64::from(batch.one_minus_alpha[i]);
        before = depth;
    }
}

/// Whether rows of whole pixels of a part agree with one another, as [`Summary::checks`] counts it.
///
/// # Errors
/// The first value that does not.
pub fn check_rows(batch: &FragmentBatch, part: &Part) -> Result<(), String> {
    let mut wrong = None;
    for pixel in batch.pixels() {
        let lossy = part.lost_fragments > 0;
        implied(batch, pixel, lossy, |i, k, (found, expected, tolerance)| {
            if (found - expected).abs() > tolerance {
                let (x, y, name) = (batch.x[i], batch.y[i], CHECKS[k].0);
                let say = || {
                    format!(
                        "pixel ({x}, {y}), layer {}: {name} is {found}, and the other rows say {expected}; `peelnet inspect` lists such rows, \
                         write the dataset again",
                        batch.layer[i]
                    )
                };
                wrong.get_or_insert_with(say);
            }
        });
    }
    wrong.map_or(Ok(()), Err)
}
