//! The text in WGSL.

use crate::{
    ExportError, Options,
    literal::{float, vec4},
};
use peelnet_core::{
    guards::{INPUT_LIMIT, RAW_LIMIT},
    mlp::{Activation, Layer, Mlp},
};
use peelnet_model::{Model, Output};
use std::fmt::Write as _;

/// Multiply–adds of one evaluation of the network, as published costs count them (padding not included).
pub fn multiply_adds(mlp: &Mlp) -> usize {
    mlp.layers.iter().map(|l| l.inputs * l.outputs).sum()
}

/// Three inputs that the header and the verification use: the low end, the middle and the high end of the range seen
/// in training.
pub(crate) fn self_test_inputs(model: &Model) -> [Vec<f32>; 3] {
    [0.0, 0.5, 1.0].map(|t: f32| {
        model
            .meta
            .inputs
            .iter()
            .map(|i| i.min + t * (i.max - i.min))
            .collect()
    })
}

/// The self-contained text of a model: header, `peelnet_features` and `peelnet_weight`.
///
/// The same model gives the same bytes.
///
/// # Errors
/// A model that does not hold together, or whose output has no shader function.
pub fn wgsl(model: &Model, _options: &Options) -> Result<String, ExportError> {
    model.check()?;
    if model.meta.output != Output::Transmittance || model.meta.inputs.len() != 3 {
        return Err(ExportError::Output {
            recipe: model.meta.recipe.to_string(),
            output: model.meta.output.to_string(),
        });
    }
    let mut text = header(model);
    text.push_str(FEATURES);
    text.push_str(&weight_function(model));
    Ok(text)
}

/// What the thesis's network reads, and which targets that takes.
const FEATURES: &str = "\
// Statistics pass: draw all transparent surfaces, in any order, into one target
//     format rg16float (rg32float for more than 2048 layers), cleared to 0, blending ONE, ONE, ADD,
//     each fragment writing (alpha, 1): the pixel's sum of alpha and its number of fragments.
// Weight pass: draw them again; each fragment reads its pixel's statistics and calls
//     let f = peelnet_features(linear_depth, statistics);
//     let w = peelnet_weight(f.x, f.y, f.z);
// and writes (alpha * rgb * w, alpha * w) to an rgba16float target (cleared to 0, ONE, ONE, ADD) and alpha to an
// r16float target (cleared to 1, ZERO, ONE_MINUS_SRC): T. Resolve over the background C_0, where T is not 1:
//     sums.rgb / sums.a * (1 - T) + C_0 * T

// linear_depth: distance along the view axis in scene units. statistics: sum of alpha, number of fragments.
fn peelnet_features(linear_depth: f32, statistics: vec2f) -> vec3f {
    return vec3f(linear_depth, statistics.x, statistics.y);
}

";

fn header(model: &Model) -> String {
    let meta = &model.meta;
    let mut t = String::new();
    let mut line = |text: String| {
        t.push_str("// ");
        t.push_str(&text);
        t.push('\n');
    };
    line(format!(
        "peelnet_weight: a learned weight for order-independent transparency. Exported by peelnet {}.",
        env!("CARGO_PKG_VERSION")
    ));
    line("Licence of this generated text: MIT OR Apache-2.0.".into());
    line(format!(
        "Network: {} ({:?} hidden, {:?} last), {} parameters, {} multiply-adds. Recipe {}, seed {}, {} epochs.",
        model.mlp.topology(),
        model.mlp.hidden,
        model.mlp.output,
        model.mlp.parameters(),
        multiply_adds(&model.mlp),
        meta.recipe,
        meta.seed,
        meta.epochs
    ));
    line(format!(
        "Answers: {}, kept in {} .. {}.",
        meta.output,
        float(meta.output.range().0),
        float(meta.output.range().1)
    ));
    for (i, input) in meta.inputs.iter().enumerate() {
        line(format!(
            "Input {i}: {} in {}, valid range {} .. {} (what training saw).",
            input.name,
            input.unit,
            float(input.min),
            float(input.max)
        ));
    }
    line(meta.dataset.as_ref().map_or_else(
        || "Trained on: unknown.".to_owned(),
        |d| {
            format!(
                "Trained on {} rows of {} (dataset {}).",
                d.rows,
                d.scenes.join(", "),
                d.hash
            )
        },
    ));
    let loss = |name: &str, value: Option<f64>| value.map(|v| format!("{name} {v:.6}"));
    let losses: Vec<_> = [
        loss("training", meta.losses.train),
        loss("validation", meta.losses.validation),
        loss("test", meta.losses.test),
    ]
    .into_iter()
    .flatten()
    .collect();
    line(format!(
        "Loss: {}.",
        if losses.is_empty() {
            "unknown".to_owned()
        } else {
            losses.join(", ")
        }
    ));
    if meta.held_out.is_empty() {
        line("Held-out error: not measured.".into());
    } else {
        let errors: Vec<_> = meta
            .held_out
            .iter()
            .map(|(scene, e)| format!("{scene} {e:.5}"))
            .collect();
        line(format!(
            "Held-out error, mean |T - T_exact|: {}.",
            errors.join(", ")
        ));
    }
    for inputs in self_test_inputs(model) {
        let list: Vec<_> = inputs.iter().map(|&x| float(x)).collect();
        let outputs = model.forward_raw(&inputs);
        line(format!(
            "Self-test: peelnet_weight({}) = {}",
            list.join(", "),
            float(outputs[0])
        ));
    }
    t.push('\n');
    t
}

/// The network as straight-line code.
fn weight_function(model: &Model) -> String {
    let inputs = &model.meta.inputs;
    let mut t = String::new();
    let parameters: Vec<_> = inputs.iter().map(|i| format!("{}: f32", i.name)).collect();
    // Writing to a string cannot fail.
    let _ = writeln!(
        t,
        "fn peelnet_weight({}) -> f32 {{\n    // Normalised inputs; the limits never bind on real data and keep everything finite.",
        parameters.join(", ")
    );
    let chunks = inputs.len().div_ceil(4);
    for c in 0..chunks {
        let here = &inputs[c * 4..inputs.len().min(c * 4 + 4)];
        let names: Vec<_> = (0..4)
            .map(|k| here.get(k).map_or("0.0", |i| i.name.as_str()))
            .collect();
        let offsets: Vec<_> = here.iter().map(|i| i.offset).collect();
        let scales: Vec<_> = here.iter().map(|i| i.scale).collect();
        let (raw, limit) = (float(RAW_LIMIT), float(INPUT_LIMIT));
        let _ = writeln!(
            t,
            "    let x{c} = clamp((clamp(vec4f({}), vec4f(-{raw}), vec4f({raw})) - {}) * {}, vec4f(-{limit}), vec4f({limit}));",
            names.join(", "),
            vec4(&offsets),
            vec4(&scales)
        );
    }
    let last = model.mlp.layers.len() - 1;
    let mut before = "x".to_owned();
    for (l, layer) in model.mlp.layers.iter().enumerate() {
        let activation = if l == last {
            model.mlp.output
        } else {
            model.mlp.hidden
        };
        let name = format!("h{l}_");
        layer_text(&mut t, layer, &before, &name, activation);
        before = name;
    }
    let (low, high) = model.meta.output.range();
    let _ = writeln!(
        t,
        "    return clamp({before}0.x, {}, {});\n}}",
        float(low),
        float(high)
    );
    t
}

/// One layer: `name0 … ` from `before0 …`, four outputs at a time.
fn layer_text(t: &mut String, layer: &Layer, before: &str, name: &str, activation: Activation) {
    for row in 0..layer.outputs.div_ceil(4) {
        let mut sum = vec4(&layer.bias[row * 4..layer.outputs.min(row * 4 + 4)]);
        for column in 0..layer.inputs.div_ceil(4) {
            let columns: Vec<_> = (0..4)
                .map(|c| {
                    let values: Vec<_> = (0..4)
                        .map(|r| {
                            let (r, c) = (row * 4 + r, column * 4 + c);
                            if r < layer.outputs && c < layer.inputs {
                                layer.weights[r * layer.inputs + c]
                            } else {
                                0.0
                            }
                        })
                        .collect();
                    vec4(&values)
                })
                .collect();
            let _ = write!(
                sum,
                "\n        + mat4x4f({}) * {before}{column}",
                columns.join(", ")
            );
        }
        let value = match activation {
            Activation::Relu => format!("max({sum}, vec4f(0.0))"),
            Activation::Sigmoid => {
                format!("1.0 / (1.0 + exp(-clamp({sum}, vec4f(-80.0), vec4f(80.0))))")
            }
            Activation::Identity => sum,
        };
        let _ = writeln!(t, "    let {name}{row} = {value};");
    }
}
