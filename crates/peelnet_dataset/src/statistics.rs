//! Statistics of columns, for normalisation and for a first look: gathered in one pass while rows are written, merged over parts.

use pulp::{Arch, Simd, WithSimd};
use serde::{Deserialize, Serialize};

use crate::column::{Column, ColumnKind, ColumnSlice};
use crate::manifest::Part;

/// Sums that are formed side by side, which makes them vector instructions. Row `k` always goes to sum `k % LANES`, so the result does not
/// depend on how rows were cut into batches.
const LANES: usize = 8;

/// Counts of one bucket, side by side.
const COUNTS: usize = 4;

/// Values that are added at once: few enough for the fastest cache.
const BLOCK: usize = 1 << 12;

/// Bins of a column of fractions, 0 … 1. A power of two: all edges are numbers of 32 bits.
const LINEAR_BINS: usize = 16;

/// Other columns have one bin for all below 0, one from 0 to `2^LEAST`, and one for each power of two from there on, up to 2¹²⁸.
const LEAST: i32 = -16;
const OCTAVE_BINS: usize = 2 + (128 - LEAST) as usize;

/// Statistics of one column.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ColumnStatistics {
    /// The column's name.
    pub name: String,
    /// Smallest value, in the column's unit.
    pub min: f64,
    /// Largest value, in the column's unit.
    pub max: f64,
    /// Arithmetic mean, in the column's unit.
    pub mean: f64,
    /// Standard deviation of all values (the sum of squares over n, not n − 1), in the column's unit.
    pub deviation: f64,
    /// Edges of the histogram's bins, one more than there are bins: of equal width for columns of fractions, powers of two for others. A bin
    /// has the values from its edge, included, to the next one, which is included in the last bin of fractions only.
    pub edges: Vec<f64>,
    /// Rows of each bin.
    pub counts: Vec<u64>,
}

/// The edges of all bins that a column can have.
fn edges(column: Column) -> Vec<f64> {
    if column.is_fraction() {
        let edge = |k| k as f64 / LINEAR_BINS as f64;
        return (0..=LINEAR_BINS).map(edge).collect();
    }
    let powers = (LEAST..=128).map(|k| f64::from(k).exp2());
    [f64::from(f32::MIN), 0.0]
        .into_iter()
        .chain(powers)
        .collect()
}

/// Values are counted in buckets first, which take an instruction or two, and buckets are the bins' in the end.
const BUCKETS: usize = 512;

/// The bucket of a fraction.
#[inline(always)]
fn bucket_of_fraction(value: f32) -> usize {
    (value * LINEAR_BINS as f32) as i32 as usize % BUCKETS
}

/// The bucket of another float: sign and exponent. Adding 0 makes −0 the 0 that it is.
#[inline(always)]
fn bucket_of_float(value: f32) -> usize {
    ((value + 0.0).to_bits() >> 23) as usize % BUCKETS
}

/// The bucket of an integer: its number of bits, of its exponent as a 64-bit float, which vector instructions find.
#[inline(always)]
fn bucket_of_integer(value: u32) -> usize {
    (f64::from(value).to_bits() >> 52).saturating_sub(1022) as usize % BUCKETS
}

/// Values of a block that lie in no more buckets than these are compared with one bucket after the other, in bytes.
const FEW: usize = 24;

/// Bytes whose sum is one.
const RUN: usize = 128;

/// The part of a block's values in few buckets, from the first one on.
#[inline(always)]
fn count_few<T: Copy>(values: &[T], first: usize, counts: &mut [u64], bucket: impl Fn(T) -> usize) {
    // What no value is in is no bucket.
    let mut codes = [[u8::MAX; RUN]; BLOCK / RUN];
    for (code, value) in codes.as_flattened_mut().iter_mut().zip(values) {
        *code = (bucket(*value) - first) as u8;
    }
    for (code, count) in (0u8..).zip(counts) {
        for run in &codes[..values.len().div_ceil(RUN)] {
            let mut ones = 0u8;
            for &of_value in run {
                ones = ones.wrapping_add(u8::from(of_value == code));
            }
            *count += u64::from(ones);
        }
    }
}

/// The bin of a bucket; of one that no value is in, any.
fn bin(column: Column, bucket: usize) -> usize {
    let bin = match (column.kind(), column.is_fraction()) {
        (_, true) => return bucket.min(LINEAR_BINS - 1),
        (ColumnKind::F32, _) if bucket >= BUCKETS / 2 => 0,
        // As they are stored, exponents count from −127.
        (ColumnKind::F32, _) => 1 + bucket.saturating_sub((126 + LEAST) as usize),
        (ColumnKind::U32, _) if bucket == 0 => 1,
        (ColumnKind::U32, _) => bucket + (1 - LEAST) as usize,
    };
    bin.min(OCTAVE_BINS - 1)
}

/// Gathers the statistics of one column of one part.
#[derive(Debug)]
pub(crate) struct Gatherer {
    column: Column,
    rows: u64,
    /// The first value. Sums are of differences from it: those of values that are all alike are exact.
    origin: f64,
    min: f64,
    max: f64,
    sums: [f64; LANES],
    squares: [f64; LANES],
    /// Rows by bucket. Neighbours are often of one bucket: they have different counts, so that none waits for the other's store.
    counts: Box<[[u64; BUCKETS]; COUNTS]>,
}

/// Runs with the widest registers that a processor has. All of it must become part of this function, which closures given to iterators need
/// not.
struct Add<'a, 'b>(&'a mut Gatherer, ColumnSlice<'b>);

impl WithSimd for Add<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self(to, values) = self;
        match values {
            ColumnSlice::F32(v) if to.column.is_fraction() => to.add_all(v, bucket_of_fraction),
            ColumnSlice::F32(v) => to.add_all(v, bucket_of_float),
            ColumnSlice::U32(v) => to.add_all(v, bucket_of_integer),
        }
    }
}

impl Gatherer {
    pub(crate) fn new(column: Column) -> Self {
        Self {
            column,
            rows: 0,
            origin: 0.0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            sums: [0.0; LANES],
            squares: [0.0; LANES],
            counts: Box::new([[0; BUCKETS]; COUNTS]),
        }
    }

    /// Adds values that the column allows.
    pub(crate) fn add(&mut self, values: ColumnSlice<'_>) {
        Arch::new().dispatch(Add(self, values));
    }

    #[inline(always)]
    fn add_all<T: Copy + Default + PartialOrd + Into<f64>>(
        &mut self,
        values: &[T],
        bucket: impl Fn(T) -> usize,
    ) {
        for block in values.chunks(BLOCK) {
            self.add_block(block, &bucket);
        }
    }

    /// In several passes, of which each becomes vector instructions as far as it can.
    #[inline(always)]
    fn add_block<T: Copy + Default + PartialOrd + Into<f64>>(
        &mut self,
        values: &[T],
        bucket: impl Fn(T) -> usize,
    ) {
        let Some(&first) = values.first() else { return };
        if self.rows == 0 {
            self.origin = first.into();
        }
        let (origin, start) = (self.origin, self.rows as usize % LANES);
        self.rows += values.len() as u64;
        let (min, max) = range(values, first);
        // Adding 0 makes −0 the 0 that it is.
        self.min = self.min.min(min.into() + 0.0);
        self.max = self.max.max(max.into() + 0.0);
        // Some columns are the same in all rows of a view: their differences are 0.
        if self.min == self.max {
            self.counts[0][bucket(first)] += values.len() as u64;
            return;
        }
        let all = values;
        let (head, values) = values.split_at(((LANES - start) % LANES).min(values.len()));
        let (chunks, tail) = values.as_chunks::<LANES>();
        self.add_one_by_one(head, start);
        // Arrays of their own, so that they stay in registers.
        let (mut sums, mut squares) = (self.sums, self.squares);
        for chunk in chunks {
            let differences = chunk.map(|value| value.into() - origin);
            sums = std::array::from_fn(|k| sums[k] + differences[k]);
            squares = std::array::from_fn(|k| squares[k] + differences[k] * differences[k]);
        }
        (self.sums, self.squares) = (sums, squares);
        self.add_one_by_one(tail, 0);
        let counts = &mut *self.counts;
        let (first, last) = (bucket(min), bucket(max));
        // Buckets ascend with values, but for negative floats.
        if min >= T::default() && last - first < FEW {
            count_few(all, first, &mut counts[0][first..=last], bucket);
            return;
        }
        for chunk in chunks {
            for (lane, value) in chunk.iter().enumerate() {
                counts[lane % COUNTS][bucket(*value)] += 1;
            }
        }
        for value in head.iter().chain(tail) {
            counts[0][bucket(*value)] += 1;
        }
    }

    /// Adds fewer values than lanes to the sums, from a lane on.
    #[inline(always)]
    fn add_one_by_one<T: Copy + Into<f64>>(&mut self, values: &[T], lane: usize) {
        for (k, &value) in values.iter().enumerate() {
            let difference = value.into() - self.origin;
            self.sums[lane + k] += difference;
            self.squares[lane + k] += difference * difference;
        }
    }

    /// The statistics of all values that were added; `None` without any.
    pub(crate) fn finish(&self) -> Option<ColumnStatistics> {
        if self.rows == 0 {
            return None;
        }
        let mut counts = vec![0; LINEAR_BINS.max(OCTAVE_BINS)];
        for of_lane in self.counts.iter() {
            for (bucket, count) in of_lane.iter().enumerate() {
                counts[bin(self.column, bucket)] += count;
            }
        }
        let n = self.rows as f64;
        let [sum, squares] = [self.sums, self.squares].map(|lanes| lanes.iter().sum::<f64>());
        let variance = (squares - sum * sum / n) / n;
        let mut statistics = ColumnStatistics {
            name: self.column.name().to_owned(),
            min: self.min,
            max: self.max,
            // Rounding may leave the range.
            mean: (self.origin + sum / n).clamp(self.min, self.max),
            deviation: variance.max(0.0).sqrt(),
            ..ColumnStatistics::default()
        };
        statistics.set_bins(self.column, &counts);
        Some(statistics)
    }
}

/// The least and the greatest of some values, and of `first`.
#[inline(always)]
fn range<T: Copy + PartialOrd>(values: &[T], first: T) -> (T, T) {
    const WIDTH: usize = 32;
    let (mut min, mut max) = ([first; WIDTH], [first; WIDTH]);
    let (chunks, rest) = values.as_chunks::<WIDTH>();
    for chunk in chunks {
        for k in 0..WIDTH {
            min[k] = if chunk[k] < min[k] { chunk[k] } else { min[k] };
            max[k] = if chunk[k] > max[k] { chunk[k] } else { max[k] };
        }
    }
    let less = |a: T, b: T| if b < a { b } else { a };
    let more = |a: T, b: T| if b > a { b } else { a };
    let min = min.iter().chain(rest).fold(first, |a, b| less(a, *b));
    let max = max.iter().chain(rest).fold(first, |a, b| more(a, *b));
    (min, max)
}

impl ColumnStatistics {
    /// Sets edges and counts from those of all bins that the column can have: from the first to the last that has rows.
    fn set_bins(&mut self, column: Column, counts: &[u64]) {
        let is_filled = |count: &u64| *count > 0;
        let first = counts.iter().position(is_filled).unwrap_or(0);
        let last = counts.iter().rposition(is_filled).unwrap_or(0);
        self.counts = counts[first..=last].to_vec();
        self.edges = edges(column)[first..=last + 1].to_vec();
    }

    /// Adds the counts to those of all bins; `None` where the edges are not the column's.
    fn add_bins(&self, column: Column, counts: &mut [u64]) -> Option<()> {
        let edges = edges(column);
        let first = edges
            .iter()
            .position(|edge| self.edges.first() == Some(edge))?;
        let bins = counts.get_mut(first..first + self.counts.len())?;
        for (all, count) in bins.iter_mut().zip(&self.counts) {
            *all = all.saturating_add(*count);
        }
        (edges.get(first..=first + self.counts.len()) == Some(&self.edges)).then_some(())
    }
}

/// Takes the statistics out of some parts, and merges them in the parts' order. None where a part has none, as those of earlier versions,
/// or where there are no rows.
pub(crate) fn take_merged(parts: &mut [Part]) -> Vec<ColumnStatistics> {
    let of_parts = parts
        .iter_mut()
        .map(|part| (part.rows, std::mem::take(&mut part.statistics)));
    let of_parts: Vec<_> = of_parts.filter(|(rows, _)| *rows > 0).collect();
    let merged = Column::ALL.into_iter().map(|column| {
        let of_column = of_parts
            .iter()
            .map(|(rows, all)| Some((*rows, all.get(column as usize)?)));
        merge(column, of_column.collect::<Option<Vec<_>>>()?)
    });
    // Records come from outside, with any numbers in them.
    let merged: Option<Vec<_>> = merged.collect();
    merged.unwrap_or_default()
}

fn merge(column: Column, parts: Vec<(u64, &ColumnStatistics)>) -> Option<ColumnStatistics> {
    let mut parts = parts.into_iter();
    let (mut n, first) = parts.next().map(|(rows, first)| (rows as f64, first))?;
    let mut counts = vec![0; LINEAR_BINS.max(OCTAVE_BINS)];
    first.add_bins(column, &mut counts)?;
    let (mut all, mut squares) = (first.clone(), first.deviation.powi(2) * n);
    for (rows, part) in parts {
        part.add_bins(column, &mut counts)?;
        // Chan, Golub and LeVeque: sums of squares about the means, whose difference is small against neither.
        let m = rows as f64;
        let difference = part.mean - all.mean;
        squares += part.deviation.powi(2) * m + difference * difference * n * m / (n + m);
        all.mean += difference * m / (n + m);
        n += m;
        all.min = all.min.min(part.min);
        all.max = all.max.max(part.max);
    }
    all.deviation = (squares / n).sqrt();
    all.set_bins(column, &counts);
    let numbers = [all.min, all.max, all.mean, all.deviation];
    let is_sound = all.name == column.name() && numbers.iter().all(|x| x.is_finite());
    is_sound.then_some(all)
}
