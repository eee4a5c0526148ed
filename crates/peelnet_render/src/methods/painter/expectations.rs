use super::sorts;
use crate::methods::prelude::*;
use peelnet_core::{fragment::Fragment, methods::over};

/// Over-blending in the order of drawing: what is drawn last lies in front.
fn blend(drawn: &[Fragment], background: [f32; 3]) -> [f32; 3] {
    drawn.iter().fold(background, |behind, f| {
        let color = f.premultiplied();
        std::array::from_fn(|k| color[k] + (1.0 - f.alpha) * behind[k])
    })
}

const SWALLOWED: KnownFailure = KnownFailure::swallowed("alpha-tiny deep near-overflow");

pub(super) const PAINTER: Expectations = Expectations {
    guarantees: |s| Guarantees {
        order_independent: sorts(s),
        sorted: sorts(s),
        straight: true,
        ..Guarantees::NORMALISED
    },
    // Exact where objects, or triangles, neither intersect nor overlap in a cycle.
    reference: Some(|s, p| {
        Some(if sorts(s) {
            over::composite(p.fragments, p.background)
        } else {
            blend(p.fragments, p.background)
        })
    }),
    known_failures: &[SWALLOWED],
    ..Expectations::DEFAULT
};

pub(super) const OBJECTS: Expectations = PAINTER.failing(&[
    SWALLOWED,
    KnownFailure::new(Property::Steady, "passing", "objects swap whole (popping)").when(sorts),
]);
