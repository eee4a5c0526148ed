//! The text: a header, what surrounds the network, and the network.

use crate::{
    ExportError, Options, Precision,
    description::layout,
    header::header,
    network::{call, weight_function},
};
use peelnet_core::mlp::Mlp;
use peelnet_model::{Inputs, Model, Output, Recipe};

/// The directive that a text in 16 bits begins with, behind its header.
const ENABLE_HALVES: &str = "enable f16;\n";

/// Whether a WGSL text computes in 16 bits.
pub(crate) fn has_halves(wgsl: &str) -> bool {
    wgsl.lines().any(|line| line == ENABLE_HALVES.trim_end())
}

/// Multiply–adds of one evaluation of the network, as published costs count them (padding not included).
pub fn multiply_adds(mlp: &Mlp) -> usize {
    mlp.layers.iter().map(|l| l.inputs * l.outputs).sum()
}

/// The self-contained text of a model: a header, depth, statistics, the weight of a fragment and the resolve, and the network.
///
/// The same model gives the same bytes.
///
/// # Errors
/// A model that does not hold together, or whose output has no shader function.
pub fn text(model: &Model, options: &Options) -> Result<String, ExportError> {
    let dialect = options.language.dialect();
    if options.precision == Precision::F16 && !dialect.has_halves() {
        return Err(ExportError::NoHalves(dialect.name()));
    }
    Ok(header(model, options) + &dialect.translate(&code(model, options.precision)?)?)
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
    let mut text = String::new();
    if precision == Precision::F16 {
        text.push_str(ENABLE_HALVES);
        text.push('\n');
    }
    for module in modules(model.meta.recipe) {
        text.push_str(peelnet_shaders::source(module)?);
        text.push('\n');
    }
    text.push_str(&call(model));
    text.push('\n');
    text.push_str(&weight_function(model, precision));
    Ok(text)
}

/// The shader modules that surround a network.
fn modules(recipe: Recipe) -> Vec<&'static str> {
    let mut modules = match (recipe.inputs, recipe.output) {
        (Inputs::Row(_), _) => vec!["learned::thesis", "learned::composite"],
        (Inputs::Moments(_), _) => vec![
            "learned::zeta",
            "learned::absorbance",
            "learned::nmt",
            "learned::resolve",
            "learned::composite",
        ],
        (Inputs::Layers(_), _) => vec!["learned::dfaoit"],
        (Inputs::Rest(_), output) => {
            let mut modules = vec![
                "learned::zeta",
                "learned::absorbance",
                "learned::levels",
                "learned::anchored",
                "learned::anchored_fragment",
            ];
            modules.extend(match output {
                Output::AnchoredShareSeparateEnds => &["learned::resolve_separate_ends"][..],
                _ => &["learned::resolve", "learned::composite"],
            });
            modules
        }
        (Inputs::Slabs(design, _), _) => peelnet_shaders::slab_modules(layout(&design).name()),
    };
    for about in recipe.inputs.about() {
        let module = about.shared.and_then(|shared| shared.module);
        modules.extend(module.filter(|module| !modules.contains(module)));
    }
    modules
}
