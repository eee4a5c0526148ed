//! The targets and passes that methods of weighted sums share: one geometry pass each.

use super::{
    commutative::{self, Blend, Gather, Plan, TINTED, Target},
    compositor::{Build, Compositor},
};
use super::{parameter::Word, spec::MethodSpec};
use crate::error::RenderError;

/// `Σ C w` and `Σ α w`.
pub(super) const SUMS: Target = Target {
    label: "sums",
    channels: 4,
    full: false,
    blend: Blend::Add,
};

/// How the thesis's methods composite.
pub(super) const COMPOSITE: Word = Word {
    name: "composite",
    about: "eq6 (default), or printed: the sums of the thesis's shader as they stand in print",
    words: &["eq6", PRINTED],
};

const PRINTED: &str = "printed";

/// Whether a method of the thesis composites as printed.
pub(super) fn is_printed(spec: &MethodSpec) -> bool {
    COMPOSITE.of(spec) == PRINTED
}

/// `T_∞`.
pub(super) const TRANSMITTANCE: Target = Target {
    label: "transmittance",
    channels: 1,
    full: false,
    blend: Blend::Transmit,
};

/// Of grey colours `Σ C w`, `Σ α w` and, where alpha is, `T_∞`: one target less.
const PACKED: Target = Target {
    blend: Blend::AddTransmit,
    ..SUMS
};

/// Builds a method of weighted sums and a transmittance in the targets that the scene's colours need.
pub(super) fn build_sums(
    b: &Build<'_>,
    gather: Gather<'_>,
) -> Result<Box<dyn Compositor>, RenderError> {
    let (targets, places, feature): (&[Target], &[usize], &[&str]) =
        match (b.scene.grey, b.scene.tinted) {
            (true, _) => (&[PACKED], &[0], &["packed"]),
            (false, true) => (&[SUMS, TINTED], &[0, 1], &["tinted"]),
            (false, false) => (&[SUMS, TRANSMITTANCE], &[0, 1], &[]),
        };
    let features = [gather.features, feature].concat();
    commutative::build(
        b,
        &Plan {
            targets,
            passes: &[Gather {
                features: &features,
                writes: places,
                ..gather
            }],
            resolve: "methods::wboit::resolve",
            resolve_features: feature,
            resolve_reads: places,
            ..Plan::NONE
        },
    )
}

/// The one geometry pass.
pub(super) const fn gather(shader: &'static str, writes: &'static [usize]) -> Gather<'static> {
    Gather {
        label: "gather",
        shader,
        writes,
        ..Gather::NONE
    }
}
