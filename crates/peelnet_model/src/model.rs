//! A network and its metadata, and how it answers.

use std::io::ErrorKind;
use std::{iter::Sum, path::Path};

use num_traits::{Float, cast};
use peelnet_core::{
    absorbance::DepthWarp,
    fragment::Fragment,
    mlp::{Layer, Mlp},
};
use sha2::{Digest, Sha256};

use crate::error::{ModelError, Problem};
use crate::file::{self, MAX_BYTES};
use crate::inputs::{Feature, Observed, values};
use crate::metadata::{LARGEST, Metadata};
use crate::recipe::Recipe;

/// A trained network that knows its features.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The network; its inputs are normalised.
    pub mlp: Mlp,
    /// Everything else.
    pub meta: Metadata,
}

/// Hidden layers of a network, at most: compilers of shaders take a time that grows with the square of them.
pub const MAX_HIDDEN_LAYERS: usize = 16;

impl Model {
    /// Loads a model file.
    ///
    /// # Errors
    /// If the file cannot be read, is not a peelnet model, or [`Model::check`] refuses what it holds.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ModelError> {
        let path = path.as_ref();
        let bytes = peelnet_core::files::read(path, MAX_BYTES);
        let bytes = bytes.map_err(|e| {
            let what = match e.kind() {
                ErrorKind::IsADirectory => "is a folder, and a network is a file",
                ErrorKind::NotFound => "there is no such file",
                _ => return ModelError::io(path, "read the model")(e),
            };
            let fix = "name a file that `peelnet train` wrote";
            ModelError::invalid(path)(Problem(format!("{what}; {fix}")))
        })?;
        Self::from_bytes(&bytes, path)
    }

    /// The network that ships for a recipe.
    ///
    /// ```
    /// use peelnet_model::{Model, Recipe};
    ///
    /// let medium = Model::shipped(Recipe::MEDIUM)?;
    /// assert_eq!(medium.mlp.topology(), "9-13-1");
    /// # Ok::<(), peelnet_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::NotShipped`] for a recipe that was added but not yet trained for a release.
    pub fn shipped(recipe: Recipe) -> Result<Self, ModelError> {
        let name = recipe.name;
        let shipped = peelnet_shipped_networks::find(name).ok_or(ModelError::NotShipped(recipe))?;
        Self::from_bytes(shipped.file, format!("models/{name}/model.safetensors"))
    }

    /// Reads a model from the bytes of a file; `path` only serves messages.
    ///
    /// # Errors
    /// As [`Model::load`].
    pub fn from_bytes(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self, ModelError> {
        file::decode(bytes).map_err(ModelError::invalid(path.as_ref()))
    }

    /// Writes the model to a file, which holds the whole model afterwards or is as it was before.
    ///
    /// # Errors
    /// If [`Model::check`] refuses the model or the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), ModelError> {
        let path = path.as_ref();
        let bytes = self.to_bytes().map_err(ModelError::invalid(path))?;
        peelnet_core::files::write_whole(path, &bytes)
            .map_err(ModelError::io(path, "write the model"))
    }

    /// The bytes of the model's file: the same for the same model.
    ///
    /// # Errors
    /// If [`Model::check`] refuses the model.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Problem> {
        file::encode(self)
    }

    /// Hexadecimal sha256 of the model's file.
    ///
    /// # Errors
    /// If [`Model::check`] refuses the model.
    pub fn hash(&self) -> Result<String, Problem> {
        Ok(peelnet_core::files::hex(&Sha256::digest(self.to_bytes()?)))
    }

    /// Whether the model can be used: its layers fit one another, the metadata and the recipe, and all numbers are
    /// finite and of a size that shaders can hold.
    ///
    /// # Errors
    /// The first [`Problem`] found.
    pub fn check(&self) -> Result<(), Problem> {
        self.meta.check()?;
        // The fields are public: what `Mlp::new` checked once may have changed.
        let Mlp { hidden, output, .. } = self.mlp;
        let layers = self.mlp.layers.len();
        if layers > MAX_HIDDEN_LAYERS + 1 {
            return Err(Problem(format!(
                "the network has {layers} layers, and at most {} are read",
                MAX_HIDDEN_LAYERS + 1
            )));
        }
        Mlp::new(self.mlp.layers.clone(), hidden, output).map_err(Problem::shapes)?;
        for (i, layer) in self.mlp.layers.iter().enumerate() {
            let Layer { weights, bias, .. } = layer;
            for (part, values) in [("weight", weights), ("bias", bias)] {
                let is_small = |v: &f32| v.abs() <= LARGEST;
                if let Some(index) = values.iter().position(|v| !is_small(v)) {
                    let (name, value) = (format!("layers.{i}.{part}"), values[index]);
                    return Err(Problem(format!(
                        "tensor {name:?}: value {index} is {value}, all weights must be from -1e12 to 1e12; the training diverged, train again with a lower rate"
                    )));
                }
            }
        }
        let (network, listed) = (self.mlp.inputs(), self.meta.inputs.len());
        if network != listed {
            return Err(Problem(format!(
                "the network takes {network} inputs but the metadata lists {listed}"
            )));
        }
        let (network, output) = (self.mlp.outputs(), self.meta.output);
        if network != output.count() {
            let count = output.count();
            return Err(Problem(format!(
                "the network gives {network} outputs where {output} has {count}"
            )));
        }
        Ok(())
    }

    /// The prediction for raw features in scene units: normalises, runs the network, guards the outputs. In 32 bits, or in 64: what every
    /// other evaluation is compared with.
    ///
    /// # Panics
    /// If the number of features is not that of the model's inputs.
    pub fn forward_raw<F: Float + From<f32> + Sum>(&self, raw_inputs: &[F]) -> Vec<F> {
        assert_eq!(raw_inputs.len(), self.meta.inputs.len(), "model inputs");
        let inputs = self.meta.inputs.iter().zip(raw_inputs);
        let normalised: Vec<F> = inputs.map(|(i, &raw)| i.normalise(raw)).collect();
        let outputs = self.mlp.forward(&normalised).into_iter();
        outputs.map(|value| self.meta.output.guard(value)).collect()
    }

    /// What the exported function answers: [`Model::forward_raw`], made a transmittance where the network predicts a share
    /// ([`Output::transmittance`](crate::Output::transmittance)).
    ///
    /// # Panics
    /// If the number of features is not that of the model's inputs.
    pub fn shader_output<F: Float + From<f32> + Sum>(&self, raw_inputs: &[F]) -> Vec<F> {
        let mut outputs = self.forward_raw(raw_inputs);
        let output = self.meta.output;
        if output.is_fraction() {
            let wide = |x: F| x.to_f64().unwrap_or(f64::NAN);
            let raw: Vec<f64> = raw_inputs.iter().map(|&x| wide(x)).collect();
            for fraction in &mut outputs {
                let t = output.transmittance(&raw, wide(*fraction));
                *fraction = cast(t).unwrap_or_else(F::nan);
            }
        }
        outputs
    }

    /// The weight of every fragment of a pixel, an estimate of the transmittance in front of it, in 64 bits. Empty for a network that predicts
    /// none.
    pub fn transmittances(&self, pixel: &Observed<'_>) -> Vec<f64> {
        let inputs = self.meta.recipe.inputs;
        inputs.transmittances(pixel, &|raw| self.first(raw))
    }

    /// The first output for raw inputs, as the kind of inputs evaluates it.
    fn first(&self, raw: &[f64]) -> f64 {
        if self.meta.recipe.inputs.are_columns() {
            let raw: Vec<f32> = raw.iter().map(|&x| x as f32).collect();
            self.forward_raw(&raw)[0].into()
        } else {
            self.forward_raw(raw)[0]
        }
    }

    /// The colour of a pixel of which nothing is known of those around, where it is no weighted mean of its fragments' colours.
    pub fn color(
        &self,
        fragments: &[Fragment],
        background: [f32; 3],
        warp: &DepthWarp,
    ) -> Option<[f32; 3]> {
        let inputs = self.meta.recipe.inputs;
        inputs.color(fragments, background, warp, &|raw| self.first(raw))
    }

    /// The network's outputs for what is known of a fragment or a pixel.
    pub fn answers<C>(&self, features: &[&Feature<C>], known: &C) -> Vec<f64> {
        self.forward_raw(&values(features, known))
    }

    /// The first of [`Model::answers`].
    pub fn answer<C>(&self, features: &[&Feature<C>], known: &C) -> f64 {
        self.answers(features, known)[0]
    }
}
