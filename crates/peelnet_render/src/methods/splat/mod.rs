//! `splat`: slabs over the visible range, for pixels of hundreds of layers, of which the nearest are seen: Gaussian splats, and surfaces among them.
//!
//! A pass over one pixel in 64 says where around each pixel most is seen. Sixteen bins of absorbance among those depths, of every pixel, say where
//! in the pixel that is: it is cut into eight slabs, of which each is seen less than the one before, and behind the last one a depth test drops
//! all fragments before they are shaded. Of each slab absorbance and mean depth are kept, and the density between its borders is taken for linear.
//! Nothing is sorted and nothing is learned.

mod expectations;

use crate::methods::{prelude::*, wboit};
use peelnet_core::methods::{quantiles::TILE, slabs::Layout};
use peelnet_model::inputs::slab_surroundings;

pub(super) const METHOD: Method = Method {
    expectations: expectations::METHOD,
    ..Method::new(
        "splat",
        "eight slabs over a pixel's visible range, which sixteen bins find: for Gaussian splats",
        passes,
    )
};

/// Four of sixteen values of a pixel: first its bins, then the sums of its slabs.
const fn four(name: &'static str) -> Target {
    Target::half(name, 4, Blend::Add)
}

/// Written once, in 8 bits.
const fn bytes(name: &'static str, channels: u32) -> Target {
    Target::half(name, channels, Blend::AddBytes)
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
    let borders = [
        bytes("borders_near", 4),
        bytes("borders_far", 4),
        bytes("ends_of_pixel", 2),
    ];
    let borders = p.targets(borders);
    let limit = Some(p.depth());
    p.pixels("methods::splat::borders")
        .reads([quantiles])
        .reads(bins)
        .writes(borders.iter().copied())
        .depth(limit);
    // What is kept of the slabs takes the place of the bins.
    let kept = [
        "absorbances_near",
        "absorbances_far",
        "firsts_near",
        "firsts_far",
    ];
    let kept = [0, 1, 2, 3].map(|k| p.again(bins[k], four(kept[k])));
    p.geometry("methods::splat::statistics", Needs::OPACITY)
        .reads([quantiles])
        .reads(borders.iter().copied())
        .writes(kept)
        .depth(limit);
    let read = [quantiles].into_iter().chain(borders).chain(kept);
    wboit::sums(p, "methods::splat::gather", &[], read);
    p.limit_gather(limit);
}
