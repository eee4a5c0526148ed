//! Every method: one home each, a module that declares a [`Method`] and draws it.
//!
//! [`METHODS`] lists the declarations; names, help texts, benchmarks, hard cases and tests are made from them. [`MethodSpec`] is a
//! method's name with its parameters, parsed. CONTRIBUTING.md adds a method step by step.

mod abuffer;
mod anchored;
mod avboit;
mod bins;
pub(crate) mod compositor;
mod deep_thesis;
mod depth_peel;
mod dfaoit;
mod dual_peel;
mod kbuffer;
mod learned;
mod linked_list;
mod low_resolution;
mod mboit;
pub(crate) mod method;
mod mlab;
mod nmt;
mod painter;
pub(crate) mod parameter;
mod peeling;
pub(crate) mod plan;
mod slabs;
pub(crate) mod spec;
mod stochastic;
mod stored;
pub mod views;
mod wavelet;
mod wboit;
mod weighted_average;
mod weighted_sum;

pub use compositor::FrameStats;
pub use method::{Estimate, Method, Numbered, Pixel, Promises, Twin, role};
pub use parameter::{Parameter, Precision, SCALE, Values};
pub use spec::MethodSpec;

mod prelude {
    pub(super) use super::{
        compositor::{Build, Compositor, DrawContext, Fit, FrameStats},
        method::{Method, Numbered, Pixel, Promises, weighted_twin},
        parameter::{MOMENT_TARGETS, Parameter, Precision, TARGETS},
        plan::{ENDS, Plan, SUMS, TRANSMITTANCE, Target},
        spec::MethodSpec,
    };
    pub(super) use crate::geometry::Blend;
    pub(super) use crate::{
        RenderError,
        flaw::{Flaw, Property, half_statistics, half_sums},
    };
}

use crate::RenderError;
use compositor::{Build, Compositor};

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
    wboit::BLENDED,
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
    avboit::METHOD,
    kbuffer::PLAIN,
    kbuffer::HYBRID,
    mlab::METHOD,
    slabs::METHOD,
    stochastic::METHOD,
    deep_thesis::METHOD,
    nmt::METHOD,
    dfaoit::METHOD,
    slabs::SMALL,
    slabs::MEDIUM,
    slabs::LARGE,
    anchored::SMALL,
    anchored::MEDIUM,
];

pub(crate) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let (spec, method) = (b.spec, b.spec.method());
    // A scene's scale concerns estimates; the methods that judge them stay exact unless they are asked for a scale themselves.
    let default = if method.is_exact() {
        1.0
    } else {
        b.scene.scene().transparency_scale
    };
    let scale = SCALE.given(spec).map_or(default, |s: f64| s as f32);
    if b.scene.tinted && (!(method.promises)(spec).tinted || scale < 1.0) {
        let is_tinted = |m: &&'static Method| MethodSpec::representative(m).promises().tinted;
        let tinted: Vec<_> = METHODS
            .iter()
            .filter(is_tinted)
            .map(Method::usage)
            .collect();
        return Err(RenderError::Refused(format!(
            "{spec} keeps one transmittance a pixel, and this scene's transmission is coloured: draw it at full resolution with one of \
             {}, or make transmission_color grey",
            tinted.join(", ")
        )));
    }
    if scale < 1.0 {
        low_resolution::build(b, scale)
    } else {
        method.build(b)
    }
}
