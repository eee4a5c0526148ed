//! The text in WGSL.

use crate::{
    ExportError, Options,
    literal::{float, vec4},
};
use peelnet_core::{
    guards::{INPUT_LIMIT, RAW_LIMIT, ROOT_ABSORBANCE_LIMIT},
    mlp::{Activation, Layer, Mlp},
};
use peelnet_model::{Input, Model, Output, Recipe};
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
    let around: &[&str] = match model.meta.recipe {
        Recipe::Thesis => &["learned::thesis"],
        Recipe::Small => &["learned::anchored", "learned::fragment_small"],
        Recipe::Medium => &["learned::anchored", "learned::fragment_medium"],
        Recipe::Large => &[
            "learned::anchored",
            "learned::interval_bounds",
            "learned::fragment_large",
        ],
        Recipe::Nmt => &["learned::nmt", "learned::fragment_nmt"],
        Recipe::Dfaoit => &["learned::dfaoit"],
    };
    let mut text = header(model);
    for module in around {
        text.push_str(peelnet_shaders::source(module)?);
        text.push('\n');
    }
    text.push_str(&weight_function(model));
    Ok(text)
}

fn header(model: &Model) -> String {
    let meta = &model.meta;
    let mut t = String::new();
    let mut line = |text: String| {
        t.push_str("// ");
        t.push_str(&text);
        t.push('\n');
    };
    line(format!(
        "A learned weight for order-independent transparency. Exported by peelnet {}.",
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
    let (low, high) = meta.output.range();
    line(format!(
        "Answers: {}.",
        match meta.output {
            Output::Transmittance => format!(
                "transmittance in front, kept in {} .. {}",
                float(low),
                float(high)
            ),
            Output::AnchoredShare | Output::AnchoredShareSeparateEnds =>
                "transmittance of the rest, exp(-rest * share) with rest = root_absorbance^2 and share in 0 .. 1"
                    .into(),
            Output::TailColor => "linear RGB, kept in 0 .. 1".into(),
        }
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
        let outputs = model.shader_output(&inputs);
        line(format!(
            "Self-test: {}({}) = {}",
            function_name(meta.output),
            list.join(", "),
            outputs
                .iter()
                .map(|&x| float(x))
                .collect::<Vec<_>>()
                .join(", ")
        ));
    }
    t.push('\n');
    t
}

/// The exported function's name.
pub(crate) const fn function_name(output: Output) -> &'static str {
    match output {
        Output::TailColor => "peelnet_tail_color",
        _ => "peelnet_weight",
    }
}

/// The network as straight-line code: the function that the model's inputs go to, and for shares of absorbance the share
/// alone before it.
fn weight_function(model: &Model) -> String {
    let inputs = &model.meta.inputs;
    let output = model.meta.output;
    let list = |each: &dyn Fn(&Input) -> String| -> String {
        let all: Vec<String> = inputs.iter().map(each).collect();
        all.join(", ")
    };
    let parameters = list(&|i| format!("{}: f32", i.name));
    let kind = if output.count() == 1 { "f32" } else { "vec3f" };
    let name = function_name(output);
    let (low, high) = output.range();
    let (low, high) = (float(low), float(high));
    let mut t = String::new();
    // Writing to a string cannot fail.
    let _ = match output {
        Output::Transmittance | Output::TailColor => {
            let _ = writeln!(t, "fn {name}({parameters}) -> {kind} {{");
            let last = network(&mut t, model, true);
            let answer = if output.count() == 1 {
                format!("clamp({last}0, {low}, {high})")
            } else {
                format!("clamp({last}0.xyz, vec3f({low}), vec3f({high}))")
            };
            writeln!(t, "    return {answer};\n}}")
        }
        Output::AnchoredShare | Output::AnchoredShareSeparateEnds => {
            let _ = writeln!(
                t,
                "// The share of the rest's absorbance that lies in front, for inputs as peelnet_features gives them.\n\
                 fn peelnet_share({parameters}) -> {kind} {{"
            );
            let last = network(&mut t, model, false);
            let _ = writeln!(t, "    return {last}0;\n}}\n");
            let _ = writeln!(
                t,
                "// Its transmittance, for any finite inputs.\nfn {name}({parameters}) -> {kind} {{"
            );
            let limited = list(&|i| {
                let [low, high] = limits(i);
                format!("clamp({}, {}, {})", i.name, float(low), float(high))
            });
            let root = format!(
                "clamp({}, 0.0, {})",
                inputs[0].name,
                float(ROOT_ABSORBANCE_LIMIT)
            );
            let _ = writeln!(t, "    let root = {root};");
            writeln!(
                t,
                "    return exp(-root * root * peelnet_share(\n        {limited}));\n}}"
            )
        }
    };
    t
}

/// The raw values at which the normalised ones reach [`INPUT_LIMIT`], or [`RAW_LIMIT`].
fn limits(input: &Input) -> [f32; 2] {
    let reach = (INPUT_LIMIT / input.scale.abs()).min(RAW_LIMIT);
    [input.offset - reach, input.offset + reach]
}

/// The lines from the raw inputs to the last layer; returns that layer's name.
///
/// With limits the inputs are normalised as the model does it; without, they are known to be small (see
/// `peelnet_features`), and the first layer takes the normalisation in.
fn network(t: &mut String, model: &Model, limited: bool) -> String {
    let inputs = &model.meta.inputs;
    if limited {
        t.push_str("    // The limits never bind on real data and keep everything finite.\n");
    }
    for (c, here) in inputs.chunks(4).enumerate() {
        let names: Vec<_> = (0..4)
            .map(|k| here.get(k).map_or("0.0", |i| i.name.as_str()))
            .collect();
        let column = |value: &dyn Fn(&Input) -> f32| -> String {
            let values: Vec<f32> = here.iter().map(value).collect();
            vec4(&values)
        };
        let raw = format!("vec4f({})", names.join(", "));
        let _ = if limited {
            let (low, high) = (column(&|i| limits(i)[0]), column(&|i| limits(i)[1]));
            let (offset, scale) = (column(&|i| i.offset), column(&|i| i.scale));
            writeln!(
                t,
                "    let x{c} = (clamp({raw}, {low}, {high}) - {offset}) * {scale};"
            )
        } else {
            writeln!(t, "    let x{c} = {raw};")
        };
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
        if l == 0 && !limited {
            layer_text(
                t,
                &for_raw_inputs(layer, inputs),
                &before,
                &name,
                activation,
            );
        } else {
            layer_text(t, layer, &before, &name, activation);
        }
        before = name;
    }
    before
}

/// A first layer that normalises its inputs itself: `W s (x − o) + c = (W s) x + (c − W s o)`.
fn for_raw_inputs(layer: &Layer, inputs: &[Input]) -> Layer {
    let mut raw = layer.clone();
    for (row, bias) in raw
        .weights
        .chunks_exact_mut(layer.inputs)
        .zip(&mut raw.bias)
    {
        let mut sum = f64::from(*bias);
        for (w, i) in row.iter_mut().zip(inputs) {
            let scaled = f64::from(*w) * f64::from(i.scale);
            sum -= scaled * f64::from(i.offset);
            *w = scaled as f32;
        }
        *bias = sum as f32;
    }
    raw
}

/// One layer: `name0 … ` from `before0 …`, four outputs at a time, or a single one as a number.
fn layer_text(t: &mut String, layer: &Layer, before: &str, name: &str, activation: Activation) {
    if layer.outputs == 1 {
        let mut sum = float(layer.bias[0]);
        for (c, weights) in layer.weights.chunks(4).enumerate() {
            let _ = match weights {
                [single] => write!(sum, "\n        + {} * {before}{c}.x", float(*single)),
                _ => write!(sum, "\n        + dot({}, {before}{c})", vec4(weights)),
            };
        }
        let _ = writeln!(
            t,
            "    let {name}0 = {};",
            activated(&sum, activation, float)
        );
        return;
    }
    for row in 0..layer.outputs.div_ceil(4) {
        let mut sum = vec4(&layer.bias[row * 4..layer.outputs.min(row * 4 + 4)]);
        for column in 0..layer.inputs.div_ceil(4) {
            let columns: Vec<_> = (column * 4..column * 4 + 4)
                .map(|c| {
                    let weight = |r: usize| {
                        let inside = r < layer.outputs && c < layer.inputs;
                        inside.then(|| layer.weights[r * layer.inputs + c])
                    };
                    let values = [0, 1, 2, 3].map(|r| weight(row * 4 + r).unwrap_or(0.0));
                    vec4(&values)
                })
                .collect();
            // A single input left over needs no matrix.
            let _ = if column * 4 + 1 == layer.inputs {
                write!(sum, "\n        + {} * {before}{column}.x", columns[0])
            } else {
                write!(
                    sum,
                    "\n        + mat4x4f({}) * {before}{column}",
                    columns.join(", ")
                )
            };
        }
        let splat = |x| format!("vec4f({})", float(x));
        let _ = writeln!(
            t,
            "    let {name}{row} = {};",
            activated(&sum, activation, splat)
        );
    }
}

/// An activation's text; `constant` writes a number in the sum's type.
fn activated(sum: &str, activation: Activation, constant: impl Fn(f32) -> String) -> String {
    match activation {
        Activation::Relu => format!("max({sum}, {})", constant(0.0)),
        // The other end needs no limit: the exponential becomes 0 there.
        Activation::Sigmoid => format!("1.0 / (1.0 + exp(min(-({sum}), {})))", constant(80.0)),
        Activation::Identity => sum.to_owned(),
    }
}
