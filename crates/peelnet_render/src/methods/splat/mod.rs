//! `splat`: absorbance over the visible range, for pixels of hundreds of layers, of which the nearest are seen: Gaussian splats, and surfaces among them.
//!
//! A pass over one pixel in 64 says where around each pixel most is seen. Sixteen bins of absorbance among those depths, of every pixel, say where
//! in the pixel that is. There lie sixteen knots, of which less is seen between each and the next one, and behind the last a depth test drops all
//! fragments before they are shaded. Absorbance is summed around knots: a fragment counts for the two beside it, more for the nearer, so that
//! nothing jumps when it moves from one interval to the next. Nothing is sorted and nothing is learned.

mod expectations;

use crate::{methods::prelude::*, passes::SUMS};
use peelnet_core::methods::{quantiles::TILE, slabs::Layout};
use peelnet_model::inputs::slab_surroundings;

pub(super) const METHOD: Method = Method {
    expectations: expectations::METHOD,
    ..Method::new(
        "splat",
        "absorbance around sixteen knots of a pixel's visible range: for Gaussian splats",
        passes,
    )
};

/// Four of sixteen values of a pixel: first its bins, then the sums around its knots.
const fn four(name: &'static str) -> Target {
    Target::half(name, 4, Blend::Add)
}

fn passes(p: &mut Passes<'_>) {
    // How depths are looked for around a pixel is that of the learned slabs.
    p.without_network(slab_surroundings(Layout::Large));
    let tiles = ["tile_a", "tile_b", "tile_c", "tile_d"];
    let tiles = tiles.map(|name| p.target(four(name).every(TILE)));
    p.geometry("methods::splat::bins", Needs::OPACITY)
        .label("tiles")
        .every(TILE)
        .writes(tiles);
    let quantiles = p.target(four("quantiles").every(TILE));
    p.pixels("methods::splat::around")
        .reads(tiles)
        .writes([quantiles]);
    let bins = ["bins_a", "bins_b", "bins_c", "bins_d"].map(|name| p.target(four(name)));
    p.geometry("methods::splat::bins", Needs::OPACITY)
        .reads([quantiles])
        .writes(bins);
    let knots = ["knots_a", "knots_b", "knots_c", "knots_d"];
    // Written once, in 8 bits.
    let knots = knots.map(|name| p.target(Target::half(name, 4, Blend::AddBytes)));
    let limit = Some(p.depth());
    p.pixels("methods::splat::knots")
        .reads([quantiles])
        .reads(bins)
        .writes(knots)
        .depth(limit);
    let total = p.target(Target::half("zeroth", 1, Blend::Add));
    p.pixels("methods::splat::total")
        .reads(bins)
        .writes([total]);
    // The sums take the place of the bins.
    let sums = [
        "absorbances_a",
        "absorbances_b",
        "absorbances_c",
        "absorbances_d",
    ];
    let sums = [0, 1, 2, 3].map(|k| p.again(bins[k], four(sums[k])));
    p.geometry("methods::splat::statistics", Needs::OPACITY)
        .reads([quantiles])
        .reads(knots)
        .writes(sums)
        .depth(limit);
    let colors = p.target(SUMS);
    p.geometry("methods::splat::gather", Needs::COLOR)
        .reads([quantiles])
        .reads(knots)
        .reads(sums)
        .writes([colors])
        .depth(limit);
    p.resolve("methods::mboit::four::resolve", [colors, total]);
    p.tint();
}
