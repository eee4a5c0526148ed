//! Where in depth the layers around each pixel are, found by a pass over one pixel of 64 without shading.

use super::prelude::*;
use crate::passes::Handle;
use peelnet_model::inputs::SmallTexture;

/// Of the tiles of a frame, in rows.
pub(super) struct Tiles {
    pub(super) count: u64,
    /// Quantiles of what is seen in the nine tiles around each, in 8 bits.
    pub(super) quantiles: Handle,
    /// What is seen in each, by bins of depth.
    pub(super) seen: Handle,
}

/// The passes that find them; `after_cuts` where what is seen is known from the last frame, but for its first and those after jumps.
pub(super) fn draw(p: &mut Passes<'_>, around: &SmallTexture, after_cuts: bool) -> Tiles {
    let small = around.pass.targets.iter();
    let small = small.map(|target| Target::described(target).every(around.every));
    let small = p.targets(small);
    let [columns, rows] = p.on.size.map(|n| u64::from(n.div_ceil(around.every)));
    let count = columns * rows;
    let seen = p.uncleared("seen", 64 * count);
    let quantiles = Target::half(around.name, 4, Blend::AddBytes).every(around.every);
    let quantiles = p.target(quantiles);
    let bins = p.geometry("passes::tiles::bins", Needs::OPACITY);
    // Opaque surfaces are compared with at the pixel that is looked at.
    bins.every(around.every).writes(small.iter().copied());
    bins.after_cuts |= after_cuts;
    let of_pixels = p.compute("passes::tiles::seen", count);
    // The last is as large as the texture that is made.
    let of_size = small.last().copied();
    of_pixels.reads(small).writes([seen]).after_cuts |= after_cuts;
    p.pixels("passes::tiles::quantiles")
        .reads([seen])
        .reads(of_size)
        .writes([quantiles]);
    Tiles {
        count,
        quantiles,
        seen,
    }
}
