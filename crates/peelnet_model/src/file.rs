//! The model as safetensors bytes, and files of them.

use std::{
    collections::{HashMap, HashSet},
    fmt,
};

use peelnet_core::files::{Kind, holds};
use peelnet_core::mlp::{Activation, Layer, Mlp};
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use serde::{Deserialize, Serialize};

use crate::error::Problem;
use crate::metadata::{Metadata, check_version};
use crate::model::Model;

/// Bytes of a model file that are read: the largest network that training makes has 16 MiB of weights.
pub const MAX_BYTES: u64 = 1 << 26;

/// The entry of the safetensors metadata that holds ours. It is the only one, because the format keeps its metadata
/// in no particular order and the bytes must not vary.
const KEY: &str = "peelnet";

/// By what a model file is known: a safetensors header, whose metadata has the entry that is ours.
pub const KIND: Kind = Kind {
    name: "a model",
    is: |head| {
        let json = head.get(8..).unwrap_or_default();
        let entry = format!("\"{KEY}\":");
        json.starts_with(b"{") && holds(json, entry.as_bytes())
    },
};

/// The metadata's JSON: [`Metadata`] with the network's activations beside it.
#[derive(Serialize)]
struct Stored<'a> {
    mlp: Activations,
    #[serde(flatten)]
    meta: &'a Metadata,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Activations {
    /// `3-10-8-1`: for readers; the tensors' shapes decide.
    topology: String,
    hidden: Activation,
    output: Activation,
}

pub(crate) fn encode(model: &Model) -> Result<Vec<u8>, Problem> {
    model.check()?;
    let stored = Stored {
        mlp: Activations {
            topology: model.mlp.topology(),
            hidden: model.mlp.hidden,
            output: model.mlp.output,
        },
        meta: &model.meta,
    };
    let json = serde_json::to_string(&stored).map_err(metadata)?;
    let mut tensors: Vec<(String, Vec<usize>, Vec<u8>)> = Vec::new();
    for (i, layer) in model.mlp.layers.iter().enumerate() {
        let shape = vec![layer.outputs, layer.inputs];
        tensors.push((weight(i), shape, to_bytes(&layer.weights)));
        tensors.push((bias(i), vec![layer.outputs], to_bytes(&layer.bias)));
    }
    let views = tensors.iter().map(|(name, shape, bytes)| {
        TensorView::new(Dtype::F32, shape.clone(), bytes).map(|view| (name.as_str(), view))
    });
    let views = views.collect::<Result<Vec<_>, _>>();
    let metadata = HashMap::from([(KEY.to_owned(), json)]);
    views
        .and_then(|views| safetensors::serialize(views, Some(metadata)))
        .map_err(broken)
}

fn broken(error: safetensors::SafeTensorError) -> Problem {
    Problem(format!(
        "not a readable safetensors file ({error}): it was cut off or is something else; name a file that `peelnet train` wrote, or copy it again"
    ))
}

fn metadata(error: impl fmt::Display) -> Problem {
    Problem(format!("metadata: {error}; train again with this version"))
}

/// A tensor that is missing, or belongs to no layer.
fn misnamed(name: &str, fault: &str) -> Problem {
    Problem(format!(
        "tensor {name:?} {fault}; the tensors must be layers.0.weight, layers.0.bias, layers.1.weight, …"
    ))
}

pub(crate) fn decode(bytes: &[u8]) -> Result<Model, Problem> {
    let (_, header) = SafeTensors::read_metadata(bytes).map_err(broken)?;
    let tensors = SafeTensors::deserialize(bytes).map_err(broken)?;
    let json = header.metadata().as_ref().and_then(|m| m.get(KEY));
    let json = json.ok_or_else(|| {
        let fault = "no `peelnet` entry in the metadata: the file is not a peelnet model";
        Problem(format!("{fault}; give one that `peelnet train` wrote"))
    })?;
    let (meta, Activations { hidden, output, .. }) = read_metadata(json)?;
    let mlp = Mlp::new(read_layers(&tensors)?, hidden, output).map_err(Problem::shapes)?;
    let model = Model { mlp, meta };
    model.check()?;
    Ok(model)
}

fn read_metadata(json: &str) -> Result<(Metadata, Activations), Problem> {
    let mut value: serde_json::Value = serde_json::from_str(json).map_err(metadata)?;
    let missing = |field| move || metadata(format!("missing field `{field}`"));
    // The version first: another version's fields are bound to look wrong.
    let version = value.get("format_version").and_then(|v| v.as_u64());
    check_version(version.ok_or_else(missing("format_version"))?)?;
    let activations = value.get_mut("mlp").map(serde_json::Value::take);
    let activations = activations.ok_or_else(missing("mlp"))?;
    let activations = serde_json::from_value(activations).map_err(metadata)?;
    let meta = serde_json::from_value(value).map_err(metadata)?;
    Ok((meta, activations))
}

fn read_layers(tensors: &SafeTensors<'_>) -> Result<Vec<Layer>, Problem> {
    let names = tensors.names();
    let number = |name: &&str| -> Option<usize> {
        let (number, _) = name.strip_prefix("layers.")?.split_once('.')?;
        number.parse().ok()
    };
    let last = names.iter().filter_map(number).max();
    // More layers than tensors means that some are missing; no need to look for all of them.
    let layers = last.map_or(0, |last| last.min(names.len()) + 1);
    let known: HashSet<String> = (0..layers).flat_map(|i| [weight(i), bias(i)]).collect();
    let is_unknown = |name: &&&str| !known.contains(**name);
    if let Some(unknown) = names.iter().filter(is_unknown).min() {
        return Err(misnamed(unknown, "belongs to no layer"));
    }
    if layers == 0 {
        return Err(misnamed(&weight(0), "is missing"));
    }
    let read = |i| {
        let (bias_name, weight_name) = (bias(i), weight(i));
        let (shape, weights) = read_tensor(tensors, &weight_name, 2)?;
        let (bias_shape, bias) = read_tensor(tensors, &bias_name, 1)?;
        let (outputs, inputs) = (shape[0], shape[1]);
        if bias_shape[0] != outputs {
            return Err(Problem(format!(
                "tensor {bias_name:?} is F32 {bias_shape:?}, expected F32 [{outputs}], one for each row of {weight_name}"
            )));
        }
        if outputs == 1 && i + 1 < layers {
            let reason = "has one row, and hidden layers have 2 at least";
            return Err(Problem(format!("tensor {weight_name:?} {reason}")));
        }
        Ok(Layer {
            outputs,
            inputs,
            weights,
            bias,
        })
    };
    (0..layers).map(read).collect()
}

/// Shape and values of a tensor with so many dimensions, none of which is 0.
fn read_tensor(
    tensors: &SafeTensors<'_>,
    name: &str,
    dimensions: usize,
) -> Result<(Vec<usize>, Vec<f32>), Problem> {
    let tensor = tensors.tensor(name);
    let tensor = tensor.map_err(|_| misnamed(name, "is missing"))?;
    let (kind, shape) = (tensor.dtype(), tensor.shape().to_vec());
    if kind != Dtype::F32 || shape.len() != dimensions || shape.contains(&0) {
        let expected = ["[outputs]", "[outputs, inputs]"][dimensions - 1];
        return Err(Problem(format!(
            "tensor {name:?} is {kind:?} {shape:?}, expected F32 {expected}"
        )));
    }
    let (words, _) = tensor.data().as_chunks();
    let values = words.iter().map(|&word| f32::from_le_bytes(word));
    Ok((shape, values.collect()))
}

fn weight(layer: usize) -> String {
    format!("layers.{layer}.weight")
}

fn bias(layer: usize) -> String {
    format!("layers.{layer}.bias")
}

fn to_bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}
