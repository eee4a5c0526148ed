//! The text: a header, what surrounds the network, and the network.

use crate::{
    ExportError, Options, Precision,
    header::header,
    network::{call, weight_function},
};
use peelnet_core::{files::thousands, mlp::Mlp};
use peelnet_model::{Model, Recipe};

/// The directive that a text in 16 bits begins with, behind its header.
pub(crate) const ENABLE_HALVES: &str = "enable f16;\n";

/// Weights of a network that a text may hold. Compilers of shaders take a time that grows with the square of them: a quarter of a minute for these.
const MOST_WEIGHTS: usize = 1 << 13;

/// Random inputs of a verification, drawn evenly from the range that training saw.
pub(crate) const RANDOM: usize = 4096;

/// Multiply–adds of one evaluation of the network, as published costs count them (padding not included).
pub(crate) fn multiply_adds(mlp: &Mlp) -> usize {
    mlp.layers.iter().map(|l| l.inputs * l.outputs).sum()
}

/// The self-contained text of a model: a header, depth, statistics, the weight of a fragment and the resolve, and the network.
///
/// The same model gives the same bytes.
///
/// # Errors
/// A model that does not hold together, or whose output has no shader function.
pub fn text(model: &Model, options: &Options) -> Result<String, ExportError> {
    let language = options.language;
    if options.precision == Precision::F16 && !language.spelling().has_halves {
        return Err(ExportError::Refused(format!(
            "{language} has no portable 16-bit floats; choose wgsl, hlsl or msl, or 32 bits; nothing was written"
        )));
    }
    Ok(header(model, options) + &language.translate(&code(model, options.precision)?)?)
}

/// [`text()`] in WGSL, with which the renderer draws.
///
/// # Errors
/// Those of [`text()`].
pub fn wgsl(model: &Model) -> Result<String, ExportError> {
    text(model, &Options::default())
}

/// The text in WGSL without its header.
pub(crate) fn code(model: &Model, precision: Precision) -> Result<String, ExportError> {
    model.check()?;
    let weights = multiply_adds(&model.mlp);
    if weights > MOST_WEIGHTS {
        return Err(ExportError::Refused(format!(
            "the network has {} weights, and compilers of shaders take minutes for more than {}; train one with smaller --hidden",
            thousands(weights as u64),
            thousands(MOST_WEIGHTS as u64)
        )));
    }
    let mut parts: Vec<String> = Vec::new();
    if precision == Precision::F16 {
        parts.push(ENABLE_HALVES.into());
    }
    for module in modules(model.meta.recipe) {
        parts.push(peelnet_render::shaders::source(module)?.into());
    }
    parts.extend([call(model), weight_function(model, precision)]);
    Ok(parts.join("\n"))
}

/// The shader modules that surround a network.
fn modules(recipe: Recipe) -> Vec<&'static str> {
    let mut modules = recipe.inputs.surroundings().modules.to_vec();
    for about in recipe.inputs.features() {
        let module = about.shared.and_then(|shared| shared.module);
        modules.extend(module.filter(|module| !modules.contains(module)));
    }
    modules
}
