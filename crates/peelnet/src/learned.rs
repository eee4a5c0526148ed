//! The text that a learned method draws with.

use crate::console::Console;
use crate::failure::Failure;
use crate::parse::shown;
use peelnet_gpu::Gpu;
use peelnet_model::{Model, Recipe};
use peelnet_render::{LearnedWeight, MethodSpec};
use std::path::Path;

/// Says which network draws: the shipped one or that of a file, and its hash.
///
/// # Errors
/// If the model cannot be hashed, because it does not hold together.
pub fn about(model: &Model, file: Option<&Path>) -> Result<String, Failure> {
    let hash = model.hash()?;
    let hash = hash.get(..12).unwrap_or(&hash);
    let from = file.map_or_else(|| "the shipped network".to_owned(), shown);
    Ok(format!("{}: {from}, {hash}", model.meta.recipe.method))
}

/// Loads the model of a method (the shipped one where none is named), exports it and verifies the export. `None` for
/// a method that needs no model. Says which it is.
///
/// # Errors
/// A model for a method that has none, a model of another recipe, or an export that does not agree with the model.
pub fn weight_of(
    console: Console,
    gpu: &Gpu,
    method: &MethodSpec,
    model: Option<&Path>,
) -> Result<Option<LearnedWeight>, Failure> {
    if !method.needs_model() {
        return match model {
            None => Ok(None),
            Some(path) => Err(Failure::Usage(format!(
                "--model {}: method {} draws without a network; leave --model out, or choose a learned method with --method",
                shown(path),
                method.name()
            ))),
        };
    }
    let recipe = Recipe::of_method(method.name())
        .ok_or_else(|| Failure::Failed(format!("method {} belongs to no recipe", method.name())))?;
    let Some(path) = model else {
        let model = Model::shipped(recipe)?;
        console.message(about(&model, None)?);
        return text_of(gpu, &model).map(Some);
    };
    let model = peelnet::load_model(path)?;
    if model.meta.recipe != recipe {
        return Err(Failure::Usage(format!(
            "{}: the model's recipe is {}, but method {} draws with recipe {recipe}; use --method {}",
            shown(path),
            model.meta.recipe,
            method.name(),
            model.meta.recipe.method
        )));
    }
    console.message(about(&model, Some(path))?);
    text_of(gpu, &model).map(Some)
}

/// The text of a model: of a shipped one the text that ships with it, else an export that is verified on the GPU.
///
/// # Errors
/// A model that cannot be exported, or a text that does not agree with it.
pub fn text_of(gpu: &Gpu, model: &Model) -> Result<LearnedWeight, Failure> {
    if Model::shipped(model.meta.recipe).is_ok_and(|shipped| shipped == *model)
        && let Ok(method) = model.meta.recipe.method.parse()
        && let Some(shipped) = LearnedWeight::shipped(&method)
    {
        return Ok(shipped);
    }
    let wgsl = peelnet_export::wgsl(model)?;
    peelnet_export::verify(gpu, model, &wgsl)?;
    Ok(LearnedWeight {
        recipe: model.meta.recipe,
        wgsl,
    })
}
