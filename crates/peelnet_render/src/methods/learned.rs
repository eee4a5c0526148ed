use super::prelude::*;
use crate::target::LearnedWeight;
use peelnet_core::{absorbance::DepthWarp, methods::one::Around, statistics::SumPrecision};
use peelnet_model::{Model, Recipe, inputs::Observed};

impl LearnedWeight {
    /// The network that ships for a method; `None` for a method that has none.
    pub fn shipped(spec: &MethodSpec) -> Option<Self> {
        let recipe = Recipe::for_method(spec.name())?;
        let shipped = peelnet_shipped_networks::find(recipe.name)?;
        Some(Self {
            recipe,
            wgsl: shipped.wgsl.to_owned(),
        })
    }
}

impl Build<'_> {
    /// The text that a learned method draws with, if it was trained for this method.
    pub(crate) fn learned_weight(&self) -> Result<&LearnedWeight, RenderError> {
        let learned = self.options.learned.as_ref();
        let learned = learned.ok_or_else(|| RenderError::NeedsModel(self.spec.to_string()))?;
        let method = learned.recipe.method;
        if method != self.spec.name() {
            return Err(RenderError::WrongValue(format!(
                "method {}: the model given was trained for method {method}; use that method, or another model",
                self.spec
            )));
        }
        Ok(learned)
    }
}

/// The transmittance that a learned method's network estimates.
pub(super) fn learned_transmittances(
    spec: &MethodSpec,
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    model: Option<&Model>,
) -> Option<Vec<f64>> {
    let all = model?.transmittances(&Observed {
        fragments,
        warp: *warp,
        precision: match spec.guarantees().statistics {
            Precision::Half => SumPrecision::Half,
            Precision::Full => SumPrecision::Exact,
        },
        around: Around::NONE,
    });
    (!all.is_empty() || fragments.is_empty()).then_some(all)
}
