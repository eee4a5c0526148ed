//! `avboit`: transmittance from a grid of voxels of low resolution. `reference.rs` states the source.

mod expectations;
pub mod reference;

use crate::methods::{prelude::*, wboit};

/// Pixels of a column's side.
const CELL: u32 = 8;

const SLICES: Parameter = Parameter::whole(
    "slices",
    "slices of depth, 128 by default, taken from 2,048 intervals",
    Some(128),
    (32, 1024),
);

fn slices(spec: &MethodSpec) -> u64 {
    SLICES.count(spec).unwrap_or_default()
}

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS, SLICES],
    expectations: expectations::METHOD,
    ..Method::new(
        "avboit",
        "transmittance from a grid of voxels whose slices are where something is; one geometry pass, and two over one pixel in 64",
        passes,
    )
};

fn passes(p: &mut Passes<'_>) {
    let slices = slices(p.on.spec);
    let [columns, rows] = p.on.size.map(|s| u64::from(s.div_ceil(CELL)));
    p.parameters = format!("const SLICES: u32 = {slices}u;\n");
    let words = reference::INTERVALS as u64 / 32;
    let occupied = p.storage("occupied", 0, words * 4);
    let used = p.uncleared("used", (1 + 2 * words) * 4);
    let voxels = p.storage("voxels", 0, columns * rows * slices * 4);
    p.geometry("methods::avboit::occupied", Needs::DEPTH)
        .every(CELL)
        .writes([occupied]);
    p.compute("methods::avboit::compact", 1)
        .reads([occupied])
        .writes([used]);
    p.geometry("methods::avboit::splat", Needs::OPACITY)
        .every(CELL)
        .reads([used])
        .writes([voxels]);
    p.compute("methods::avboit::integrate", columns * rows)
        .writes([voxels]);
    wboit::sums(p, "methods::avboit::gather", &[], [used, voxels]);
}
