//! Every method, in a folder of its own: `mod.rs` has its source, parameters, targets and passes, `reference.rs` the same on the CPU, and
//! `expectations.rs` what tests ask of it.
//!
//! [`METHODS`] lists the declarations; names, help texts, benchmarks, stress cases and tests are made from them. [`MethodSpec`] is a
//! method's name with its parameters, parsed. CONTRIBUTING.md adds a method step by step.

mod abuffer;
mod anchored;
pub mod avboit;
pub mod bins;
pub mod blended;
mod deep_thesis;
mod depth_peel;
mod dfaoit;
mod dual_peel;
pub(crate) mod expectations;
pub mod kbuffer;
mod learned;
mod linked_list;
mod lookup;
mod mboit;
pub(crate) mod method;
pub mod mlab;
mod nmt;
pub mod one;
mod painter;
pub(crate) mod parameter;
pub mod slabs;
pub(crate) mod spec;
mod splat;
pub mod stochastic;
pub mod stored_colors;
mod tiles;
pub mod wavelet;
mod wboit;
pub mod weighted_average;
pub mod weighted_sum;

pub use expectations::{
    Estimate, Expectations, Guarantees, KnownFailure, Pixel, Property, Reference,
};
pub use method::{Method, Numbered, role};
pub use parameter::{Parameter, Precision, SCALE, Values};
pub use spec::MethodSpec;

/// What methods and their expectations are written with.
mod prelude {
    pub(super) use super::{
        expectations::{
            Expectations, Guarantees, KnownFailure, Property, half_statistics, half_sums,
            weighted_reference,
        },
        method::{Method, Numbered},
        parameter::{MOMENT_TARGETS, Parameter, Precision, TARGETS},
        spec::MethodSpec,
    };
    pub(super) use crate::{
        RenderError,
        geometry::{Blend, Needs},
        passes::{
            ENDS, Passes, SUMS, TRANSMITTANCE, Target,
            compositor::{Build, Compositor, DrawContext, Fit, FrameStats},
        },
    };
}

use crate::RenderError;
use crate::passes::{
    compositor::{Build, Compositor},
    low_resolution,
};
use peelnet_scene::Scene;

/// Every method, in the order of lists and reports.
pub const METHODS: &[Method] = &[
    abuffer::METHOD,
    linked_list::METHOD,
    depth_peel::METHOD,
    dual_peel::METHOD,
    painter::OBJECTS,
    painter::TRIANGLES,
    weighted_sum::METHOD,
    weighted_average::METHOD,
    blended::METHOD,
    wboit::EQ7,
    wboit::EQ8,
    wboit::EQ9,
    wboit::EQ10,
    wboit::PAPAKOSTAS,
    wboit::INVERSE_POWER,
    wboit::SMOKE,
    mboit::FOUR,
    mboit::SIX,
    mboit::EIGHT,
    mboit::TRIGONOMETRIC,
    wavelet::METHOD,
    bins::METHOD,
    splat::METHOD,
    avboit::METHOD,
    kbuffer::PLAIN,
    kbuffer::HYBRID,
    mlab::METHOD,
    slabs::METHOD,
    one::METHOD,
    one::WIDE,
    stochastic::METHOD,
    deep_thesis::METHOD,
    nmt::METHOD,
    dfaoit::METHOD,
    slabs::SMALL,
    slabs::MEDIUM,
    slabs::LARGE,
    one::DEEP,
    one::DEEP_WIDE,
    anchored::SMALL,
    anchored::MEDIUM,
];

pub(crate) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let (spec, method) = (b.spec, b.spec.method());
    spec.check_scene(b.scene.scene())?;
    match spec.scale(b.scene.scene()) {
        scale if scale < 1.0 => low_resolution::build(b, scale),
        _ => method.build(b),
    }
}

impl MethodSpec {
    /// The scale of the resolution that it draws a scene at. The scene's own concerns estimates; the methods that judge them stay exact unless
    /// they are asked for a scale themselves.
    fn scale(&self, scene: &Scene) -> f32 {
        let default = match self.method().is_exact() {
            true => 1.0,
            false => scene.transparency_scale,
        };
        SCALE.given(self).map_or(default, |s: f64| s as f32)
    }

    /// Whether it can draw what a scene holds.
    ///
    /// # Errors
    /// Light that takes a colour, where it keeps one transmittance a pixel.
    pub fn check_scene(&self, scene: &Scene) -> Result<(), RenderError> {
        if !scene.is_tinted() || (self.guarantees().tinted && self.scale(scene) >= 1.0) {
            return Ok(());
        }
        let is_tinted = |m: &&'static Method| MethodSpec::representative(m).guarantees().tinted;
        let tinted: Vec<_> = METHODS
            .iter()
            .filter(is_tinted)
            .map(Method::usage)
            .collect();
        Err(RenderError::Scene(format!(
            "{self} keeps one transmittance a pixel, and this scene's transmission is coloured: draw it at full resolution with one of \
             {}, or make transmission_color grey",
            tinted.join(", ")
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::{
        blended::reference as blended, kbuffer::reference as kbuffer, mlab::reference as mlab,
        stochastic::reference as stochastic, stored_colors::Colors,
        weighted_average::reference as weighted_average, weighted_sum::reference as weighted_sum,
    };
    use peelnet_core::{
        absorbance::DepthWarp,
        fragment::{Fragment, worked_example},
        methods::{anchored, dfaoit, over, slabs, slabs::Design, wboit},
        random::Random,
        weights::Weight,
    };

    const C0: [f32; 3] = [0.1, 0.2, 0.9];

    /// Up to so many layers, drawn in any order, are exact whatever a network says. 1e−6: about ten roundings of values ≤ 1. Layers closer
    /// than a level of depth would share a record, so the stacks are spread evenly.
    #[test]
    fn few_layers_are_exact() {
        let warp = DepthWarp::new(0.1, 2000.0);
        let mut random = Random::new(7, &[]);
        for seed in 0..800 {
            let n = seed % 4 + 1;
            let mut f: Vec<_> = (0..n)
                .map(|i| {
                    let depth = 0.2 * 8f32.powi(i as i32) * random.between(1.0, 1.5);
                    Fragment::new(depth, random.between(0.02, 0.98), random.color())
                })
                .collect();
            let exact = over::composite(&f, C0);
            f.rotate_left(random.below(n));
            let share = random.below(3) as f64 / 2.0;
            let anchored = |apart| anchored::composite(&f, C0, &warp, apart, |_| share);
            let slabs = |design| slabs::composite(&f, C0, &warp, design, |_| share);
            // The last layer is a tail of its own.
            let kbuffer = |tail| kbuffer::composite(&f, C0, 3, tail, Colors::Full);
            for (name, most, found) in [
                ("anchored", 2, anchored(false)),
                ("anchored, separate ends", 3, anchored(true)),
                ("small slabs", 2, slabs(Design::SMALL)),
                ("medium slabs", 2, slabs(Design::MEDIUM)),
                ("large slabs", 2, slabs(Design::LARGE)),
                ("dfaoit", 2, dfaoit::composite(&f, C0, |_| [9.0; 3])),
                ("kbuffer", 4, kbuffer(None)),
                ("hybrid", 4, kbuffer(Some(Weight::Eq9))),
                ("mlab", 4, mlab::composite(&f, C0, 4)),
                ("stochastic", 1, stochastic::composite(&f, C0, 8, [3, 5])),
            ] {
                let is_near = (0..3).all(|k| (found[k] - exact[k]).abs() < 1e-6);
                assert!(n > most || is_near, "{name}: {found:?} {exact:?}");
            }
        }
    }

    /// Σ C = (1.4, 1.4, 1.4) is out of the gamut. Eq 5: (1.4 / 2.4)·(1 − ½³·0.1). Weighted average: ᾱ = 0.6, 1 − 0.4⁴.
    /// Eq 6 with w = 1/z: Σ C w = ½·(1, ½, ¼) + 0.1125, Σ α w = 0.9875.
    #[test]
    fn the_worked_example() {
        let (f, black) = (worked_example(), [0.0; 3]);
        let inverse = Weight::InversePower { k: 1, epsilon: 0.0 };
        let exact = [0.6125, 0.3625, 0.2375];
        for (got, want) in [
            (over::composite(&f, black), exact),
            (weighted_sum::composite(&f, black), [1.4; 3]),
            (blended::composite(&f, black), [1.4 / 2.4 * 0.9875; 3]),
            (
                weighted_average::composite(&f, black),
                [1.4 / 2.4 * 0.9744; 3],
            ),
            (wboit::composite(&f, black, inverse), exact),
        ] {
            for (a, b) in got.into_iter().zip(want) {
                assert!((f64::from(a) - b).abs() < 1e-6, "{got:?} {want:?}");
            }
        }
    }
}
