use crate::methods::{depth_peel::expectations::COINCIDENT, prelude::*};
use peelnet_core::methods::dfaoit;
use peelnet_model::inputs::{DFAOIT, DfaoitInputs};

pub(super) const METHOD: Expectations = Expectations {
    // The colour is the network's, not a mean.
    guarantees: |_| Guarantees {
        normalised: false,
        ..Guarantees::NORMALISED
    },
    reference: Some(|_, p| {
        let model = p.model?;
        model.meta.recipe.inputs.downcast::<DfaoitInputs>()?;
        let network = |known: &dfaoit::Layers| {
            let color = model.answers(&DFAOIT, known);
            [0, 1, 2].map(|k| color[k] as f32)
        };
        Some(dfaoit::composite(p.fragments, p.background, network))
    }),
    known_failures: &[
        COINCIDENT,
        KnownFailure::MAGNIFIED,
        KnownFailure::new(
            Property::Dark,
            "high-alpha lines",
            "the network's own error (Tsopouridis et al. 2024)",
        ),
        KnownFailure::translucent(
            "the network's own error: it predicts the nearest layers' colour with that of the others (Tsopouridis et al. 2024)",
        ),
    ],
    ..Expectations::DEFAULT
};
