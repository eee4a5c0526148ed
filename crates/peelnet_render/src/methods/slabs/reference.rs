//! The CPU reference.

use super::{RANGE, plain_layout};
use crate::methods::{MethodSpec, Pixel};
use peelnet_core::{
    absorbance::DepthWarp,
    methods::{
        quantiles::Quantiles,
        slabs::{self, Design, Extent, Interior},
    },
    statistics::SumPrecision,
};
use peelnet_model::{Model, inputs::SlabInputs};

/// A guess of where between its bounds the share lies that is in front of a fragment.
type Guess<'m> = Box<dyn Fn(&Interior) -> f64 + 'm>;

/// What the CPU reference keeps and guesses, of what is drawn without looking at other pixels or boxes.
fn design_and_guess<'m>(
    spec: &MethodSpec,
    model: Option<&'m Model>,
) -> Option<(Design, Guess<'m>)> {
    let (design, guess): (_, Guess<'m>) = if spec.needs_model() {
        let model = model?;
        let inputs = model.meta.recipe.inputs.downcast::<SlabInputs>()?;
        let guess = move |between: &_| model.answer(inputs.features, between);
        (inputs.design, Box::new(guess))
    } else {
        (plain_layout(spec).design(), Box::new(slabs::middle))
    };
    let extent = Extent::Among(Quantiles::EVEN);
    (RANGE.word(spec) == "frame").then_some((Design { extent, ..design }, guess))
}

/// What a pixel's colour is; `None` where a learned method has no model, or other pixels or boxes are looked at.
pub fn composite(spec: &MethodSpec, p: &Pixel<'_>) -> Option<[f32; 3]> {
    let (design, guess) = design_and_guess(spec, p.model)?;
    let (fragments, c0) = (p.fragments, p.background);
    Some(slabs::composite(fragments, c0, &p.warp, design, guess))
}

/// The estimated transmittance in front of each fragment, given as (linear depth, α).
pub fn transmittances(
    spec: &MethodSpec,
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    model: Option<&Model>,
) -> Option<Vec<f64>> {
    let (design, guess) = design_and_guess(spec, model)?;
    let half = SumPrecision::Half;
    let known = slabs::known_fragments(fragments, warp, design, half);
    Some(known.iter().map(|f| f.weight(&guess)).collect())
}
