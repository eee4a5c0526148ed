//! Models survive their file, and every bad file gives one error that says what is wrong.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use std::collections::{BTreeMap, HashMap};

use peelnet_core::guards::WEIGHT_FLOOR;
use peelnet_core::mlp::{Activation, Layer, Mlp};
use peelnet_model::*;
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use serde_json::{Value, json};

/// The thesis's network with metadata of all kinds.
fn model() -> Model {
    let mut model = Model::shipped(Recipe::THESIS).unwrap();
    let meta = &mut model.meta;
    meta.seed = u64::MAX;
    meta.losses = Losses {
        train: Some(0.1 + 0.2),
        validation: None,
        test: Some(1.0 / 3.0),
    };
    meta.held_out = BTreeMap::from([("cups".to_owned(), 2.0 / 3.0e5)]);
    meta.config = json!({ "lr": 1e-4, "batch": 128, "a": null });
    model
}

#[test]
fn a_model_survives_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.safetensors");
    let model = model();
    model.save(&path).unwrap();
    let loaded = Model::load(&path).unwrap();
    assert_eq!(loaded, model);
    // The same model, the same bytes: also after a round trip, and over an older file.
    let bytes = std::fs::read(&path).unwrap();
    loaded.save(&path).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    assert_eq!(loaded.hash().unwrap(), model.hash().unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let mut other = model;
    other.mlp.layers[2].bias[0] += 1.0;
    assert_ne!(other.hash().unwrap(), loaded.hash().unwrap());
}

#[test]
fn raw_features_are_normalised_and_outputs_guarded() {
    let mut model = model();
    // One layer that passes the first input on.
    model.mlp = Mlp::new(
        vec![Layer {
            inputs: 3,
            outputs: 1,
            weights: vec![1.0, 0.0, 0.0],
            bias: vec![0.0],
        }],
        Activation::Relu,
        Activation::Identity,
    )
    .unwrap();
    model.meta.inputs[0].offset = 2.0;
    model.meta.inputs[0].scale = 0.25;
    model.check().unwrap();
    for (raw, expected) in [
        (4.0, 0.5),
        (6.0, 1.0),
        (60.0, 1.0),
        (2.0, WEIGHT_FLOOR),
        (-9.0, WEIGHT_FLOOR),
    ] {
        assert_eq!(model.forward_raw(&[raw, 1.0, 1.0]), [expected]);
        let [wide, expected] = [raw, expected].map(f64::from);
        assert_eq!(model.forward_raw(&[wide, 1.0, 1.0]), [expected]);
    }
    assert_eq!(model.forward_raw(&[f32::NAN, 1.0, 1.0]), [WEIGHT_FLOOR]);
}

fn assert_message(bytes: &[u8], words: &str) {
    let text = Model::from_bytes(bytes, "m").unwrap_err().to_string();
    let is_whole = text.starts_with("m: ") && text.contains(words);
    assert!(is_whole, "{words:?} is not in: {text}");
}

type Tensors = BTreeMap<String, (Dtype, Vec<usize>, Vec<u8>)>;

/// The good model's file with some tensors and the metadata's JSON changed.
fn spoilt(tensors: impl Fn(&mut Tensors), json: impl Fn(&mut Value)) -> Vec<u8> {
    let bytes = model().to_bytes().unwrap();
    let (_, header) = SafeTensors::read_metadata(&bytes).unwrap();
    let mut value = serde_json::from_str(&header.metadata().as_ref().unwrap()["peelnet"]).unwrap();
    json(&mut value);
    let mut all: Tensors = SafeTensors::deserialize(&bytes)
        .unwrap()
        .tensors()
        .into_iter()
        .map(|(name, t)| (name, (t.dtype(), t.shape().to_vec(), t.data().to_vec())))
        .collect();
    tensors(&mut all);
    let views = all.iter().map(|(name, (dtype, shape, data))| {
        let view = TensorView::new(*dtype, shape.clone(), data);
        (name.clone(), view.unwrap())
    });
    let metadata = HashMap::from([("peelnet".to_owned(), value.to_string())]);
    safetensors::serialize(views, Some(metadata)).unwrap()
}

#[test]
fn bad_tensors() {
    let insert = |t: &mut Tensors, name: &str, shape: &[usize]| {
        let bytes = vec![0u8; 4 * shape.iter().product::<usize>()];
        t.insert(name.to_owned(), (Dtype::F32, shape.to_vec(), bytes));
    };
    let first = "layers.0.weight";
    let zeros: [(&str, &[usize], &str); 6] = [
        ("extra", &[1], "\"extra\" belongs to no layer"),
        ("layers.99999999999.bias", &[1], "belongs to no layer"),
        (first, &[3, 10], "is F32 [10], expected F32 [3]"),
        (first, &[30], "expected F32 [outputs, inputs]"),
        (first, &[10, 4], "takes 4 inputs but the metadata"),
        ("layers.1.weight", &[8, 9], "takes 9 inputs but the layer"),
    ];
    for (name, shape, words) in zeros {
        let bytes = spoilt(|t| insert(t, name, shape), |_| ());
        assert_message(&bytes, words);
    }
    for missing in ["layers.0.weight", "layers.1.weight", "layers.1.bias"] {
        let bytes = spoilt(|t| drop(t.remove(missing)), |_| ());
        assert_message(&bytes, &format!("{missing:?} is missing"));
    }
    let more = |t: &mut Tensors| {
        insert(t, "layers.2.weight", &[2, 8]);
        insert(t, "layers.2.bias", &[2]);
    };
    let words = "gives 2 outputs where transmittance has 1";
    assert_message(&spoilt(more, |_| ()), words);
    assert_message(&spoilt(Tensors::clear, |_| ()), "weight\" is missing");
    let integers = |t: &mut Tensors| t.get_mut("layers.2.bias").unwrap().0 = Dtype::I32;
    assert_message(&spoilt(integers, |_| ()), "is I32 [1], expected F32");
    for (value, words) in [
        (f32::NAN, "weight\": value 3 is NaN"),
        (-3e38, "weight\": value 3 is -3"),
    ] {
        let set = |t: &mut Tensors| {
            let weights = &mut t.get_mut("layers.1.weight").unwrap().2;
            weights[12..16].copy_from_slice(&value.to_le_bytes());
        };
        assert_message(&spoilt(set, |_| ()), words);
    }
}

#[test]
fn bad_metadata() {
    for field in ["format_version", "seed", "mlp"] {
        let remove = |v: &mut Value| drop(v.as_object_mut().unwrap().remove(field));
        assert_message(&spoilt(|_| (), remove), &format!("missing field `{field}`"));
    }
    for (place, value, words) in [
        ("/format_version", json!(2), "model format 2, but"),
        ("/recipe", json!("tiny"), "\"tiny\": expected one of thesis"),
        ("/recipe", json!("small"), "recipe small takes (root_absorb"),
        (
            "/mlp/hidden",
            json!("tanh"),
            "`tanh`, expected one of `relu`",
        ),
        ("/mlp/topology", json!(3), "expected a string"),
        ("/inputs/1/name", json!("sum"), "lists (linear_depth, sum, "),
        ("/output", json!("color"), "thesis does not predict color"),
        ("/inputs/2/scale", json!(null), "null, expected f32"),
        ("/inputs/2/scale", json!(3e38), "from -1e12 to 1e12"),
        (
            "/inputs/2/scale",
            json!(0),
            "scale of input \"fragment_count",
        ),
    ] {
        let set = |v: &mut Value| *v.pointer_mut(place).unwrap() = value.clone();
        assert_message(&spoilt(|_| (), set), words);
    }
}

#[test]
fn files_that_are_no_models() {
    let good = model().to_bytes().unwrap();
    for cut in [0, 7, 8, 100, good.len() - 1] {
        assert_message(&good[..cut], "not a readable safetensors file");
    }
    assert_message(b"GIF89a is not a model either", "not a readable");
    let data = [0u8; 4];
    let foreign = [("w", TensorView::new(Dtype::F32, vec![1], &data).unwrap())];
    let foreign = safetensors::serialize(foreign, None).unwrap();
    assert_message(&foreign, "not a peelnet model");
    let text = Model::load("nowhere/m").unwrap_err().to_string();
    assert!(
        text.starts_with("nowhere/m: there is no such file"),
        "{text}"
    );
}

#[test]
fn nothing_is_written_that_could_not_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.safetensors");
    let refuse = |spoil: fn(&mut Model), word: &str| {
        let mut bad = model();
        spoil(&mut bad);
        let text = bad.save(&path).unwrap_err().to_string();
        assert!(text.contains(word), "{text}");
    };
    refuse(|m| m.mlp.layers[0].weights[0] = 1.0 / 0.0, "0.weight");
    refuse(|m| m.meta.losses.test = Some(f64::NAN), "test loss is NaN");
    refuse(|m| m.meta.inputs[0].min = 1e9, "at most max");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);

    // A folder where the file should be.
    let text = model().save(folder.path()).unwrap_err().to_string();
    assert!(text.contains("cannot write the model"), "{text}");
}
