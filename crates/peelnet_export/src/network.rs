//! The network itself as straight-line code.

use crate::{
    Precision,
    literal::{float, identifier, letters, vec4},
};
use peelnet_core::{
    guards::{INPUT_LIMIT, RAW_LIMIT, ROOT_ABSORBANCE_LIMIT},
    mlp::{Activation, Layer},
};
use peelnet_model::{BOUNDS, Input, Inputs, Model, Output};
use std::fmt::Write as _;

/// The exported function's name.
pub(crate) const fn function_name(output: Output) -> &'static str {
    match output {
        Output::Color => "peelnet_color",
        _ => "peelnet_weight",
    }
}

/// The function that the modules around the network call: it evaluates the inputs and passes them to the network.
pub(crate) fn call(model: &Model) -> String {
    let recipe = model.meta.recipe;
    let (parameters, function) = match recipe.inputs {
        Inputs::Row(_) => ("linear_depth: f32, statistics: vec2f", "peelnet_weight"),
        Inputs::Moments(_) => (
            "zeta: f32, extent: vec2f, totals: vec4f, moments: vec4f",
            "peelnet_weight",
        ),
        Inputs::Rest(_) => ("rest: PeelnetRest", "peelnet_share"),
        Inputs::Slabs(..) => ("between: PeelnetBetween", "peelnet_share"),
        Inputs::Layers(_) => (
            "front: vec4f, behind: vec4f, all: vec4f, count: f32",
            "peelnet_color",
        ),
    };
    let about = recipe.inputs.about();
    let mut t = format!(
        "// The network's answer for what is known of a fragment.\nfn peelnet_network({parameters}) -> {} {{\n",
        kind(recipe.output)
    );
    let mut written = Vec::new();
    for shared in about.iter().filter_map(|about| about.shared) {
        if !written.contains(&shared.name) {
            written.push(shared.name);
            // Writing to a string cannot fail.
            let _ = writeln!(t, "    let {} = {};", shared.name, shared.wgsl);
        }
    }
    let values: Vec<&str> = about.iter().map(|about| about.wgsl).collect();
    let _ = writeln!(
        t,
        "    return {function}(\n        {});\n}}",
        values.join(", ")
    );
    t
}

const fn kind(output: Output) -> &'static str {
    if output.count() == 1 { "f32" } else { "vec3f" }
}

/// The network as straight-line code: the function that the model's inputs go to, and for shares of absorbance the share
/// alone before it.
pub(crate) fn weight_function(model: &Model, precision: Precision) -> String {
    let inputs = &model.meta.inputs;
    let output = model.meta.output;
    let list = |each: &dyn Fn(&Input) -> String| -> String {
        let all: Vec<String> = inputs.iter().map(each).collect();
        all.join(", ")
    };
    let parameters = list(&|i| format!("{}: f32", identifier(&i.name)));
    let kind = kind(output);
    let name = function_name(output);
    let (low, high) = output.range();
    let (low, high) = (float(low), float(high));
    let mut t = String::new();
    // Writing to a string cannot fail.
    let _ = match output {
        Output::Transmittance | Output::Color => {
            let _ = writeln!(t, "fn {name}({parameters}) -> {kind} {{");
            let last = network(&mut t, model, true, precision);
            let answer = if output.count() == 1 {
                format!("clamp({last}_a, {low}, {high})")
            } else {
                format!("clamp({last}_a.xyz, vec3f({low}), vec3f({high}))")
            };
            writeln!(t, "    return {answer};\n}}")
        }
        Output::AnchoredShare | Output::AnchoredShareSeparateEnds | Output::BoundedShare => {
            let bounded = output == Output::BoundedShare;
            let share = if bounded {
                "Where between its bounds the share of the absorbance lies that is in front"
            } else {
                "The share of the rest's absorbance that lies in front"
            };
            let _ = writeln!(
                t,
                "// {share}, for inputs as peelnet_network evaluates them.\nfn peelnet_share({parameters}) -> {kind} {{"
            );
            let last = network(&mut t, model, false, precision);
            let _ = writeln!(t, "    return {last}_a;\n}}\n");
            let _ = writeln!(
                t,
                "// Its transmittance, for any finite inputs.\nfn {name}({parameters}) -> {kind} {{"
            );
            let limited = list(&|i| {
                let [low, high] = limits(i, INPUT_LIMIT);
                format!(
                    "clamp({}, {}, {})",
                    identifier(&i.name),
                    float(low),
                    float(high)
                )
            });
            let root = format!(
                "clamp({}, 0.0, {})",
                identifier(&inputs[0].name),
                float(ROOT_ABSORBANCE_LIMIT)
            );
            let _ = writeln!(t, "    let root = {root};");
            let _ = writeln!(t, "    let share = peelnet_share(\n        {limited});");
            let front = if bounded {
                let [low, high] = BOUNDS.map(|k| identifier(&inputs[k].name));
                let _ = writeln!(
                    t,
                    "    let bounds = clamp(vec2f({low}, {high}), vec2f(0.0), vec2f(1.0));"
                );
                "mix(bounds.x, bounds.y, share)"
            } else {
                "share"
            };
            writeln!(t, "    return exp(-root * root * {front});\n}}")
        }
    };
    t
}

/// Normalised inputs of layers in 16 bits: twice what data have, and far from where half floats become infinite.
const HALF_LIMIT: f32 = 16.0;

/// The raw values at which the normalised ones reach a limit, or [`RAW_LIMIT`].
fn limits(input: &Input, limit: f32) -> [f32; 2] {
    let reach = (limit / input.scale.abs()).min(RAW_LIMIT);
    [input.offset - reach, input.offset + reach]
}

/// The lines from the raw inputs to the last layer; returns that layer's name.
///
/// With limits the inputs are normalised as the model does it; without, they are known to be small (see
/// `peelnet_network`), and the first layer takes the normalisation in.
///
/// In 16 bits: all layers but the last one, whose sum of many terms is what is exponentiated. Their inputs are normalised in 32 bits and
/// limited closer, so that no sum becomes infinite.
fn network(t: &mut String, model: &Model, limited: bool, precision: Precision) -> String {
    let inputs = &model.meta.inputs;
    let halves = precision == Precision::F16 && model.mlp.layers.len() > 1;
    let limited = limited || halves;
    let limits = |i: &Input| limits(i, if halves { HALF_LIMIT } else { INPUT_LIMIT });
    if limited {
        t.push_str("    // The limits never bind on real data and keep everything finite.\n");
    }
    for (c, here) in inputs.chunks(4).enumerate() {
        let names: Vec<_> = (0..4)
            .map(|k| {
                here.get(k)
                    .map_or("0.0".to_owned(), |i| identifier(&i.name))
            })
            .collect();
        let column = |value: &dyn Fn(&Input) -> f32| -> String {
            let values: Vec<f32> = here.iter().map(value).collect();
            vec4(&values)
        };
        let raw = format!("vec4f({})", names.join(", "));
        let _ = if halves {
            let (low, high) = (column(&|i| limits(i)[0]), column(&|i| limits(i)[1]));
            let (offset, scale) = (column(&|i| i.offset), column(&|i| i.scale));
            writeln!(
                t,
                "    let {} = vec4h((clamp({raw}, {low}, {high}) - {offset}) * {scale});",
                part("input", c)
            )
        } else if limited {
            let (low, high) = (column(&|i| limits(i)[0]), column(&|i| limits(i)[1]));
            let (offset, scale) = (column(&|i| i.offset), column(&|i| i.scale));
            writeln!(
                t,
                "    let {} = (clamp({raw}, {low}, {high}) - {offset}) * {scale};",
                part("input", c)
            )
        } else {
            writeln!(t, "    let {} = {raw};", part("input", c))
        };
    }
    let last = model.mlp.layers.len() - 1;
    let mut before = "input".to_owned();
    for (l, layer) in model.mlp.layers.iter().enumerate() {
        let activation = if l == last {
            model.mlp.output
        } else {
            model.mlp.hidden
        };
        let name = format!("layer_{}", letters(l));
        let begin = t.len();
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
        if halves {
            let text = t.split_off(begin);
            if l == last {
                // Back to 32 bits.
                let parts = (0..layer.inputs.div_ceil(4)).map(|c| part(&before, c));
                let whole = |text: String, part| text.replace(&part, &format!("vec4f({part})"));
                t.push_str(&parts.fold(text, whole));
            } else {
                t.push_str(
                    &text
                        .replace("vec4f(", "vec4h(")
                        .replace("mat4x4f(", "mat4x4h("),
                );
            }
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

/// The name of four values of a layer.
fn part(layer: &str, k: usize) -> String {
    format!("{layer}_{}", letters(k))
}

/// One layer: `name_a …` from `before_a …`, four outputs at a time, or a single one as a number.
fn layer_text(t: &mut String, layer: &Layer, before: &str, name: &str, activation: Activation) {
    if layer.outputs == 1 {
        let mut sum = float(layer.bias[0]);
        for (c, weights) in layer.weights.chunks(4).enumerate() {
            let before = part(before, c);
            let _ = match weights {
                [single] => write!(sum, "\n        + {} * {before}.x", float(*single)),
                _ => write!(sum, "\n        + dot({}, {before})", vec4(weights)),
            };
        }
        let _ = writeln!(
            t,
            "    let {name}_a = {};",
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
                write!(
                    sum,
                    "\n        + {} * {}.x",
                    columns[0],
                    part(before, column)
                )
            } else {
                write!(
                    sum,
                    "\n        + mat4x4f({}) * {}",
                    columns.join(", "),
                    part(before, column)
                )
            };
        }
        let splat = |x| format!("vec4f({})", float(x));
        let _ = writeln!(
            t,
            "    let {} = {};",
            part(name, row),
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
