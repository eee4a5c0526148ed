//! From a tile's runs of fragments to rows of the dataset.

use crate::PeelError;
use peelnet_dataset::{FragmentBatch, Part};

/// What a tile left in GPU storage, read back.
#[derive(Debug, Default)]
pub struct RawTile {
    /// Row-major index of the first pixel.
    pub first_pixel: u32,
    /// First fragment of each pixel and the total, counted from the tile's first fragment.
    pub offsets: Vec<u32>,
    /// Linear depths; 0 in a slot that peeling left empty.
    pub depths: Vec<f32>,
    /// Un-premultiplied linear radiance and alpha.
    pub colors: Vec<[f32; 4]>,
    /// Indices in the scene's list of triangles, which is the order of drawing; empty unless asked for, see
    /// [`FragmentReader::keep_triangles`](crate::read_back::FragmentReader::keep_triangles).
    pub triangles: Vec<u32>,
}

/// What was noticed on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RowCounts {
    /// Rows written.
    pub rows: u64,
    /// Slots that peeling left empty: fragments lost.
    pub lost: u64,
    /// Neighbours of equal depth.
    pub coplanar: u64,
}

/// Fragments of a pixel beyond which sums and products are formed in 64 bits: `n` factors formed in 32 bits err by up to `2n` roundings
/// of 2⁻²⁴, a hundredth at 100,000. Rows of shorter runs keep the bits that they have always had.
const LONG: usize = 1500;

/// Makes the rows of a part's tile in `batch`, which is empty, and calls `flush` whenever it holds `chunk` rows or more (pixels stay
/// whole) and once at the end.
///
/// # Errors
/// What `flush` returns, and rows out of order, which the GPU should have sorted.
pub fn make_rows(
    tile: &RawTile,
    part: &Part,
    batch: &mut FragmentBatch,
    chunk: usize,
    counts: &mut RowCounts,
    mut flush: impl FnMut(&FragmentBatch) -> Result<(), PeelError>,
) -> Result<(), PeelError> {
    let mut unsorted = 0;
    let mut flush = |batch: &mut FragmentBatch| {
        // The columns that all rows of a view share.
        let rows = batch.layer.len();
        batch.view.resize(rows, part.index);
        batch.near.resize(rows, part.camera.near);
        batch.far.resize(rows, part.camera.far);
        let flushed = flush(batch);
        batch.clear();
        flushed
    };
    for (pixel, run) in (tile.first_pixel..).zip(tile.offsets.windows(2)) {
        let run = run[0] as usize..run[1] as usize;
        if run.is_empty() {
            continue;
        }
        let (mut n, mut alpha_sum, mut long_sum) = (0u32, 0.0f32, 0.0f64);
        for i in run.clone().filter(|&i| tile.depths[i] > 0.0) {
            n += 1;
            alpha_sum += tile.colors[i][3];
            long_sum += f64::from(tile.colors[i][3]);
        }
        let is_long = run.len() > LONG;
        if is_long {
            alpha_sum = long_sum as f32;
        }
        counts.lost += u64::from(run.len() as u32 - n);
        counts.rows += u64::from(n);
        let (mut transmittance, mut long_product) = (1.0f32, 1.0f64);
        let mut before = 0.0;
        for (layer, i) in (0..).zip(run.filter(|&i| tile.depths[i] > 0.0)) {
            let depth = tile.depths[i];
            let [r, g, b, alpha] = tile.colors[i];
            counts.coplanar += u64::from(depth == before);
            unsorted += u64::from(depth < before);
            before = depth;
            let through = 1.0 - alpha;
            batch.one_minus_alpha.push(through);
            batch.linear_depth.push(depth);
            batch.transmittance.push(transmittance);
            batch.layer.push(layer);
            batch.r.push(r);
            batch.g.push(g);
            batch.b.push(b);
            transmittance *= through;
            if is_long {
                long_product *= 1.0 - f64::from(alpha);
                transmittance = long_product as f32;
            }
        }
        // The columns that a pixel's rows share.
        let rows = batch.layer.len();
        batch.alpha_sum.resize(rows, alpha_sum);
        batch.fragment_count.resize(rows, n);
        batch.x.resize(rows, pixel % part.width);
        batch.y.resize(rows, pixel / part.width);
        if rows >= chunk {
            flush(batch)?;
        }
    }
    if !batch.is_empty() {
        flush(batch)?;
    }
    match unsorted {
        0 => Ok(()),
        rows => Err(PeelError::Unsorted(rows)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worked_example_and_a_hole() {
        let f = peelnet_core::fragment::worked_example();
        let mut tile = RawTile {
            first_pixel: 11,
            offsets: vec![0, 0, 4, 6],
            ..Default::default()
        };
        for f in f {
            tile.depths.push(f.depth);
            tile.colors
                .push([f.color[0], f.color[1], f.color[2], f.alpha]);
        }
        // Two coplanar fragments of which peeling lost one.
        tile.depths.extend([3.0, 0.0]);
        tile.colors.extend([[0.5; 4]; 2]);
        let mut part = Part {
            index: 2,
            width: 5,
            ..Part::default()
        };
        part.camera.far = 100.0;
        let (mut all, mut counts) = (FragmentBatch::default(), RowCounts::default());
        let mut batch = FragmentBatch::default();
        make_rows(&tile, &part, &mut batch, 1, &mut counts, |batch| {
            batch.check()?;
            all.extend_from(batch, 0..batch.len());
            Ok(())
        })
        .expect("rows");
        let expected = RowCounts {
            rows: 5,
            lost: 1,
            coplanar: 0,
        };
        assert_eq!(counts, expected);
        assert_eq!(all.transmittance, [1.0, 0.5, 0.25, 0.125, 1.0]);
        assert_eq!(all.layer, [0, 1, 2, 3, 0]);
        assert_eq!(all.fragment_count, [4, 4, 4, 4, 1]);
        assert_eq!(all.alpha_sum, [2.4, 2.4, 2.4, 2.4, 0.5]);
        assert_eq!((&all.x[3..], &all.y[3..]), (&[2, 3][..], &[2, 2][..]));
        assert_eq!(all.far, [100.0; 5]);
    }
}
