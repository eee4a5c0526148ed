//! The exported text, run on the GPU, against the trainer's forward pass, and written with its description if it agrees.

use crate::{
    ExportError, Language, Options, Precision,
    json::json,
    language::parsed,
    network::function_name,
    self_test::SelfTest,
    text::{ENABLE_HALVES, RANDOM, code, text},
};
use peelnet_core::files::STDOUT;
use peelnet_core::{
    random::Random,
    tolerance::{EXPORT_F16, EXPORT_F32},
};
use peelnet_model::Model;
use peelnet_render::gpu::{Gpu, wgpu};
use serde::Serialize;
use std::{
    fmt,
    path::{Path, PathBuf},
};

/// Inputs that nobody should pass and somebody will.
const EXTREMES: [f32; 10] = [
    0.0,
    1.0,
    -1.0,
    1e-30,
    1e30,
    -1e30,
    f32::MAX,
    -f32::MAX,
    f32::MIN_POSITIVE,
    1e-45,
];

/// How well the exported function agrees with the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Verification {
    /// Inputs tried.
    pub samples: usize,
    /// Largest difference from the 64-bit forward pass.
    pub worst_absolute: f64,
    /// Largest difference as a multiple of what is allowed; at most 1.
    pub worst_relative_to_tolerance: f64,
}

impl fmt::Display for Verification {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (samples, worst) = (self.samples, self.worst_absolute);
        let percent = 100.0 * self.worst_relative_to_tolerance;
        write!(f, "{samples} inputs agree with the model, ")?;
        write!(
            f,
            "worst difference {worst:.1e} ({percent:.0} % of the tolerance)"
        )
    }
}

/// More than rounding moves the transmittance that any useful network answers, by a factor of a hundred; shipped ones reach 0.02.
const LOOSEST: f64 = 5e-2;

/// The difference that is allowed of an answer: [`EXPORT_F32`] of [`Mlp::magnitude`](peelnet_core::mlp::Mlp::magnitude). A weight `exp(−r s)` may differ as
/// much as its share may, and by [`EXPORT_F32`] more for the rounding of `r` and of the exponential.
fn tolerance(model: &Model, raw: &[f64]) -> f64 {
    let (inputs, output) = (model.meta.inputs.iter().zip(raw), model.meta.output);
    let normalised: Vec<f64> = inputs.map(|(i, &x)| i.normalise(x)).collect();
    let sum = EXPORT_F32 * model.mlp.magnitude(&normalised);
    if !output.is_fraction() {
        return sum;
    }
    let fraction = model.forward_raw(raw)[0];
    let weight = |fraction: f64| output.transmittance(raw, fraction.clamp(0.0, 1.0));
    // A sigmoid's slope is at most a quarter.
    let spread = weight(fraction - 0.25 * sum) - weight(fraction + 0.25 * sum);
    EXPORT_F32 + spread.abs()
}

/// Runs `wgsl` on the GPU over random, extreme and self-test inputs and compares with [`Model::shader_output`].
///
/// # Errors
/// A text that differs from the model, with the input at which it does; a text that is not valid; a GPU that fails.
pub fn verify(gpu: &Gpu, model: &Model, wgsl: &str) -> Result<Verification, ExportError> {
    let halves = wgsl.lines().any(|line| line == ENABLE_HALVES.trim_end());
    if halves {
        let flag = wgpu::Features::SHADER_F16;
        gpu.need(flag, "a text in 16 bits", "export in 32 bits")?;
    }
    let precision = if halves {
        Precision::F16
    } else {
        Precision::F32
    };
    let expected = declarations(&code(model, precision)?)?;
    let mut found = declarations(wgsl)?;
    if found != expected {
        found.retain(|declaration| !expected.contains(declaration));
        return Err(ExportError::Refused(format!(
            "the exported text holds other declarations than the model's: {}; nothing was written",
            found.join(", ")
        )));
    }
    let samples = samples(model);
    let outputs = evaluate(gpu, model, wgsl, &samples)?;
    let mut result = Verification {
        samples: samples.len(),
        worst_absolute: 0.0,
        worst_relative_to_tolerance: 0.0,
    };
    let count = model.meta.output.count();
    let in_training = |inputs: &[f32]| {
        let mut each = model.meta.inputs.iter().zip(inputs);
        each.all(|(input, x)| (input.min..=input.max).contains(x))
    };
    for (inputs, found) in samples.iter().zip(outputs.chunks_exact(count)) {
        let raw: Vec<f64> = inputs.iter().map(|&x| f64::from(x)).collect();
        let tolerance = match (halves, in_training(inputs)) {
            (false, _) => tolerance(model, &raw),
            (true, true) => EXPORT_F16,
            // Inputs of layers in 16 bits are limited closer: elsewhere an answer need only be one.
            (true, false) => 1.0,
        };
        let is_loose = model.meta.output.is_fraction() && tolerance > LOOSEST;
        if !halves && in_training(inputs) && is_loose {
            return Err(ExportError::Refused(format!(
                "the weights are so large that rounding alone moves an answer by {tolerance:.1e}; train it again with a lower --lr"
            )));
        }
        for (&found, expected) in found.iter().zip(model.shader_output(&raw)) {
            let tolerance = tolerance.max(EXPORT_F32 * expected.abs());
            let difference = (f64::from(found) - expected).abs();
            // A NaN compares false with everything: ask for agreement, not for disagreement.
            let agrees = difference <= tolerance;
            if !agrees {
                return Err(ExportError::Refused(format!(
                    "the exported function differs from the model: inputs {inputs:?} give {found} instead of {expected} (allowed difference {tolerance:e}); nothing was written"
                )));
            }
            // What need only be an answer says nothing of how well the others agree.
            if tolerance == 1.0 {
                continue;
            }
            result.worst_absolute = result.worst_absolute.max(difference);
            if tolerance > 0.0 {
                let worst = &mut result.worst_relative_to_tolerance;
                *worst = worst.max(difference / tolerance);
            }
        }
    }
    Ok(result)
}

/// Everything that a text declares, in order: nothing may come with the network, such as out of a name in its header.
fn declarations(wgsl: &str) -> Result<Vec<String>, ExportError> {
    let (module, _) = parsed(wgsl)?;
    let named = |kind: &str, name: &Option<String>| {
        format!("{kind} {}", name.as_deref().unwrap_or_default())
    };
    let mut all: Vec<String> = Vec::new();
    all.extend(module.functions.iter().map(|(_, f)| named("fn", &f.name)));
    let entries = module.entry_points.iter();
    all.extend(entries.map(|e| format!("entry {}", e.name)));
    let variables = module.global_variables.iter();
    all.extend(variables.map(|(_, v)| named("var", &v.name)));
    let constants = module.constants.iter();
    all.extend(constants.map(|(_, c)| named("const", &c.name)));
    let overrides = module.overrides.iter();
    all.extend(overrides.map(|(_, o)| named("override", &o.name)));
    Ok(all)
}

fn samples(model: &Model) -> Vec<Vec<f32>> {
    let count = model.meta.inputs.len();
    let points = SelfTest::new(model).network.into_iter();
    let mut all: Vec<Vec<f32>> = points.map(|point| point.inputs).collect();
    let between = |t: f32| -> Vec<f32> {
        let inputs = model.meta.inputs.iter();
        inputs.map(|i| i.min + t * (i.max - i.min)).collect()
    };
    all.extend([0.0, 0.5, 1.0].map(between));
    let mut random = Random::new(1, &[]);
    all.extend((0..RANDOM).map(|_| {
        let inputs = model.meta.inputs.iter();
        inputs.map(|i| random.between(i.min, i.max)).collect()
    }));
    for extreme in EXTREMES {
        all.push(vec![extreme; count]);
        for k in 0..count {
            let mut sample = between(0.5);
            sample[k] = extreme;
            all.push(sample);
        }
    }
    all
}

/// Evaluates the exported function on the GPU: as many answers for each sample as the model has outputs.
///
/// # Errors
/// A text that does not link, or a GPU that fails.
pub fn evaluate(
    gpu: &Gpu,
    model: &Model,
    wgsl: &str,
    samples: &[Vec<f32>],
) -> Result<Vec<f32>, ExportError> {
    let count = model.meta.inputs.len();
    let arguments = (0..count).map(|k| format!("inputs[id.x * {count}u + {k}u]"));
    let arguments = arguments.collect::<Vec<_>>().join(", ");
    let function = function_name(model.meta.output);
    let outputs = model.meta.output.count();
    // One component after the other: an array of vec3f would have gaps.
    let components = if outputs == 1 {
        &[""][..]
    } else {
        &[".x", ".y", ".z"]
    };
    let components = components.iter().enumerate();
    let components: String = components
        .map(|(k, of)| format!("outputs[id.x * {outputs}u + {k}u] = answer{of};"))
        .collect();
    let driver = format!(
        "{wgsl}
        @group(0) @binding(0) var<storage, read> inputs: array<f32>;
        @group(0) @binding(1) var<storage, read_write> outputs: array<f32>;
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x < arrayLength(&outputs) / {outputs}u {{
                let answer = {function}({arguments});
                {components}
            }}
        }}"
    );
    parsed(&driver)?;
    let flat: Vec<f32> = samples.iter().flatten().copied().collect();
    let threads = samples.len() as u32;
    Ok(gpu.run(&driver, &flat, samples.len() * outputs, threads)?)
}

/// The description beside an exported text: its name with `json` instead of the last extension, `.es.glsl` being one. `None` of a text that
/// goes to stdout.
pub fn description_path(text: &Path) -> Option<PathBuf> {
    let stem = text.to_str().and_then(|name| name.strip_suffix(".es.glsl"));
    let path = match stem {
        Some(stem) => format!("{stem}.json").into(),
        None => text.with_extension("json"),
    };
    (text != Path::new(STDOUT)).then_some(path)
}

/// A text of another network that the description beside `text` belongs to, and that an export of this model to `text` would leave without it.
pub fn other_described(model: &Model, text: &Path) -> Result<Option<PathBuf>, ExportError> {
    let Some(description) = description_path(text) else {
        return Ok(None);
    };
    if std::fs::read_to_string(&description).ok() == Some(json(model)?) {
        return Ok(None);
    }
    let texts = Language::ALL.map(|l| description.with_extension(l.extension()));
    let is_other = |other: &PathBuf| other != text && other.exists() && description.exists();
    Ok(texts.into_iter().find(is_other))
}

/// Exports a model, verifies the text on the GPU, and only then writes it, whole, and its description beside it.
///
/// # Errors
/// A model without a shader function, a text that differs from the model, or a file that cannot be written.
pub fn export(
    gpu: &Gpu,
    model: &Model,
    path: &Path,
    options: &Options,
) -> Result<Verification, ExportError> {
    let in_wgsl = Options {
        language: Language::Wgsl,
        ..*options
    };
    let verification = verify(gpu, model, &text(model, &in_wgsl)?)?;
    let text = (path.to_owned(), text(model, options)?);
    let description = json(model)?;
    let beside = description_path(path).map(|path| (path, description));
    for (path, text) in [text].into_iter().chain(beside) {
        peelnet_core::files::write_whole(&path, text.as_bytes())
            .map_err(|e| ExportError::Refused(format!("cannot write {}: {e}", path.display())))?;
    }
    Ok(verification)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wgsl;
    use peelnet_core::mlp::{Activation, Layer, Mlp};
    use peelnet_model::Recipe;
    use peelnet_render::gpu::AdapterRequest;

    /// A random network of a recipe with these hidden layers, for inputs of small ranges.
    fn model(recipe: Recipe, hidden: &[usize], seed: u64) -> Model {
        let mut stream = Random::new(seed, &[]);
        let mut random = move || stream.between(-1.0, 1.0);
        let mut model = Model::shipped(recipe).expect("ships");
        let mut sizes = vec![model.mlp.inputs()];
        sizes.extend(hidden);
        sizes.push(model.mlp.outputs());
        let layers = sizes.windows(2).map(|s| Layer {
            inputs: s[0],
            outputs: s[1],
            weights: (0..s[0] * s[1]).map(|_| random() / s[0] as f32).collect(),
            bias: (0..s[1]).map(|_| random()).collect(),
        });
        let mut layers: Vec<_> = layers.collect();
        let ranges = [
            (6.0, 0.5, 0.1, 12.0),
            (3.0, 0.3, 0.0, 9.0),
            (8.0, 0.125, 1.0, 34.0),
        ];
        for (i, range) in model.meta.inputs.iter_mut().zip(ranges.iter().cycle()) {
            (i.offset, i.scale, i.min, i.max) = *range;
        }
        // In the middle of the guarded range, so that the guard does not hide a difference.
        if let Some(last) = layers.last_mut() {
            last.bias[0] = 0.5;
            last.weights.iter_mut().for_each(|w| *w *= 0.2);
        }
        model.mlp = Mlp::new(layers, model.mlp.hidden, model.mlp.output).expect("shapes fit");
        model
    }

    fn gpu() -> Gpu {
        Gpu::open(&AdapterRequest::Auto).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn exports_agree_for_every_topology() {
        let gpu = gpu();
        let topologies = [&[10, 8][..], &[8], &[], &[32, 16], &[5, 3, 2]];
        let thesis = topologies.map(|hidden| model(Recipe::THESIS, hidden, 7));
        let recipes = Recipe::ALL.map(|recipe| model(recipe, &[8, 8], 11));
        // A share beyond 0 … 1 is kept in it.
        let shares = [Activation::Identity, Activation::Relu].map(|output| {
            let mut model = model(Recipe::LARGE, &[8, 8], 11);
            model.mlp.output = output;
            model
        });
        for model in thesis.into_iter().chain(recipes).chain(shares) {
            let text = wgsl(&model).expect("exports");
            assert_eq!(text, wgsl(&model).expect("exports"));
            let v = verify(&gpu, &model, &text).expect("agrees");
            let differs = v.worst_relative_to_tolerance > 0.0;
            assert!(v.samples > RANDOM && differs, "{v}");
        }
    }

    fn refusal<T: fmt::Debug>(result: Result<T, ExportError>) -> String {
        result.expect_err("refused").to_string()
    }

    #[test]
    fn a_changed_weight_is_found() {
        let gpu = gpu();
        let model = model(Recipe::THESIS, &[10, 8], 3);
        let text = wgsl(&model).expect("exports");
        let mut other = model.clone();
        other.mlp.layers[1].weights[3] += 0.01;
        assert!(refusal(verify(&gpu, &other, &text)).contains("differs from the model"));
    }

    /// Half floats are written where they hold their bound, in languages that have them; a device without them says so.
    #[test]
    fn sixteen_bits_are_written_where_they_hold() {
        let gpu = gpu();
        let export = |model: &Model, language| {
            let options = Options {
                language,
                precision: Precision::F16,
            };
            text(model, &options)
        };
        let model = model(Recipe::THESIS, &[8], 3);
        for (language, word) in [
            (Language::Wgsl, "vec4h("),
            (Language::Hlsl, "half"),
            (Language::Msl, "half"),
        ] {
            let text = export(&model, language).expect("exports");
            assert!(text.contains(word), "{text}");
        }
        for language in [Language::Glsl, Language::GlslEs] {
            assert!(refusal(export(&model, language)).contains("no portable 16-bit"));
        }
        let text = export(&model, Language::Wgsl).expect("exports");
        if !gpu.has(wgpu::Features::SHADER_F16) {
            assert!(refusal(verify(&gpu, &model, &text)).contains("shader-f16"));
            return;
        }
        verify(&gpu, &model, &text).expect("agrees");
        let samples = samples(&model);
        let whole = wgsl(&model).expect("exports");
        let [halves, whole] =
            [&text, &whole].map(|t| evaluate(&gpu, &model, t, &samples).expect("runs"));
        let apart = halves.iter().zip(&whole).map(|(a, b)| (a - b).abs());
        let most = apart.fold(0.0, f32::max);
        assert!(most > EXPORT_F32 as f32, "{most}: not in 16 bits");
        let shipped = Model::shipped(Recipe::NMT).expect("ships");
        let text = export(&shipped, Language::Wgsl).expect("exports");
        assert!(refusal(verify(&gpu, &shipped, &text)).contains("differs from the model"));
    }
}
