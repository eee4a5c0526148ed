//! Models: their files, their weights, and shader text made of them.

use crate::{
    argument::{FromFile, load},
    failure::{raised, wrong},
    gpu, json,
    watch::{Reporter, watch},
};
use numpy::{
    IntoPyArray as _, PyArray2, PyArrayMethods as _, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods as _,
};
use peelnet::{
    LANGUAGES, PRECISIONS,
    dataset::is_remote,
    export::{Language, Options},
    named,
};
use peelnet_core::files::Outputs;
use peelnet_core::mlp::{Layer, Mlp};
use pyo3::{
    prelude::*,
    types::{PyBytes, PyDict, PyType},
};
use std::path::PathBuf;

/// What reads no file.
pub const NO_INPUTS: [&str; 0] = [];

/// A trained network with everything that is needed to use it.
#[pyclass(frozen, module = "peelnet", eq)]
#[derive(Clone, PartialEq)]
pub struct Model(pub peelnet::Model);

#[pymethods]
impl Model {
    /// Loads a model file (safetensors).
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        peelnet::load_model(path).map(Self).map_err(raised)
    }

    /// The network that ships for a recipe: "thesis", "small", "medium", "large", "anchored-small", "anchored-medium", "nmt" or "dfaoit".
    #[staticmethod]
    fn shipped(recipe: &str) -> PyResult<Self> {
        let recipe = recipe.parse().map_err(|e: String| wrong(e))?;
        peelnet::Model::shipped(recipe).map(Self).map_err(raised)
    }

    /// Reads a model from a file's bytes.
    #[staticmethod]
    fn from_bytes(data: &[u8]) -> PyResult<Self> {
        let model = peelnet::Model::from_bytes(data, "the bytes of a model");
        model.map(Self).map_err(raised)
    }

    /// A model with the weights of a torch `state_dict` (or of any mapping from names to arrays).
    ///
    /// Args:
    ///     state: "layers.0.weight" of shape (outputs, inputs), "layers.0.bias" of shape (outputs,), …; the names of `weights()`.
    ///     like: The Model whose inputs, normalisation and activations it gets. Hidden layers may have other widths.
    ///
    /// Other weights than `like` has make the losses unknown: they are removed.
    #[classmethod]
    #[pyo3(signature = (state, *, like))]
    fn from_state_dict(
        _class: &Bound<'_, PyType>,
        state: &Bound<'_, PyAny>,
        like: &Bound<'_, Model>,
    ) -> PyResult<Self> {
        let convert = state.py().import("peelnet._convert")?;
        let layers = convert.call_method1("layers", (state,))?;
        let layers: Vec<(PyReadonlyArray2<'_, f32>, PyReadonlyArray1<'_, f32>)> =
            layers.extract()?;
        let layers = layers.iter().map(|(weights, bias)| Layer {
            inputs: weights.shape()[1],
            outputs: weights.shape()[0],
            weights: weights.as_array().iter().copied().collect(),
            bias: bias.as_array().to_vec(),
        });
        let mut model = like.get().0.clone();
        let Mlp { hidden, output, .. } = model.mlp;
        let mlp = Mlp::new(layers.collect(), hidden, output).map_err(|e| wrong(e.to_string()))?;
        if mlp != model.mlp {
            model.mlp = mlp;
            model.meta.losses = peelnet::model::Losses::default();
            model.meta.held_out.clear();
        }
        model.check().map_err(|e| wrong(e.to_string()))?;
        Ok(Self(model))
    }

    /// Writes the model file, whole or not at all. Another file than a model is replaced only with `force`, an object at `s3://…` never.
    #[pyo3(signature = (path, *, force=false))]
    fn save(&self, path: PathBuf, force: bool) -> PyResult<()> {
        let mut outputs = Outputs::new(("force=True", force), NO_INPUTS);
        if !is_remote(&path) {
            let kind = peelnet::model::KIND;
            outputs.file("path", &path, kind).map_err(raised)?;
        }
        peelnet::save_model(&self.0, path).map_err(raised)
    }

    /// The bytes of the model's file: the same for the same model.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.0.to_bytes().map_err(raised)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Weights by torch's names, float32: "layers.0.weight" of shape (outputs, inputs), "layers.0.bias" of shape (outputs,), ….
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let weights = PyDict::new(py);
        for (i, layer) in self.0.mlp.layers.iter().enumerate() {
            let matrix = layer.weights.clone().into_pyarray(py);
            let matrix = matrix.reshape([layer.outputs, layer.inputs])?;
            weights.set_item(format!("layers.{i}.weight"), matrix)?;
            let bias = layer.bias.clone().into_pyarray(py);
            weights.set_item(format!("layers.{i}.bias"), bias)?;
        }
        Ok(weights)
    }

    /// `weights()` as torch tensors; needs torch.
    fn state_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let weights = self.weights(py)?;
        let convert = py.import("peelnet._convert")?;
        convert.call_method1("state_dict", (weights,))
    }

    /// The network's answers.
    ///
    /// Args:
    ///     inputs: float32 of shape (n, inputs), raw features in scene units, in the order of `inputs`.
    ///
    /// Returns:
    ///     float32 of shape (n, outputs), normalised and guarded as the exported shader does it.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        inputs: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let [rows, columns] = [inputs.shape()[0], inputs.shape()[1]];
        if columns != self.0.meta.inputs.len() {
            return Err(wrong(format!(
                "the model has {} inputs, the array has {columns} columns",
                self.0.meta.inputs.len()
            )));
        }
        let inputs = inputs.as_array().to_owned();
        let answers = py.detach(|| {
            let mut answers = Vec::with_capacity(rows * self.0.mlp.outputs());
            for row in inputs.rows() {
                answers.extend(self.0.forward_raw(&row.to_vec()));
            }
            answers
        });
        let answers = answers.into_pyarray(py);
        answers.reshape([rows, self.0.mlp.outputs()])
    }

    /// How the network is built: the recipe's name.
    #[getter]
    fn recipe(&self) -> &'static str {
        self.0.meta.recipe.name
    }

    /// The method of `render` that draws with it.
    #[getter]
    fn method(&self) -> &'static str {
        self.0.meta.recipe.method
    }

    /// Widths of the layers, such as "9-13-1".
    #[getter]
    fn topology(&self) -> String {
        self.0.mlp.topology()
    }

    /// Number of weights and biases.
    #[getter]
    fn parameters(&self) -> usize {
        self.0.mlp.parameters()
    }

    /// Names of the inputs, in order.
    #[getter]
    fn inputs(&self) -> Vec<String> {
        self.0.meta.inputs.iter().map(|i| i.name.clone()).collect()
    }

    /// SHA-256 of the model's file, hexadecimal.
    #[getter]
    fn hash(&self) -> PyResult<String> {
        self.0.hash().map_err(raised)
    }

    /// The file's metadata: recipe, inputs with their units and normalisation, dataset, losses, configuration.
    #[getter]
    fn meta<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0.meta)
    }

    fn __getstate__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.to_bytes(py)
    }

    /// For pickle, and so for Ray.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let from_bytes = py.get_type::<Self>().getattr("from_bytes")?;
        Ok((from_bytes, (self.to_bytes(py)?,)))
    }

    fn __repr__(&self) -> String {
        let Self(m) = self;
        format!(
            "Model({}, {}, {} parameters)",
            m.meta.recipe,
            m.mlp.topology(),
            m.mlp.parameters()
        )
    }
}

impl FromFile for Model {
    const IS: &str = "a model is a Model or the path of its file";

    fn from_file(_: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::load(path)
    }
}

/// Writes a network as the text of a shader function.
///
/// Args:
///     model: A Model, or the path of its file.
///     language: "wgsl", "glsl-es", "glsl", "hlsl" or "msl".
///     precision: "f32" or "f16", the arithmetic of the network's layers.
///     verify: Runs the function on the GPU and compares it with the network first, as the command does.
///     adapter: The GPU that verifies: "auto", "software", or a part of an adapter's name.
///
/// Returns:
///     The text. Its first lines say what a renderer does around it.
#[pyfunction]
#[pyo3(signature = (model, language="wgsl", *, precision="f32", verify=true, adapter="auto"))]
pub fn export(
    py: Python<'_>,
    model: &Bound<'_, PyAny>,
    language: &str,
    precision: &str,
    verify: bool,
    adapter: &str,
) -> PyResult<String> {
    let language = named("language", LANGUAGES, language).map_err(wrong)?;
    let precision = named("precision", PRECISIONS, precision).map_err(wrong)?;
    let Model(model) = load(model)?;
    let options = Options {
        language,
        precision,
    };
    let text = peelnet::export::text(&model, &options).map_err(raised)?;
    if verify {
        let gpu = gpu::open(py, adapter)?;
        let in_wgsl = Options {
            language: Language::Wgsl,
            ..options
        };
        watch(
            py,
            |_, _: &Reporter<()>| {
                let wgsl = peelnet::export::text(&model, &in_wgsl)?;
                peelnet::export::verify(&gpu, &model, &wgsl)
            },
            |_, ()| Ok(()),
        )?;
    }
    Ok(text)
}
