//! The text that a learned method draws with.

use crate::failure::Failure;
use peelnet_gpu::Gpu;
use peelnet_model::{Model, Recipe};
use peelnet_render::{LearnedWeight, MethodSpec};
use std::path::Path;

/// Loads the model of a method (the shipped one where none is named), exports it and verifies the export. `None` for
/// a method that needs no model.
///
/// # Errors
/// A model for a method that has none, a model of another recipe, or an export that does not agree with the model.
pub fn weight_of(
    gpu: &Gpu,
    method: &MethodSpec,
    model: Option<&Path>,
) -> Result<Option<LearnedWeight>, Failure> {
    if !method.needs_model() {
        return match model {
            None => Ok(None),
            Some(path) => Err(Failure::Usage(format!(
                "--model {}: method {} draws without a network; leave --model out, or choose a learned method with --method",
                path.display(),
                method.name()
            ))),
        };
    }
    let recipe = Recipe::of_method(method.name())
        .ok_or_else(|| Failure::Failed(format!("method {} belongs to no recipe", method.name())))?;
    let Some(path) = model else {
        return text_of(gpu, &Model::shipped(recipe)?).map(Some);
    };
    let model = Model::load(path)?;
    if model.meta.recipe != recipe {
        return Err(Failure::Usage(format!(
            "{}: the model's recipe is {}, but method {} draws with recipe {recipe}; use --method {}",
            path.display(),
            model.meta.recipe,
            method.name(),
            model.meta.recipe.method
        )));
    }
    text_of(gpu, &model).map(Some)
}

/// Exports a model and verifies the text on the GPU.
///
/// # Errors
/// A model that cannot be exported, or a text that does not agree with it.
pub fn text_of(gpu: &Gpu, model: &Model) -> Result<LearnedWeight, Failure> {
    let wgsl = peelnet_export::wgsl(model, &peelnet_export::Options::default())?;
    peelnet_export::verify(gpu, model, &wgsl)?;
    Ok(LearnedWeight {
        recipe: model.meta.recipe,
        wgsl,
    })
}
