//! From a tile's runs of fragments to rows of the dataset.

use crate::PeelError;
use peelnet_dataset::{FragmentBatch, Part};
use std::ops::AddAssign;

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
    /// [`Harvester::keep_triangles`](crate::harvest::Harvester::keep_triangles).
    pub triangles: Vec<u32>,
}

/// What is the same for all rows of a view.
#[derive(Clone, Copy, Debug)]
pub struct ViewConstants {
    /// The `view` column.
    pub view: u32,
    /// Frame width in pixels.
    pub width: u32,
    /// Near plane, scene units.
    pub near: f32,
    /// Far plane, scene units.
    pub far: f32,
}

impl From<&Part> for ViewConstants {
    fn from(part: &Part) -> Self {
        Self {
            view: part.index,
            width: part.width,
            near: part.camera.near,
            far: part.camera.far,
        }
    }
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
    /// Rows that are nearer than the one before in their pixel.
    pub unsorted: u64,
}

impl RowCounts {
    /// # Errors
    /// Rows out of order, which the GPU should have sorted.
    pub fn check(&self) -> Result<(), PeelError> {
        match self.unsorted {
            0 => Ok(()),
            rows => Err(PeelError::Unsorted(rows)),
        }
    }
}

impl AddAssign for RowCounts {
    fn add_assign(&mut self, other: Self) {
        self.rows += other.rows;
        self.lost += other.lost;
        self.coplanar += other.coplanar;
        self.unsorted += other.unsorted;
    }
}

/// Fragments of a pixel beyond which sums and products are formed in 64 bits: `n` factors formed in 32 bits err by up to `2n` roundings
/// of 2⁻²⁴, a hundredth at 100,000. Rows of shorter runs keep the bits that they have always had.
const LONG: usize = 1500;

/// Appends the rows of `tile`, calling `flush` whenever the batch holds `chunk` rows or more (pixels stay whole) and
/// once at the end.
///
/// # Errors
/// What `flush` returns.
pub fn append_rows<E>(
    tile: &RawTile,
    constants: ViewConstants,
    batch: &mut FragmentBatch,
    chunk: usize,
    mut flush: impl FnMut(&FragmentBatch) -> Result<(), E>,
) -> Result<RowCounts, E> {
    let mut counts = RowCounts::default();
    for (pixel, run) in (tile.first_pixel..).zip(tile.offsets.windows(2)) {
        let run = run[0] as usize..run[1] as usize;
        if run.is_empty() {
            continue;
        }
        let (mut n, mut alpha_sum) = (0u32, 0.0f32);
        let is_long = run.len() > LONG;
        let (mut long_sum, mut long_product) = (0.0f64, 1.0f64);
        for i in run.clone() {
            if tile.depths[i] > 0.0 {
                n += 1;
                alpha_sum += tile.colors[i][3];
                long_sum += f64::from(tile.colors[i][3]);
            }
        }
        if is_long {
            alpha_sum = long_sum as f32;
        }
        counts.lost += u64::from(run.len() as u32 - n);
        counts.rows += u64::from(n);
        let (mut transmittance, mut layer, mut before) = (1.0f32, 0, 0.0);
        for i in run {
            let depth = tile.depths[i];
            if depth <= 0.0 {
                continue;
            }
            let [r, g, b, alpha] = tile.colors[i];
            counts.coplanar += u64::from(depth == before);
            counts.unsorted += u64::from(depth < before);
            before = depth;
            let through = 1.0 - alpha;
            batch.one_minus_alpha.push(through);
            batch.linear_depth.push(depth);
            batch.transmittance.push(transmittance);
            batch.layer.push(layer);
            batch.r.push(r);
            batch.g.push(g);
            batch.b.push(b);
            if is_long {
                long_product *= 1.0 - f64::from(alpha);
                transmittance = long_product as f32;
            } else {
                transmittance *= through;
            }
            layer += 1;
        }
        // The columns that a pixel's rows share.
        let rows = batch.layer.len();
        batch.alpha_sum.resize(rows, alpha_sum);
        batch.fragment_count.resize(rows, n);
        batch.x.resize(rows, pixel % constants.width);
        batch.y.resize(rows, pixel / constants.width);
        if rows >= chunk {
            finish(batch, constants);
            flush(batch)?;
            batch.clear();
        }
    }
    if !batch.is_empty() {
        finish(batch, constants);
        flush(batch)?;
        batch.clear();
    }
    Ok(counts)
}

/// Fills the columns that all rows of a view share.
fn finish(batch: &mut FragmentBatch, constants: ViewConstants) {
    let rows = batch.layer.len();
    batch.view.resize(rows, constants.view);
    batch.near.resize(rows, constants.near);
    batch.far.resize(rows, constants.far);
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
        let constants = ViewConstants {
            view: 2,
            width: 5,
            near: 0.1,
            far: 100.0,
        };
        let mut all = FragmentBatch::default();
        let counts = append_rows(
            &tile,
            constants,
            &mut FragmentBatch::default(),
            1,
            |batch| {
                batch.check()?;
                all.extend_from(batch, 0..batch.len());
                Ok::<_, peelnet_dataset::DatasetError>(())
            },
        )
        .expect("rows");
        assert_eq!(
            counts,
            RowCounts {
                rows: 5,
                lost: 1,
                ..Default::default()
            }
        );
        assert_eq!(all.transmittance, [1.0, 0.5, 0.25, 0.125, 1.0]);
        assert_eq!(all.layer, [0, 1, 2, 3, 0]);
        assert_eq!(all.fragment_count, [4, 4, 4, 4, 1]);
        assert_eq!(all.alpha_sum, [2.4, 2.4, 2.4, 2.4, 0.5]);
        assert_eq!((&all.x[3..], &all.y[3..]), (&[2, 3][..], &[2, 2][..]));
        assert_eq!(all.far, [100.0; 5]);
    }
}
