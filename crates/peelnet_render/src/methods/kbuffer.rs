//! `kbuffer-k` and `hybrid-k`: the k nearest fragments exactly, the tail blended (Bavoil et al. 2007; Maule et al. 2013). The
//! CPU twin is `peelnet_core::methods::kbuffer`.

use super::{
    Build, Compositor,
    commutative::{self, Gather, Plan, Storage},
    weighted::{SUMS, TRANSMITTANCE},
};
use crate::RenderError;

/// The tail by eq 5.
pub(super) fn plain(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build(b, "unweighted")
}

/// The tail by eq 6.
pub(super) fn hybrid(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let weight = b.spec.word("weight", &["eq9", "eq7", "eq8"])?;
    build(b, weight)
}

fn build(b: &Build<'_>, weight: &str) -> Result<Box<dyn Compositor>, RenderError> {
    let k = b.spec.size();
    let parameters = format!("const K: u32 = {k}u;\n");
    let extra = [("parameters", parameters.as_str())];
    let (nearest, triangles, colors) = (0, 1, 2);
    let storage = |label, bytes| Storage {
        label,
        bytes: bytes * k,
    };
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, TRANSMITTANCE],
            storage: &[
                storage("nearest depths", 4),
                storage("nearest triangles", 4),
                storage("nearest colours", 16),
            ],
            passes: &[
                Gather {
                    label: "insert",
                    shader: "methods::kbuffer::insert",
                    extra: &extra,
                    stores: &[nearest],
                    ..Gather::NONE
                },
                Gather {
                    shader: "methods::kbuffer::gather",
                    features: &[weight],
                    extra: &extra,
                    writes: &[0, 1],
                    loads: &[nearest],
                    stores: &[triangles, colors],
                    ..Gather::NONE
                },
            ],
            resolve: "methods::kbuffer::resolve",
            resolve_extra: &extra,
            resolve_reads: &[0, 1],
            resolve_loads: &[nearest, triangles, colors],
            ..Plan::NONE
        },
    )
}
