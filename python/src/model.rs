//! Models: their files, their weights, and shader text made of them.

use crate::{
    failure::{failed, raised, wrong},
    gpu, json,
    watch::{Reporter, watch},
};
use numpy::{
    IntoPyArray as _, PyArray2, PyReadonlyArray2, PyReadonlyArrayDyn, PyUntypedArrayMethods as _,
    ndarray::{Array1, Array2},
};
use peelnet::{
    dataset::is_remote,
    export::{Language, Options, Precision},
};
use peelnet_core::mlp::{Layer, Mlp};
use peelnet_files::{Kind, Standing, shown};
use pyo3::{
    exceptions::PyTypeError,
    prelude::*,
    types::{PyBytes, PyDict, PyType},
};
use std::path::{Path, PathBuf};

/// Refuses to replace a file that peelnet did not write.
///
/// # Errors
/// Such a file, or a place that cannot be written.
pub fn may_write(path: &Path, kind: Kind, force: bool) -> PyResult<()> {
    let standing = kind
        .standing(path)
        .map_err(|e| failed(format!("{}: cannot be written: {e}", shown(path))))?;
    if standing == Standing::Foreign && !force {
        return Err(failed(format!(
            "{}: the file there is not {}; choose another name, or replace it with force=True",
            shown(path),
            kind.name
        )));
    }
    Ok(())
}

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

    /// The network that ships for a recipe: "thesis", "small", "medium", "large", "nmt" or "dfaoit".
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
        let mut layers = Vec::new();
        let mut named = 0;
        while state.contains(format!("layers.{}.weight", layers.len()))? {
            layers.push(layer(state, layers.len())?);
            named += 2;
        }
        if state.len()? != named {
            let keys: Vec<String> = state
                .call_method0("keys")?
                .try_iter()?
                .map(|k| k?.extract())
                .collect::<PyResult<_>>()?;
            return Err(wrong(format!(
                "a state dict of a model holds layers.0.weight, layers.0.bias, layers.1.weight, … and nothing else; this one holds {}",
                keys.join(", ")
            )));
        }
        let mut model = like.get().0.clone();
        let Mlp { hidden, output, .. } = model.mlp;
        let mlp = Mlp::new(layers, hidden, output).map_err(|e| wrong(e.to_string()))?;
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
        if !is_remote(&path) {
            may_write(&path, peelnet::model::KIND, force)?;
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
            let shape = (layer.outputs, layer.inputs);
            let matrix = Array2::from_shape_vec(shape, layer.weights.clone());
            let matrix = matrix.map_err(|e| failed(e.to_string()))?;
            weights.set_item(format!("layers.{i}.weight"), matrix.into_pyarray(py))?;
            let bias = Array1::from(layer.bias.clone());
            weights.set_item(format!("layers.{i}.bias"), bias.into_pyarray(py))?;
        }
        Ok(weights)
    }

    /// `weights()` as torch tensors; needs torch.
    fn state_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let from_numpy = py.import("torch")?.getattr("from_numpy")?;
        let state = PyDict::new(py);
        for (name, array) in self.weights(py)? {
            state.set_item(name, from_numpy.call1((array,))?)?;
        }
        Ok(state)
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
        let answers = Array2::from_shape_vec((rows, self.0.mlp.outputs()), answers);
        Ok(answers.map_err(|e| failed(e.to_string()))?.into_pyarray(py))
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

/// A layer of a state dict.
fn layer(state: &Bound<'_, PyAny>, index: usize) -> PyResult<Layer> {
    let py = state.py();
    let asarray = py.import("numpy")?.getattr("asarray")?;
    let float32 = PyDict::new(py);
    float32.set_item("dtype", "float32")?;
    let array = |part: &str, axes: usize| -> PyResult<(Vec<usize>, Vec<f32>)> {
        let name = format!("layers.{index}.{part}");
        let mut value = state.get_item(&name)?;
        if value.hasattr("detach")? {
            value = value.call_method0("detach")?.call_method0("cpu")?;
        }
        let array = asarray.call((value,), Some(&float32))?;
        let array: PyReadonlyArrayDyn<'_, f32> = array.extract()?;
        if array.shape().len() != axes {
            return Err(wrong(format!(
                "{name} has {} axes instead of {axes}",
                array.shape().len()
            )));
        }
        Ok((
            array.shape().to_vec(),
            array.as_array().iter().copied().collect(),
        ))
    };
    let (shape, weights) = array("weight", 2)?;
    let (_, bias) = array("bias", 1)?;
    Ok(Layer {
        inputs: shape[1],
        outputs: shape[0],
        weights,
        bias,
    })
}

/// A model, or its file.
pub enum ModelArg {
    Loaded(Box<peelnet::Model>),
    Path(PathBuf),
}

impl<'a, 'py> FromPyObject<'a, 'py> for ModelArg {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(model) = object.cast::<Model>() {
            return Ok(Self::Loaded(Box::new(model.get().0.clone())));
        }
        let path = object.extract::<PathBuf>();
        path.map(Self::Path)
            .map_err(|_| PyTypeError::new_err("a model is a Model or the path of its file"))
    }
}

impl ModelArg {
    /// The model.
    ///
    /// # Errors
    /// A file that does not load.
    pub fn load(self) -> PyResult<peelnet::Model> {
        match self {
            Self::Loaded(model) => Ok(*model),
            Self::Path(path) => peelnet::load_model(path).map_err(raised),
        }
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
    model: ModelArg,
    language: &str,
    precision: &str,
    verify: bool,
    adapter: &str,
) -> PyResult<String> {
    let language = match language {
        "wgsl" => Language::Wgsl,
        "glsl-es" => Language::GlslEs,
        "glsl" => Language::Glsl,
        "hlsl" => Language::Hlsl,
        "msl" => Language::Msl,
        other => {
            return Err(wrong(format!(
                "language '{other}': there are wgsl, glsl-es, glsl, hlsl, msl"
            )));
        }
    };
    let precision = match precision {
        "f32" => Precision::F32,
        "f16" => Precision::F16,
        other => return Err(wrong(format!("precision '{other}': there are f32, f16"))),
    };
    let model = model.load()?;
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
                peelnet::export::verify(&gpu, &model, &wgsl).map(|_| ())
            },
            |_, ()| Ok(()),
        )?
        .map_err(raised)?;
    }
    Ok(text)
}
