//! From a tile's runs of fragments to rows of the dataset.

use crate::{PeelError, read_back::RawTile};
use peelnet_dataset::{FragmentBatch, Part, PeeledFragment};

/// What was noticed on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct RowCounts {
    /// Rows written.
    pub rows: u64,
    /// Slots that peeling left empty: fragments lost.
    pub lost: u64,
    /// Neighbours of equal depth.
    pub coplanar: u64,
}

/// Makes the rows of a part's tile in `batch`, which is empty, and calls `flush` whenever it holds `chunk` rows or more (pixels stay
/// whole) and once at the end. Rows out of order, which the GPU should have sorted, are an error.
pub(crate) fn make_rows(
    tile: &RawTile,
    part: &Part,
    batch: &mut FragmentBatch,
    chunk: usize,
    counts: &mut RowCounts,
    mut flush: impl FnMut(&FragmentBatch) -> Result<(), PeelError>,
) -> Result<(), PeelError> {
    let (clip, mut unsorted) = ([part.camera.near, part.camera.far], 0);
    let mut flush = |batch: &mut FragmentBatch| {
        let flushed = flush(batch);
        batch.clear();
        flushed
    };
    for (pixel, run) in (tile.first_pixel..).zip(tile.offsets.windows(2)) {
        let run = run[0] as usize..run[1] as usize;
        if run.is_empty() {
            continue;
        }
        let mut before = 0.0;
        for &depth in tile.depths[run.clone()].iter().filter(|z| **z > 0.0) {
            counts.coplanar += u64::from(depth == before);
            unsorted += u64::from(depth < before);
            before = depth;
        }
        let slots = run.len() as u32;
        let pixel = [part.index, pixel % part.width, pixel / part.width];
        let fragment = |slot: usize| PeeledFragment {
            depth: tile.depths[slot],
            color: tile.colors[slot],
        };
        let rows = batch.push_pixel(pixel, clip, run.map(fragment));
        counts.lost += u64::from(slots - rows);
        counts.rows += u64::from(rows);
        if batch.len() >= chunk {
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
        assert_eq!((counts.rows, counts.lost, counts.coplanar), (5, 1, 0));
        assert_eq!(all.transmittance, [1.0, 0.5, 0.25, 0.125, 1.0]);
        assert_eq!(all.layer, [0, 1, 2, 3, 0]);
        assert_eq!(all.fragment_count, [4, 4, 4, 4, 1]);
        assert_eq!(all.alpha_sum, [2.4, 2.4, 2.4, 2.4, 0.5]);
        assert_eq!((&all.x[3..], &all.y[3..]), (&[2, 3][..], &[2, 2][..]));
        assert_eq!(all.far, [100.0; 5]);
    }
}
