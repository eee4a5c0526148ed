//! `avboit`: transmittance from a grid of voxels of low resolution. The CPU twin of uniform surfaces is `peelnet_core::methods::avboit`,
//! which states the source.

use super::prelude::*;
use peelnet_core::{
    fragment::points,
    methods::{avboit, composite},
};

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
    promises: |_| Promises {
        per_pixel: false,
        ..Promises::NORMALISED
    },
    curve: &["", ":cell=4", ":cell=2,slices=128"],
    // Of a pixel whose neighbours are like it: `per_pixel` is not promised.
    twin: Some(|s, p| {
        let slices = slices(s) as usize;
        let t = avboit::transmittances(&points(p.fragments), &p.warp, slices);
        Some(composite(p.fragments, p.background, &t))
    }),
    ..Method::new(
        "avboit",
        "transmittance from a grid of blocks of pixels and slices of depth",
        plan,
    )
};

fn plan(p: &mut Plan<'_>) -> Result<(), RenderError> {
    let (cell, slices) = (CELL.count(p.b.spec).unwrap_or_default(), slices(p.b.spec));
    let [columns, rows] = p.b.frame.size.map(|s| u64::from(s).div_ceil(cell));
    p.parameters = format!("const CELL: u32 = {cell}u;\nconst SLICES: u32 = {slices}u;\n");
    let sums = p.target(SUMS)?;
    let transmittance = p.target(TRANSMITTANCE)?;
    let voxels = p.storage("voxels", 0, columns * rows * slices * 4)?;
    p.geometry("methods::avboit::voxels")
        .writes([transmittance, voxels]);
    p.compute("methods::avboit::integrate", columns * rows)
        .writes([voxels]);
    p.geometry("methods::avboit::gather")
        .reads([voxels])
        .writes([sums]);
    p.resolve("methods::wboit::resolve", [sums, transmittance]);
    Ok(())
}
