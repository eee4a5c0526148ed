//! Storage for the fragments of a tile, and how a frame is cut into tiles that fit it.

use crate::geometry::{RenderError, error::over_budget};
use crate::gpu::{Gpu, groups_2d, wgpu};
use bytemuck::{Pod, Zeroable};

/// Bytes of a fragment's colours: with alpha, or with what it covers of each channel.
pub(crate) const fn color_bytes(tinted: bool) -> u64 {
    if tinted { 32 } else { 16 }
}

/// Layout of `Tile` in `peel/tile.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq, Eq)]
pub struct Tile {
    pub begin: u32,
    /// One past the last pixel.
    pub end: u32,
    /// Fragments that storage holds; those beyond are left out, and seen in the counts.
    pub capacity: u32,
    groups: u32,
}

impl Tile {
    pub fn new(begin: u32, end: u32, capacity: u64) -> Self {
        Self {
            begin,
            end,
            capacity: u32::try_from(capacity).unwrap_or(u32::MAX),
            groups: groups_2d(end - begin)[0],
        }
    }

    /// Its rectangle in a frame of this width: whole rows or a part of one; x, y, width, height.
    pub fn scissor(&self, width: u32) -> [u32; 4] {
        let (first, last) = (self.begin / width, (self.end - 1) / width);
        if first == last {
            [self.begin % width, first, self.end - self.begin, 1]
        } else {
            [0, first, width, last - first + 1]
        }
    }
}

/// Cuts a frame into tiles of at most `capacity` fragments. `offsets` has one entry more than the frame has pixels.
///
/// Tiles are whole rows where a row fits, else runs inside one row.
///
/// # Errors
/// A single pixel that does not fit.
pub fn tiles(offsets: &[u32], width: u32, capacity: u64) -> Result<Vec<Tile>, RenderError> {
    let pixels = offsets.len() as u32 - 1;
    let load = |begin: u32, end: u32| u64::from(offsets[end as usize] - offsets[begin as usize]);
    let mut tiles = Vec::new();
    let mut begin = 0;
    while begin < pixels {
        // Grow by rows, then (if not even one row fits) by pixels.
        let mut end = begin;
        if begin % width == 0 {
            while end < pixels && load(begin, end + width) <= capacity {
                end += width;
            }
        }
        if end == begin {
            let row_end = (begin / width + 1) * width;
            while end < row_end && load(begin, end + 1) <= capacity {
                end += 1;
            }
        }
        if end == begin {
            return Err(over_budget(load(begin, begin + 1), capacity));
        }
        tiles.push(Tile::new(begin, end, capacity));
        begin = end;
    }
    Ok(tiles)
}

/// Storage for a tile's fragments, grown to what tiles need.
#[derive(Debug)]
pub struct FragmentStorage {
    /// Linear depth of each fragment.
    pub depths: wgpu::Buffer,
    pub triangles: wgpu::Buffer,
    /// Un-premultiplied radiance and alpha of each fragment.
    pub colors: wgpu::Buffer,
    pub capacity: u64,
}

impl FragmentStorage {
    /// Storage for `fragments` fragments, with two colours each where transmission is coloured (`tinted`).
    pub fn new(gpu: &Gpu, fragments: u64, tinted: bool) -> Result<Self, RenderError> {
        Ok(Self {
            depths: gpu.storage("fragment depths", fragments * 4)?,
            triangles: gpu.storage("fragment triangles", fragments * 4)?,
            colors: gpu.storage("fragment colours", fragments * color_bytes(tinted))?,
            capacity: fragments,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offsets(counts: &[u32]) -> Vec<u32> {
        let mut all = vec![0];
        for c in counts {
            all.push(all[all.len() - 1] + c);
        }
        all
    }

    #[test]
    fn tiles_cover_every_pixel_once_and_fit() {
        let counts: Vec<u32> = (0..60).map(|i| (i * 7) % 13).collect();
        let offsets = offsets(&counts);
        for capacity in [12, 20, 50, 100, 1000] {
            let tiles = tiles(&offsets, 10, capacity).expect("fits");
            let mut next = 0;
            for t in &tiles {
                assert_eq!((t.begin, u64::from(t.capacity)), (next, capacity));
                let load = offsets[t.end as usize] - offsets[t.begin as usize];
                assert!(u64::from(load) <= capacity);
                // A tile is whole rows or lies inside one.
                assert!((t.begin % 10 == 0 && t.end % 10 == 0) || t.begin / 10 == (t.end - 1) / 10);
                next = t.end;
            }
            assert_eq!(next, 60);
        }
    }

    #[test]
    fn a_pixel_beyond_the_budget_is_an_error() {
        let error = tiles(&offsets(&[1, 9, 1]), 3, 8).unwrap_err().to_string();
        assert!(error.contains("9 fragments") && error.contains("holds 8"));
    }
}
