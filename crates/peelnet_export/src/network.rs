//! The network itself as straight-line code.

use crate::{
    Precision,
    literal::{float, identifier, letters, vec4},
};
use peelnet_core::{
    guards::{INPUT_LIMIT, RAW_LIMIT, ROOT_ABSORBANCE_LIMIT},
    mlp::{Activation, Layer},
};
use peelnet_model::{BOUNDS, Input, Model, Output};

pub(crate) const fn function_name(output: Output) -> &'static str {
    match output {
        Output::Color => "peelnet_color",
        _ => "peelnet_weight",
    }
}

/// The function that the modules around the network call: it evaluates the inputs and passes them to the network.
pub(crate) fn call(model: &Model) -> String {
    let (inputs, output) = (model.meta.recipe.inputs, model.meta.output);
    let parameters = inputs.surroundings().parameters;
    let function = if output.is_fraction() {
        "peelnet_share"
    } else {
        function_name(output)
    };
    let about = inputs.features();
    let mut t = format!(
        "// The network's answer for what is known of a fragment.\nfn peelnet_network({parameters}) -> {} {{\n",
        kind(output)
    );
    let mut written = Vec::new();
    for shared in about.iter().filter_map(|about| about.shared) {
        if !written.contains(&shared.name) {
            written.push(shared.name);
            t += &format!("    let {} = {};\n", shared.name, shared.wgsl);
        }
    }
    let values: Vec<&str> = about.iter().map(|about| about.wgsl).collect();
    let values = values.join(", ");
    t + &format!("    return {function}(\n        {values});\n}}\n")
}

const fn kind(output: Output) -> &'static str {
    if output.count() == 1 { "f32" } else { "vec3f" }
}

fn join(inputs: &[Input], each: impl Fn(&Input) -> String) -> String {
    inputs.iter().map(each).collect::<Vec<_>>().join(", ")
}

/// The network as straight-line code: the function that the model's inputs go to, and for shares of absorbance the share
/// alone before it.
pub(crate) fn weight_function(model: &Model, precision: Precision) -> String {
    let inputs = &model.meta.inputs;
    let output = model.meta.output;
    let parameters = join(inputs, |i| format!("{}: f32", identifier(&i.name)));
    let (kind, name) = (kind(output), function_name(output));
    let clamped = |value: &str, low: f32, high: f32| {
        format!("clamp({value}, {}, {})", float(low), float(high))
    };
    let (lines, last) = network(model, !output.is_fraction(), precision);
    if !output.is_fraction() {
        let (low, high) = output.range();
        let answer = if output.count() == 1 {
            clamped(&format!("{last}_a"), low, high)
        } else {
            let (low, high) = (float(low), float(high));
            format!("clamp({last}_a.xyz, vec3f({low}), vec3f({high}))")
        };
        return format!("fn {name}({parameters}) -> {kind} {{\n{lines}    return {answer};\n}}\n");
    }
    let mut what = "The share of the rest's absorbance that lies in front";
    let (mut bounds, mut front) = (String::new(), "share");
    if output == Output::BoundedShare {
        what = "Where between its bounds the share of the absorbance lies that is in front";
        let [low, high] = BOUNDS.map(|k| identifier(&inputs[k].name));
        let pair = format!("clamp(vec2f({low}, {high}), vec2f(0.0), vec2f(1.0))");
        bounds = format!("    let bounds = {pair};\n");
        front = "mix(bounds.x, bounds.y, share)";
    }
    let limited = join(inputs, |i| {
        let [low, high] = limits(i, INPUT_LIMIT);
        clamped(&identifier(&i.name), low, high)
    });
    let root = clamped(&identifier(&inputs[0].name), 0.0, ROOT_ABSORBANCE_LIMIT);
    // A sigmoid's answers need no guard.
    let share = match model.mlp.output {
        Activation::Sigmoid => format!("{last}_a"),
        _ => clamped(&format!("{last}_a"), 0.0, 1.0),
    };
    format!(
        "// {what}, for inputs as peelnet_network evaluates them.
fn peelnet_share({parameters}) -> {kind} {{
{lines}    return {share};
}}

// Its transmittance, for any finite inputs.
fn {name}({parameters}) -> {kind} {{
    let root = {root};
    let share = peelnet_share(
        {limited});
{bounds}    return exp(-root * root * {front});
}}
"
    )
}

/// Normalised inputs of layers in 16 bits: twice what data have, and far from where half floats become infinite.
const HALF_LIMIT: f32 = 16.0;

/// The raw values at which the normalised ones reach a limit, or [`RAW_LIMIT`].
fn limits(input: &Input, limit: f32) -> [f32; 2] {
    let reach = (limit / input.scale.abs()).min(RAW_LIMIT);
    [input.offset - reach, input.offset + reach]
}

/// The lines from the raw inputs to the last layer, and that layer's name.
///
/// With limits the inputs are normalised as the model does it; without, they are known to be small (see
/// `peelnet_network`), and the first layer takes the normalisation in.
///
/// In 16 bits: all layers but the last one, whose sum of many terms is what is exponentiated. Their inputs are normalised in 32 bits and
/// limited closer, so that no sum becomes infinite.
fn network(model: &Model, limited: bool, precision: Precision) -> (String, String) {
    let inputs = &model.meta.inputs;
    let halves = precision == Precision::F16 && model.mlp.layers.len() > 1;
    let limited = limited || halves;
    let limit = if halves { HALF_LIMIT } else { INPUT_LIMIT };
    let mut t = String::new();
    if limited {
        t += "    // The limits never bind on real data and keep everything finite.\n";
    }
    for (c, here) in inputs.chunks(4).enumerate() {
        let mut names: Vec<_> = here.iter().map(|i| identifier(&i.name)).collect();
        names.resize(4, "0.0".to_owned());
        let column = |value: &dyn Fn(&Input) -> f32| -> String {
            vec4(&here.iter().map(value).collect::<Vec<_>>())
        };
        let mut value = format!("vec4f({})", names.join(", "));
        if limited {
            let low = column(&|i| limits(i, limit)[0]);
            let high = column(&|i| limits(i, limit)[1]);
            let (offset, scale) = (column(&|i| i.offset), column(&|i| i.scale));
            value = format!("(clamp({value}, {low}, {high}) - {offset}) * {scale}");
        }
        if halves {
            value = format!("vec4h({value})");
        }
        t += &format!("    let {} = {value};\n", part("input", c));
    }
    let last = model.mlp.layers.len() - 1;
    let mut before = "input".to_owned();
    for (l, layer) in model.mlp.layers.iter().enumerate() {
        let (hidden, output) = (model.mlp.hidden, model.mlp.output);
        let activation = if l == last { output } else { hidden };
        let name = format!("layer_{}", letters(l));
        let raw = (l == 0 && !limited).then(|| for_raw_inputs(layer, inputs));
        let mut text = layer_text(raw.as_ref().unwrap_or(layer), &before, &name, activation);
        if halves && l == last {
            // Back to 32 bits.
            for part in (0..layer.inputs.div_ceil(4)).map(|c| part(&before, c)) {
                text = text.replace(&part, &format!("vec4f({part})"));
            }
        } else if halves {
            text = text.replace("vec4f(", "vec4h(");
            text = text.replace("mat4x4f(", "mat4x4h(");
        }
        t += &text;
        before = name;
    }
    (t, before)
}

/// A first layer that normalises its inputs itself: `W s (x − o) + c = (W s) x + (c − W s o)`.
fn for_raw_inputs(layer: &Layer, inputs: &[Input]) -> Layer {
    let mut raw = layer.clone();
    let rows = raw.weights.chunks_exact_mut(layer.inputs);
    for (row, bias) in rows.zip(&mut raw.bias) {
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
fn layer_text(layer: &Layer, before: &str, name: &str, activation: Activation) -> String {
    let weight = |r: usize, c: usize| {
        let row = layer.weights.chunks(layer.inputs).nth(r);
        row.and_then(|row| row.get(c)).copied().unwrap_or(0.0)
    };
    let is_single = layer.outputs == 1;
    let constant = |x| match is_single {
        true => float(x),
        false => format!("vec4f({})", float(x)),
    };
    let mut t = String::new();
    for (row, bias) in layer.bias.chunks(4).enumerate() {
        let mut sum = if is_single {
            float(bias[0])
        } else {
            vec4(bias)
        };
        for column in 0..layer.inputs.div_ceil(4) {
            let columns = [0, 1, 2, 3].map(|c| {
                let values = [0, 1, 2, 3].map(|r| weight(row * 4 + r, column * 4 + c));
                vec4(&values)
            });
            let weights = [0, 1, 2, 3].map(|c| weight(0, column * 4 + c));
            let before = part(before, column);
            // A single input left over needs no matrix.
            let is_left_over = column * 4 + 1 == layer.inputs;
            let product = match (is_single, is_left_over) {
                (true, true) => format!("{} * {before}.x", float(weights[0])),
                (true, false) => format!("dot({}, {before})", vec4(&weights)),
                (false, true) => format!("{} * {before}.x", columns[0]),
                (false, false) => format!("mat4x4f({}) * {before}", columns.join(", ")),
            };
            sum += &format!("\n        + {product}");
        }
        let value = activated(&sum, activation, constant);
        t += &format!("    let {} = {value};\n", part(name, row));
    }
    t
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
