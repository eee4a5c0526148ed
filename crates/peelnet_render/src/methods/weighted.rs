//! `weighted-sum`, `weighted-average`, `blended` and `wboit-*`: one geometry pass each.

use super::{
    Build, Compositor, MethodSpec,
    commutative::{self, Blend, Gather, Plan, TINTED, Target},
};
use crate::RenderError;
use peelnet_core::weights::Weight;

/// `Σ C w` and `Σ α w`.
pub(super) const SUMS: Target = Target {
    label: "sums",
    channels: 4,
    full: false,
    blend: Blend::Add,
};

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

/// Builds a method of weighted sums and a transmittance in the targets that the scene's colours call for.
fn build_sums(b: &Build<'_>, gather: Gather<'_>) -> Result<Box<dyn Compositor>, RenderError> {
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

const fn gather(shader: &'static str, writes: &'static [usize]) -> Gather<'static> {
    Gather {
        label: "gather",
        shader,
        writes,
        ..Gather::NONE
    }
}

pub(super) fn sum(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS],
            passes: &[gather("methods::weighted_sum::gather", &[0])],
            resolve: "methods::weighted_sum::resolve",
            resolve_reads: &[0],
            ..Plan::NONE
        },
    )
}

pub(super) fn average(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let count = Target {
        label: "fragment count",
        channels: 1,
        full: false,
        blend: Blend::Add,
    };
    commutative::build(
        b,
        &Plan {
            targets: &[SUMS, count],
            passes: &[gather("methods::weighted_average::gather", &[0, 1])],
            resolve: "methods::weighted_average::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}

pub(super) fn blended(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build_sums(b, gather("methods::blended::gather", &[]))
}

pub(super) fn wboit(
    b: &Build<'_>,
    weight: fn(&MethodSpec) -> Result<Weight, RenderError>,
) -> Result<Box<dyn Compositor>, RenderError> {
    let weight = weight(b.spec)?;
    let (mut factor, mut power, mut offset) = (0.0, 0, 0.0);
    match weight {
        Weight::Eq10 { factor: f } => factor = f,
        Weight::InversePower { k, epsilon } => (power, offset) = (k, epsilon),
        _ => {}
    }
    // `{:?}` prints a float with a point or exponent, and as the shortest text that reads back the same.
    let parameters = format!(
        "const FACTOR: f32 = {factor:?};\nconst POWER: u32 = {power}u;\nconst EPSILON: f32 = {offset:?};\n"
    );
    let feature = weight.name().replace('-', "_");
    build_sums(
        b,
        Gather {
            features: &[&feature],
            extra: &[("parameters", &parameters)],
            ..gather("methods::wboit::gather", &[])
        },
    )
}
