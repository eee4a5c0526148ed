//! `avboit`: transmittance from a grid of voxels of low resolution. `reference.rs` states the source.

mod expectations;
pub mod reference;

use crate::methods::prelude::*;

// A voxel of 16 x 16 pixels holds 512 opaque layers before its sum ends.
const CELL: Parameter = Parameter::whole(
    "cell",
    "pixels of a block's side, 8 by default",
    Some(8),
    (1, 16),
);

const SLICES: Parameter = Parameter::whole(
    "slices",
    "slices of depth, 64 by default",
    Some(64),
    (1, 1024),
);

fn slices(spec: &MethodSpec) -> u64 {
    SLICES.count(spec).unwrap_or_default()
}

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS, CELL, SLICES],
    curve: &["", ":cell=4", ":cell=2,slices=128"],
    expectations: expectations::METHOD,
    ..Method::new(
        "avboit",
        "transmittance from a grid of blocks of pixels and slices of depth",
        passes,
    )
};

fn passes(p: &mut Passes<'_>) {
    let (cell, slices) = (CELL.count(p.on.spec).unwrap_or_default(), slices(p.on.spec));
    let [columns, rows] = p.on.size.map(|s| u64::from(s).div_ceil(cell));
    p.parameters = format!("const CELL: u32 = {cell}u;\nconst SLICES: u32 = {slices}u;\n");
    let sums = p.target(SUMS);
    let transmittance = p.target(TRANSMITTANCE);
    let voxels = p.storage("voxels", 0, columns * rows * slices * 4);
    p.geometry("methods::avboit::voxels", Needs::OPACITY)
        .writes([transmittance, voxels]);
    p.compute("methods::avboit::integrate", columns * rows)
        .writes([voxels]);
    p.geometry("methods::avboit::gather", Needs::COLOR)
        .reads([voxels])
        .writes([sums]);
    p.resolve("methods::wboit::resolve", [sums, transmittance]);
}
