//! `avboit`: transmittance from a grid of voxels of low resolution. The CPU twin of uniform surfaces is `peelnet_core::methods::avboit`,
//! which states the source.

use super::{
    commutative::{self, Gather, Kernel, Plan, Storage},
    compositor::{Build, Compositor},
    method::{Method, Promises},
    parameter::{Count, Parameter, TARGETS},
    spec::MethodSpec,
    weighted::{SUMS, TRANSMITTANCE},
};
use crate::error::RenderError;
use peelnet_core::methods::avboit;

const CELL: Count = Count {
    name: "cell",
    about: "pixels of a block's side, 8 by default",
    // A voxel of 16 x 16 pixels holds 512 opaque layers before its sum ends.
    most: 16,
};

const SLICES: Count = Count {
    name: "slices",
    about: "slices of depth, 64 by default",
    most: 1024,
};

fn cell(spec: &MethodSpec) -> u64 {
    CELL.given(spec).unwrap_or(8)
}

fn slices(spec: &MethodSpec) -> u64 {
    SLICES.given(spec).unwrap_or(64)
}

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS, Parameter::Count(CELL), Parameter::Count(SLICES)],
    promises: |_| Promises {
        per_pixel: false,
        ..Promises::NORMALISED
    },
    curve: &["", ":cell=4", ":cell=2,slices=128"],
    // Of a pixel whose neighbours are like it: `per_pixel` is not promised.
    twin: Some(|s, p| {
        let slices = slices(s) as usize;
        Some(avboit::composite(
            p.fragments,
            p.background,
            &p.warp,
            slices,
        ))
    }),
    ..Method::new(
        "avboit",
        "transmittance from a grid of blocks of pixels and slices of depth",
        build,
    )
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let (cell, slices) = (cell(b.spec), slices(b.spec));
    let parameters = format!("const CELL: u32 = {cell}u;\nconst SLICES: u32 = {slices}u;\n");
    let extra = [("parameters", parameters.as_str())];
    let columns: u64 = b
        .frame
        .size
        .map(|s| u64::from(s).div_ceil(cell))
        .iter()
        .product();
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, TRANSMITTANCE],
            storage: &[Storage {
                label: "voxels",
                bytes: 0,
                of_frame: columns * slices * 4,
            }],
            passes: &[
                Gather {
                    label: "voxels",
                    shader: "methods::avboit::voxels",
                    extra: &extra,
                    writes: &[1],
                    stores: &[0],
                    ..Gather::NONE
                },
                Gather {
                    shader: "methods::avboit::gather",
                    extra: &extra,
                    writes: &[0],
                    loads: &[0],
                    ..Gather::NONE
                },
            ],
            kernel: Some(Kernel {
                after: 0,
                shader: "methods::avboit::integrate",
                extra: &extra,
                storage: 0,
                threads: columns,
            }),
            resolve: "methods::wboit::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
