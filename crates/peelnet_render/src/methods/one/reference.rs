//! The CPU reference, of what is drawn without looking at other pixels.

use super::{design, is_framed};
use crate::methods::{MethodSpec, Pixel};
use peelnet_core::{
    absorbance::DepthWarp,
    methods::{
        one::{self, Ahead, Around, formula},
        quantiles::Quantiles,
    },
    statistics::SumPrecision,
};
use peelnet_model::{Model, inputs::NINE_OF_SUMS};

type Answer<'m> = Box<dyn Fn(&Ahead) -> f64 + 'm>;

/// `None` where a learned method has no model.
fn answer<'m>(spec: &MethodSpec, model: Option<&'m Model>) -> Option<Answer<'m>> {
    if !spec.needs_model() {
        return Some(Box::new(formula));
    }
    let model = model?;
    Some(Box::new(move |ahead: &_| {
        model.answer(&NINE_OF_SUMS, ahead)
    }))
}

/// What a pixel's colour is.
pub fn composite(spec: &MethodSpec, p: &Pixel<'_>) -> Option<[f32; 3]> {
    let answer = answer(spec, p.model).filter(|_| is_framed(spec))?;
    let around = Around::new(Quantiles::EVEN, p.position);
    let design = design(spec);
    Some(one::composite(
        p.fragments,
        p.background,
        &p.warp,
        design,
        around,
        answer,
    ))
}

/// The transmittance in front of each fragment that the colour stands for, given as (linear depth, α).
pub fn transmittances(
    spec: &MethodSpec,
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    model: Option<&Model>,
) -> Option<Vec<f64>> {
    let answer = answer(spec, model).filter(|_| is_framed(spec))?;
    let (around, half) = (Around::NONE, SumPrecision::Half);
    let all = one::transmittances(fragments, warp, design(spec), around, half, answer);
    Some(all)
}
