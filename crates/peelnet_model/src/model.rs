//! A network and its metadata, and how it answers.

use std::path::Path;

use peelnet_core::mlp::{Layer, Mlp};
use sha2::{Digest, Sha256};

use crate::error::{ModelError, Problem};
use crate::file::{self, MAX_BYTES};
use crate::metadata::Metadata;
use crate::recipe::Recipe;

/// A trained network that knows its features.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The network; its inputs are normalised.
    pub mlp: Mlp,
    /// Everything else.
    pub meta: Metadata,
}

impl Model {
    /// Loads a model file.
    ///
    /// # Errors
    /// If the file cannot be read, is not a peelnet model, or [`Model::check`] refuses what it holds.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ModelError> {
        let path = path.as_ref();
        let bytes = peelnet_files::read(path, MAX_BYTES).map_err(|source| ModelError::Io {
            path: path.to_owned(),
            action: "read the model",
            source,
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
        let shipped = peelnet_models::find(name).ok_or(ModelError::NotShipped(recipe))?;
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
        peelnet_files::write_whole(path, &bytes).map_err(|source| ModelError::Io {
            path: path.to_owned(),
            action: "write the model",
            source,
        })
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
        Ok(peelnet_files::hex(&Sha256::digest(self.to_bytes()?)))
    }

    /// Whether the model can be used: its layers fit one another, the metadata and the recipe, and all numbers are
    /// finite.
    ///
    /// # Errors
    /// The first [`Problem`] found.
    pub fn check(&self) -> Result<(), Problem> {
        self.meta.check()?;
        // The fields are public: what `Mlp::new` checked once may have changed.
        Mlp::new(self.mlp.layers.clone(), self.mlp.hidden, self.mlp.output)?;
        for (i, layer) in self.mlp.layers.iter().enumerate() {
            let Layer { weights, bias, .. } = layer;
            for (part, values) in [("weight", weights), ("bias", bias)] {
                if let Some(index) = values.iter().position(|v| !v.is_finite()) {
                    return Err(Problem::NotFinite {
                        name: format!("layers.{i}.{part}"),
                        index,
                        value: values[index].to_string(),
                    });
                }
            }
        }
        if self.mlp.inputs() != self.meta.inputs.len() {
            return Err(Problem::InputCount {
                network: self.mlp.inputs(),
                listed: self.meta.inputs.len(),
            });
        }
        if self.mlp.outputs() != self.meta.output.count() {
            return Err(Problem::OutputCount {
                network: self.mlp.outputs(),
                output: self.meta.output,
                expected: self.meta.output.count(),
            });
        }
        Ok(())
    }

    /// The prediction for raw features in scene units: normalises, runs the network, guards the outputs.
    ///
    /// # Panics
    /// If the number of features is not that of the model's inputs.
    pub fn forward_raw(&self, raw_inputs: &[f32]) -> Vec<f32> {
        assert_eq!(raw_inputs.len(), self.meta.inputs.len(), "model inputs");
        let inputs = self.meta.inputs.iter().zip(raw_inputs);
        let normalised: Vec<f32> = inputs.map(|(i, &raw)| i.normalise(raw)).collect();
        let outputs = self.mlp.forward(&normalised).into_iter();
        outputs.map(|value| self.meta.output.guard(value)).collect()
    }

    /// As [`Model::forward_raw`], in 64 bits: what every other evaluation is compared with.
    ///
    /// # Panics
    /// If the number of features is not that of the model's inputs.
    pub fn forward_raw_f64(&self, raw_inputs: &[f64]) -> Vec<f64> {
        assert_eq!(raw_inputs.len(), self.meta.inputs.len(), "model inputs");
        let inputs = self.meta.inputs.iter().zip(raw_inputs);
        let normalised: Vec<f64> = inputs.map(|(i, &raw)| i.normalise_f64(raw)).collect();
        let outputs = self.mlp.forward(&normalised).into_iter();
        outputs
            .map(|value| self.meta.output.guard_f64(value))
            .collect()
    }

    /// What the exported function answers: [`Model::forward_raw`], made a transmittance where the network predicts a share
    /// ([`Output::transmittance`](crate::Output::transmittance)).
    ///
    /// # Panics
    /// If the number of features is not that of the model's inputs.
    pub fn shader_output(&self, raw_inputs: &[f32]) -> Vec<f32> {
        let mut outputs = self.forward_raw(raw_inputs);
        let output = self.meta.output;
        if output.is_share() {
            let raw: Vec<f64> = raw_inputs.iter().map(|&x| x.into()).collect();
            for share in &mut outputs {
                *share = output.transmittance(&raw, (*share).into()) as f32;
            }
        }
        outputs
    }

    /// As [`Model::shader_output`], in 64 bits.
    ///
    /// # Panics
    /// If the number of features is not that of the model's inputs.
    pub fn shader_output_f64(&self, raw_inputs: &[f64]) -> Vec<f64> {
        let mut outputs = self.forward_raw_f64(raw_inputs);
        let output = self.meta.output;
        if output.is_share() {
            for share in &mut outputs {
                *share = output.transmittance(raw_inputs, *share);
            }
        }
        outputs
    }
}
