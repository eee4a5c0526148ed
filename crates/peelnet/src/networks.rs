//! Networks: their files on this machine and in object stores, which one a method draws with, and the text that it draws with.

use crate::Failure;
use peelnet_bench::front::BASE;
use peelnet_core::files::check_outside_datasets;
use peelnet_dataset::{DatasetError, create_object, is_remote, read_object};
use peelnet_export::ExportError;
use peelnet_model::{MAX_BYTES, Model, ModelError, Recipe};
use peelnet_render::gpu::Gpu;
use peelnet_render::{LearnedWeight, MethodSpec};
use std::{
    io::{Error, ErrorKind},
    path::Path,
};

/// Loads a model file: a path, or an address such as `s3://bucket/prefix/model.safetensors`, as datasets have them.
///
/// # Errors
/// As [`Model::load`], or an object store that cannot be asked.
pub fn load_model(path: impl AsRef<Path>) -> Result<Model, ModelError> {
    let path = path.as_ref();
    if !is_remote(path) {
        return Model::load(path);
    }
    let action = "read the model";
    let bytes = read_object(path, MAX_BYTES).map_err(|e| remote(path, action, e))?;
    let bytes = bytes.ok_or_else(|| failed(path, action, ErrorKind::NotFound.into()))?;
    Model::from_bytes(&bytes, path)
}

/// Writes a model to a path, or to an address where there is nothing yet.
///
/// # Errors
/// As [`Model::save`]; an object store that cannot be asked; an object that is there already, unless it has the same bytes.
pub fn save_model(model: &Model, path: impl AsRef<Path>) -> Result<(), ModelError> {
    let path = path.as_ref();
    if !is_remote(path) {
        return model.save(path);
    }
    let bytes = model.to_bytes().map_err(|problem| ModelError::Invalid {
        path: path.to_owned(),
        problem,
    })?;
    let is_new = create_object(path, &bytes).map_err(|e| remote(path, WRITE, e))?;
    // A request whose answer was lost is sent again, and then finds its own bytes.
    if is_new || read_object(path, MAX_BYTES).is_ok_and(|there| there.is_some_and(|b| b == bytes)) {
        return Ok(());
    }
    Err(taken(path))
}

/// Refuses an address at which there is something: models there are never replaced. Paths are not looked at.
///
/// # Errors
/// An address that is none or is taken, or an object store that cannot be asked.
pub fn check_model_place(path: &Path) -> Result<(), ModelError> {
    if !is_remote(path) {
        return Ok(());
    }
    check_outside_datasets(path).map_err(|e| failed(path, WRITE, e))?;
    match read_object(path, MAX_BYTES) {
        Ok(None) => Ok(()),
        Ok(Some(_)) => Err(taken(path)),
        Err(e) => Err(remote(path, WRITE, e)),
    }
}

const WRITE: &str = "write the model";

fn taken(path: &Path) -> ModelError {
    let why = "there is another object, and none is replaced; choose another name";
    failed(path, WRITE, Error::new(ErrorKind::AlreadyExists, why))
}

fn remote(path: &Path, action: &'static str, error: DatasetError) -> ModelError {
    match error {
        DatasetError::Io { path, source, .. } => failed(&path, action, source),
        // Its path is without what could be a password.
        DatasetError::Invalid { path, reason } => failed(&path, action, Error::other(reason)),
        other => failed(path, action, Error::other(other)),
    }
}

fn failed(path: &Path, action: &'static str, source: Error) -> ModelError {
    let path = path.to_owned();
    ModelError::Io {
        path,
        action,
        source,
    }
}

/// The model that a method draws with: the one given, or the shipped one; none for a method that needs none.
///
/// # Errors
/// A model for a method that has none, or one of another recipe.
pub fn model_for(method: &MethodSpec, given: Option<Model>) -> Result<Option<Model>, Failure> {
    let name = method.name();
    if !method.needs_model() {
        return match given {
            None => Ok(None),
            Some(_) => Err(Failure::wrong(format!(
                "method {name} draws without a network; leave the model out, or choose a learned method"
            ))),
        };
    }
    let recipe = Recipe::for_method(name)
        .ok_or_else(|| Failure::failed(format!("method {name} belongs to no recipe")))?;
    let model = given.map_or_else(|| Model::shipped(recipe), Ok)?;
    if model.meta.recipe != recipe {
        return Err(Failure::wrong(format!(
            "the model's recipe is {}, but method {name} draws with recipe {recipe}; use method {}",
            model.meta.recipe, model.meta.recipe.method
        )));
    }
    Ok(Some(model))
}

/// The text of a model: of a shipped one the text that ships with it, else an export that is verified on the GPU.
///
/// # Errors
/// A model that cannot be exported, or a text that does not agree with it.
pub fn weight_of(gpu: &Gpu, model: &Model) -> Result<LearnedWeight, ExportError> {
    let recipe = model.meta.recipe;
    if Model::shipped(recipe).is_ok_and(|shipped| shipped == *model)
        && let Ok(method) = recipe.method.parse()
        && let Some(shipped) = LearnedWeight::shipped(&method)
    {
        return Ok(shipped);
    }
    let wgsl = peelnet_export::wgsl(model)?;
    peelnet_export::verify(gpu, model, &wgsl)?;
    Ok(LearnedWeight { recipe, wgsl })
}

/// The methods of a comparison, with the models of the learned ones among them.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The methods.
    pub methods: Vec<MethodSpec>,
    /// The models, those that were given first.
    pub models: Vec<Model>,
    /// Methods that are left out, because no model ships for them.
    pub left_out: Vec<&'static str>,
}

impl Compared {
    /// The methods named, or those of `every` beside these models, with the shipped models where none of a recipe is given.
    ///
    /// # Errors
    /// Two models of one recipe, or a method that was named and has no model.
    pub fn new(
        named: Option<Vec<MethodSpec>>,
        mut models: Vec<Model>,
        every: impl FnOnce(&[Model]) -> Vec<MethodSpec>,
    ) -> Result<Self, Failure> {
        for (k, model) in models.iter().enumerate() {
            let recipe = model.meta.recipe;
            if models[..k].iter().any(|m| m.meta.recipe == recipe) {
                return Err(Failure::wrong(format!(
                    "models: a second model of recipe {recipe}; one run compares one of each"
                )));
            }
        }
        let all = named.is_none();
        let mut methods = named.unwrap_or_else(|| every(&models));
        let mut left_out = Vec::new();
        for recipe in Recipe::ALL {
            let is_wanted = methods.iter().any(|m| m.name() == recipe.method);
            if !is_wanted || models.iter().any(|m| m.meta.recipe == recipe) {
                continue;
            }
            match Model::shipped(recipe) {
                Ok(model) => models.push(model),
                // Only what was named must be there.
                Err(ModelError::NotShipped(_)) if all => left_out.push(recipe.method),
                Err(e) => return Err(e.into()),
            }
        }
        methods.retain(|m| !left_out.contains(&m.name()));
        for name in models.iter().map(|m| m.meta.recipe.method) {
            if !methods.iter().any(|m| m.name() == name) {
                methods.push(name.parse()?);
            }
        }
        Ok(Self {
            methods,
            models,
            left_out,
        })
    }

    /// With the method that times are ratios to, where it is not among them.
    ///
    /// # Errors
    /// None: the name is a method's.
    pub fn with_base(mut self) -> Result<Self, Failure> {
        let base = BASE.parse()?;
        if !self.methods.contains(&base) {
            self.methods.push(base);
        }
        Ok(self)
    }

    /// The texts that the learned methods draw with.
    ///
    /// # Errors
    /// As [`weight_of`].
    pub fn weights(&self, gpu: &Gpu) -> Result<Vec<LearnedWeight>, ExportError> {
        self.models.iter().map(|m| weight_of(gpu, m)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_without_a_model_are_named_without_passwords() {
        let folder = tempfile::tempdir().unwrap();
        let none = format!("file://{}/none", folder.path().display());
        for (address, words) in [
            (none.as_str(), "cannot read the model"),
            ("s3://hunter2", "scheme://bucket/prefix/name"),
        ] {
            let error = load_model(address).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
            assert!(!error.contains("hunter2"), "{error}");
        }
    }

    #[test]
    fn a_comparison_has_one_model_of_each_recipe() {
        let small = Model::shipped(Recipe::SMALL).unwrap();
        let twice = Compared::new(None, vec![small.clone(); 2], |_| Vec::new());
        assert!(twice.unwrap_err().text.contains("one of each"));
        let named = vec!["mboit4".parse().unwrap(), "deep-large".parse().unwrap()];
        let found = Compared::new(Some(named), vec![small], |_| Vec::new()).unwrap();
        let methods: Vec<&str> = found.methods.iter().map(MethodSpec::name).collect();
        assert_eq!(methods, ["mboit4", "deep-large", Recipe::SMALL.method]);
        let recipes = found.models.iter().map(|m| m.meta.recipe);
        assert!(recipes.eq([Recipe::SMALL, Recipe::LARGE]));
    }
}
