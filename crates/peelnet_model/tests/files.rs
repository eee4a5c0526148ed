//! Models survive their file, and every bad file gives one error that says what is wrong.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use std::collections::{BTreeMap, HashMap};

use peelnet_core::guards::WEIGHT_FLOOR;
use peelnet_core::mlp::{Activation, Layer, Mlp};
use peelnet_model::*;
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};

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
    meta.config = serde_json::json!({ "lr": 1e-4, "batch": 128, "a": null });
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
fn the_file_is_a_state_dict() {
    let bytes = model().to_bytes().unwrap();
    let tensors = SafeTensors::deserialize(&bytes).unwrap();
    let mut names = tensors.names();
    names.sort_unstable();
    assert_eq!(
        names,
        [
            "layers.0.bias",
            "layers.0.weight",
            "layers.1.bias",
            "layers.1.weight",
            "layers.2.bias",
            "layers.2.weight"
        ]
    );
    assert_eq!(tensors.tensor("layers.0.weight").unwrap().shape(), [10, 3]);
    let (_, header) = SafeTensors::read_metadata(&bytes).unwrap();
    let json = &header.metadata().as_ref().unwrap()["peelnet"];
    let value: serde_json::Value = serde_json::from_str(json).unwrap();
    assert_eq!(value["mlp"]["topology"], "3-10-8-1");
    assert_eq!(value["mlp"]["hidden"], "relu");
    assert_eq!(value["recipe"], "thesis");
    assert_eq!(value["output"], "transmittance");
    assert_eq!(value["inputs"][0]["name"], "linear_depth");
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
        assert_eq!(
            model.forward_raw_f64(&[raw.into(), 1.0, 1.0]),
            [f64::from(expected)]
        );
    }
    assert_eq!(model.forward_raw(&[f32::NAN, 1.0, 1.0]), [WEIGHT_FLOOR]);
}

fn message(bytes: &[u8]) -> String {
    let error = Model::from_bytes(bytes, "m.safetensors").unwrap_err();
    let text = error.to_string();
    assert!(text.starts_with("m.safetensors: "), "{text}");
    text
}

fn assert_message(bytes: &[u8], words: &[&str]) {
    let text = message(bytes);
    for word in words {
        assert!(text.contains(word), "{word:?} is not in: {text}");
    }
}

type Tensors = BTreeMap<String, (Dtype, Vec<usize>, Vec<u8>)>;

/// The good model's file with some tensors and the metadata's JSON changed.
fn spoilt(tensors: impl Fn(&mut Tensors), json: impl Fn(&mut serde_json::Value)) -> Vec<u8> {
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
        (
            name.clone(),
            TensorView::new(*dtype, shape.clone(), data).unwrap(),
        )
    });
    let metadata = HashMap::from([("peelnet".to_owned(), value.to_string())]);
    safetensors::serialize(views, Some(metadata)).unwrap()
}

fn zeros(tensors: &mut Tensors, name: &str, shape: &[usize]) {
    let bytes = vec![0u8; 4 * shape.iter().product::<usize>()];
    tensors.insert(name.to_owned(), (Dtype::F32, shape.to_vec(), bytes));
}

#[test]
fn bad_tensors() {
    type Spoil = fn(&mut Tensors);
    let spoils: [(Spoil, &[&str]); 12] = [
        (
            |t| t.retain(|name, _| name != "layers.1.bias"),
            &["layers.1.bias", "missing"],
        ),
        (
            |t| t.retain(|name, _| !name.starts_with("layers.1")),
            &["layers.1.weight", "missing"],
        ),
        (Tensors::clear, &["layers.0.weight", "missing"]),
        (|t| zeros(t, "extra", &[1]), &["extra", "no layer"]),
        (
            |t| zeros(t, "layers.99999999999.bias", &[1]),
            &["layers.99999999999.bias", "no layer"],
        ),
        (
            |t| zeros(t, "layers.0.weight", &[3, 10]),
            &["layers.0.bias", "F32 [10]", "F32 [3]"],
        ),
        (
            |t| zeros(t, "layers.0.weight", &[30]),
            &["layers.0.weight", "F32 [30]", "[outputs, inputs]"],
        ),
        (
            |t| t.get_mut("layers.2.bias").unwrap().0 = Dtype::I32,
            &["layers.2.bias", "I32", "F32"],
        ),
        (
            |t| zeros(t, "layers.1.weight", &[8, 9]),
            &["layer 1 takes 9 inputs", "gives 10"],
        ),
        (
            |t| zeros(t, "layers.0.weight", &[10, 4]),
            &["takes 4 inputs", "lists 3"],
        ),
        (
            |t| {
                zeros(t, "layers.2.weight", &[2, 8]);
                zeros(t, "layers.2.bias", &[2]);
            },
            &["gives 2 outputs", "transmittance has 1"],
        ),
        (
            |t| {
                let weights = &mut t.get_mut("layers.1.weight").unwrap().2;
                weights[12..16].copy_from_slice(&f32::NAN.to_le_bytes());
            },
            &["layers.1.weight", "value 3 is NaN", "finite"],
        ),
    ];
    for (spoil, words) in spoils {
        assert_message(&spoilt(spoil, |_| ()), words);
    }
}

fn remove(value: &mut serde_json::Value, key: &str) {
    value.as_object_mut().unwrap().remove(key);
}

#[test]
fn bad_metadata() {
    type Spoil = fn(&mut serde_json::Value);
    let spoils: [(Spoil, &[&str]); 11] = [
        (
            |v| v["format_version"] = 2.into(),
            &["format 2", "format 1"],
        ),
        (
            |v| remove(v, "format_version"),
            &["missing field `format_version`"],
        ),
        (|v| remove(v, "seed"), &["missing field `seed`"]),
        (|v| remove(v, "mlp"), &["missing field `mlp`"]),
        (|v| v["recipe"] = "tiny".into(), &["tiny", "thesis"]),
        (|v| v["mlp"]["hidden"] = "tanh".into(), &["tanh", "relu"]),
        (
            |v| v["inputs"][1]["name"] = "sum_of_alphas".into(),
            &["other features", "sum_of_alphas", "alpha_sum"],
        ),
        (
            |v| v["recipe"] = "small".into(),
            &["other features", "recipe small", "root_absorbance"],
        ),
        (
            |v| v["output"] = "color".into(),
            &["recipe thesis", "color"],
        ),
        (
            |v| v["inputs"][2]["scale"] = serde_json::Value::Null,
            &["null", "f32"],
        ),
        (
            |v| v["inputs"][2]["scale"] = 0.into(),
            &["scale of input \"fragment_count\" is 0"],
        ),
    ];
    for (spoil, words) in spoils {
        assert_message(&spoilt(|_| (), spoil), words);
    }
}

#[test]
fn files_that_are_no_models() {
    let good = model().to_bytes().unwrap();
    for cut in [0, 7, 8, 100, good.len() - 1] {
        assert!(message(&good[..cut]).contains("not a readable safetensors file"));
    }
    assert!(message(b"GIF89a is not a model either").contains("not a readable safetensors"));
    let data = [0u8; 4];
    let foreign = [("w", TensorView::new(Dtype::F32, vec![1], &data).unwrap())];
    let foreign = safetensors::serialize(foreign, None).unwrap();
    assert!(message(&foreign).contains("not a peelnet model"));
    let text = Model::load("nowhere/m.safetensors")
        .unwrap_err()
        .to_string();
    assert!(
        text.contains("nowhere/m.safetensors") && text.contains("read"),
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
    refuse(
        |m| m.mlp.layers[0].weights[0] = f32::INFINITY,
        "layers.0.weight",
    );
    refuse(|m| m.meta.losses.test = Some(f64::NAN), "test loss is NaN");
    refuse(|m| m.meta.inputs[0].min = 1e9, "at most max");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);

    // An unwritable place, for every user: a file where a folder should be, a folder where the file should be.
    std::fs::write(&path, "x").unwrap();
    let text = model().save(path.join("m")).unwrap_err().to_string();
    assert!(text.contains("cannot write the model"), "{text}");
    let taken = folder.path().join("folder");
    std::fs::create_dir(&taken).unwrap();
    assert!(model().save(&taken).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

/// A device never ends, a pipe would wait for ever, and no model is so large.
#[cfg(unix)]
#[test]
fn only_regular_files_of_a_bounded_size_are_models() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    let large = folder.path().join("large");
    let file = std::fs::File::create(&large).unwrap();
    // Sparse: takes no space.
    file.set_len(1 << 40).unwrap();
    for (path, word) in [
        (std::path::Path::new("/dev/zero"), "regular"),
        (&pipe, "regular"),
        (&large, "at most 67108864"),
    ] {
        let error = Model::load(path).unwrap_err();
        let source = std::error::Error::source(&error).map_or(String::new(), |e| e.to_string());
        assert!(
            format!("{error} {source}").contains(word),
            "{error} {source}"
        );
    }
}
