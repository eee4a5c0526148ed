//! The exported text, run on the GPU, against the trainer's forward pass.

use crate::{
    ExportError, Precision,
    language::parsed,
    network::function_name,
    self_test::SelfTest,
    text::{code, has_halves},
};
use peelnet_core::{
    random::Random,
    tolerance::{EXPORT_F16, EXPORT_F32},
};
use peelnet_gpu::{Gpu, bind::Bind, wgpu};
use peelnet_model::Model;
use serde::Serialize;
use std::fmt;

/// Random inputs, drawn evenly from the range that training saw.
pub(crate) const RANDOM: usize = 4096;

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
        write!(
            f,
            "{} inputs agree with the model, worst difference {:.1e} ({:.0} % of the tolerance)",
            self.samples,
            self.worst_absolute,
            100.0 * self.worst_relative_to_tolerance
        )
    }
}

/// The difference that is allowed of an answer: [`EXPORT_F32`] of [`Mlp::magnitude`](peelnet_core::mlp::Mlp::magnitude). A weight `exp(−r s)` may differ as
/// much as its share may, and by [`EXPORT_F32`] more for the rounding of `r` and of the exponential.
fn tolerance(model: &Model, raw: &[f64]) -> f64 {
    let normalised: Vec<f64> = model
        .meta
        .inputs
        .iter()
        .zip(raw)
        .map(|(i, &x)| i.normalise_f64(x))
        .collect();
    let sum = EXPORT_F32 * model.mlp.magnitude(&normalised);
    if !model.meta.output.is_share() {
        return sum;
    }
    let share = model.forward_raw_f64(raw)[0];
    let weight = |share: f64| model.meta.output.transmittance(raw, share.clamp(0.0, 1.0));
    // A sigmoid's slope is at most a quarter.
    let spread = weight(share - 0.25 * sum) - weight(share + 0.25 * sum);
    EXPORT_F32 + spread.abs()
}

/// Runs `wgsl` on the GPU over random, extreme and self-test inputs and compares with [`Model::shader_output_f64`].
///
/// # Errors
/// [`ExportError::Differs`] with the worst input; a text that is not valid; a GPU that fails.
#[cfg(not(target_arch = "wasm32"))]
pub fn verify(gpu: &Gpu, model: &Model, wgsl: &str) -> Result<Verification, ExportError> {
    gpu.block_on(verify_async(gpu, model, wgsl))
}

/// [`verify()`] where nothing may block, as in a browser.
///
/// # Errors
/// Those of [`verify()`].
pub async fn verify_async(
    gpu: &Gpu,
    model: &Model,
    wgsl: &str,
) -> Result<Verification, ExportError> {
    let halves = has_halves(wgsl);
    if halves {
        let flag = wgpu::Features::SHADER_F16;
        gpu.need(flag, "shader-f16", "a text in 16 bits", "export in 32 bits")?;
    }
    let precision = if halves {
        Precision::F16
    } else {
        Precision::F32
    };
    let expected = declarations(&code(model, precision)?)?;
    let found = declarations(wgsl)?;
    if found != expected {
        return Err(ExportError::Declares {
            found: found
                .into_iter()
                .filter(|d| !expected.contains(d))
                .collect::<Vec<_>>()
                .join(", "),
        });
    }
    let samples = samples(model);
    let outputs = evaluate_async(gpu, model, wgsl, &samples).await?;
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
        for (&found, expected) in found.iter().zip(model.shader_output_f64(&raw)) {
            let tolerance = tolerance.max(EXPORT_F32 * expected.abs());
            let difference = (f64::from(found) - expected).abs();
            // A NaN compares false with everything: ask for agreement, not for disagreement.
            let agrees = difference <= tolerance;
            if !agrees {
                return Err(ExportError::Differs {
                    inputs: inputs.clone(),
                    found,
                    expected,
                    tolerance,
                });
            }
            result.worst_absolute = result.worst_absolute.max(difference);
            if tolerance > 0.0 {
                result.worst_relative_to_tolerance = result
                    .worst_relative_to_tolerance
                    .max(difference / tolerance);
            }
        }
    }
    Ok(result)
}

/// Everything that a text declares, in order: nothing may come with the network, such as out of a name in its header.
fn declarations(wgsl: &str) -> Result<Vec<String>, ExportError> {
    let (module, _) = parsed(wgsl)?;
    let name = |name: &Option<String>| name.clone().unwrap_or_default();
    let functions = module.functions.iter();
    let functions = functions.map(|(_, f)| format!("fn {}", name(&f.name)));
    let entries = module
        .entry_points
        .iter()
        .map(|e| format!("entry {}", e.name));
    let variables = module.global_variables.iter();
    let variables = variables.map(|(_, v)| format!("var {}", name(&v.name)));
    let constants = module.constants.iter();
    let constants = constants.map(|(_, c)| format!("const {}", name(&c.name)));
    let overrides = module.overrides.iter();
    let overrides = overrides.map(|(_, o)| format!("override {}", name(&o.name)));
    Ok(functions
        .chain(entries)
        .chain(variables)
        .chain(constants)
        .chain(overrides)
        .collect())
}

fn samples(model: &Model) -> Vec<Vec<f32>> {
    let count = model.meta.inputs.len();
    let points = SelfTest::of(model).network.into_iter();
    let mut all: Vec<Vec<f32>> = points.map(|point| point.inputs).collect();
    let between = |t: f32| -> Vec<f32> {
        let inputs = model.meta.inputs.iter();
        inputs.map(|i| i.min + t * (i.max - i.min)).collect()
    };
    all.extend([0.0, 0.5, 1.0].map(between));
    let mut random = Random::new(1, &[]);
    for _ in 0..RANDOM {
        let sample = model
            .meta
            .inputs
            .iter()
            .map(|i| random.between(i.min, i.max))
            .collect();
        all.push(sample);
    }
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
#[cfg(not(target_arch = "wasm32"))]
pub fn evaluate(
    gpu: &Gpu,
    model: &Model,
    wgsl: &str,
    samples: &[Vec<f32>],
) -> Result<Vec<f32>, ExportError> {
    gpu.block_on(evaluate_async(gpu, model, wgsl, samples))
}

/// [`evaluate`] where nothing may block, as in a browser.
///
/// # Errors
/// Those of [`evaluate`].
pub async fn evaluate_async(
    gpu: &Gpu,
    model: &Model,
    wgsl: &str,
    samples: &[Vec<f32>],
) -> Result<Vec<f32>, ExportError> {
    let count = model.meta.inputs.len();
    let arguments: Vec<_> = (0..count)
        .map(|k| format!("inputs[id.x * {count}u + {k}u]"))
        .collect();
    let function = function_name(model.meta.output);
    let outputs = model.meta.output.count();
    // One component after the other: an array of vec3f would have gaps.
    let components: String = (0..outputs)
        .map(|k| {
            let component = if outputs == 1 {
                ""
            } else {
                [".x", ".y", ".z"][k]
            };
            format!("outputs[id.x * {outputs}u + {k}u] = answer{component};")
        })
        .collect();
    let driver = format!(
        "{wgsl}
        @group(0) @binding(0) var<storage, read> inputs: array<f32>;
        @group(0) @binding(1) var<storage, read_write> outputs: array<f32>;
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x < arrayLength(&outputs) / {outputs}u {{
                let answer = {function}({});
                {components}
            }}
        }}",
        arguments.join(", ")
    );
    parsed(&driver)?;
    let flat: Vec<f32> = samples.iter().flatten().copied().collect();
    let inputs = gpu.upload("inputs", &flat, wgpu::BufferUsages::STORAGE);
    let bytes = (samples.len() * outputs) as u64 * 4;
    let answers = gpu.storage("outputs", bytes)?;
    let bound = gpu.bind(
        "verification",
        wgpu::ShaderStages::COMPUTE,
        &[Bind::Read(&inputs), Bind::Write(&answers)],
    );
    gpu.dispatch(
        "verification",
        &driver,
        &bound,
        (samples.len() as u32).div_ceil(64),
    );
    Ok(gpu.read_async(&answers, 0..bytes).await?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Language, Options, export, wgsl};
    use peelnet_core::mlp::{Activation, Layer, Mlp};
    use peelnet_gpu::AdapterRequest;
    use peelnet_model::{DatasetRef, Input, Losses, Metadata, Recipe};

    /// A random network of the thesis's recipe with these hidden layers.
    fn model(hidden: &[usize], seed: u64) -> Model {
        model_of(Recipe::THESIS, hidden, seed)
    }

    /// A random network of a recipe.
    fn model_of(recipe: Recipe, hidden: &[usize], seed: u64) -> Model {
        let mut stream = Random::new(seed, &[]);
        let mut random = move || stream.between(-1.0, 1.0);
        let (output, activation) = (recipe.output, recipe.network.output_activation);
        let names = recipe.input_names();
        let mut sizes = vec![names.len()];
        sizes.extend(hidden);
        sizes.push(output.count());
        let mut layers: Vec<_> = sizes
            .windows(2)
            .map(|s| Layer {
                inputs: s[0],
                outputs: s[1],
                weights: (0..s[0] * s[1]).map(|_| random() / s[0] as f32).collect(),
                bias: (0..s[1]).map(|_| random()).collect(),
            })
            .collect();
        // In the middle of the guarded range, so that the guard does not hide a difference.
        if let Some(last) = layers.last_mut() {
            last.bias[0] = 0.5;
            last.weights.iter_mut().for_each(|w| *w *= 0.2);
        }
        let inputs = names
            .iter()
            .zip(
                [
                    (6.0, 0.5, 0.1, 12.0),
                    (3.0, 0.3, 0.0, 9.0),
                    (8.0, 0.125, 1.0, 34.0),
                ]
                .into_iter()
                .cycle(),
            )
            .map(|(name, (offset, scale, min, max))| Input {
                name: (*name).to_owned(),
                unit: "1".into(),
                offset,
                scale,
                min,
                max,
            })
            .collect();
        Model {
            mlp: Mlp::new(layers, Activation::Relu, activation).expect("shapes fit"),
            meta: Metadata {
                format_version: peelnet_model::FORMAT_VERSION,
                tool_version: "test".into(),
                recipe,
                inputs,
                output,
                seed: 0,
                dataset: Some(DatasetRef {
                    hash: "0".into(),
                    rows: 1,
                    set_aside: Vec::new(),
                    scenes: vec!["sixteen".into()],
                }),
                epochs: 1,
                losses: Losses::default(),
                held_out: std::collections::BTreeMap::new(),
                config: serde_json::Value::Null,
            },
        }
    }

    fn gpu() -> Gpu {
        Gpu::open(&AdapterRequest::Auto).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn exports_agree_for_every_topology() {
        let gpu = gpu();
        let topologies = [&[10, 8][..], &[8], &[], &[32, 16], &[5, 3, 2]];
        let thesis = topologies.map(|hidden| model(hidden, 7));
        let recipes = Recipe::ALL.map(|recipe| model_of(recipe, &[8, 8], 11));
        for model in thesis.into_iter().chain(recipes) {
            let text = wgsl(&model).expect("exports");
            assert_eq!(text, wgsl(&model).expect("exports"));
            let v = verify(&gpu, &model, &text).expect("agrees");
            assert!(
                v.samples > RANDOM && v.worst_relative_to_tolerance > 0.0,
                "{v}"
            );
        }
    }

    #[test]
    fn a_changed_weight_is_found_and_nothing_is_written() {
        let gpu = gpu();
        let model = model(&[10, 8], 3);
        let text = wgsl(&model).expect("exports");
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("w.wgsl");
        let mut other = model.clone();
        other.mlp.layers[1].weights[3] += 0.01;
        assert!(matches!(
            crate::write::write_verified(&gpu, &other, &path, &Options::default(), &text),
            Err(ExportError::Differs { .. })
        ));
        assert!(!path.exists());
        export(&gpu, &model, &path, &Options::default()).expect("exports");
        assert_eq!(std::fs::read_to_string(&path).expect("reads"), text);
        // A file stands where a folder would have to be.
        let missing = path.join("w.wgsl");
        assert!(matches!(
            export(&gpu, &model, &missing, &Options::default()),
            Err(ExportError::Write { .. })
        ));
    }

    /// Half floats are written where they hold their bound, in languages that have them; a device without them says so.
    #[test]
    fn sixteen_bits_are_written_where_they_hold() {
        let gpu = gpu();
        let of = |model: &Model, language| {
            let precision = Precision::F16;
            crate::text(
                model,
                &Options {
                    language,
                    precision,
                },
            )
        };
        let model = model(&[8], 3);
        let text = of(&model, Language::Wgsl).expect("exports");
        assert!(text.contains("vec4h("), "{text}");
        for language in [Language::Hlsl, Language::Msl] {
            let text = of(&model, language).expect("exports");
            assert!(text.contains("half"), "{text}");
        }
        for language in [Language::Glsl, Language::GlslEs] {
            assert!(matches!(
                of(&model, language),
                Err(ExportError::NoHalves(_))
            ));
        }
        if !gpu.has(wgpu::Features::SHADER_F16) {
            let error = verify(&gpu, &model, &text).expect_err("the device lacks them");
            assert!(error.to_string().contains("shader-f16"), "{error}");
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
        let shipped = Model::shipped(Recipe::MEDIUM).expect("ships");
        let text = of(&shipped, Language::Wgsl).expect("exports");
        let found = verify(&gpu, &shipped, &text);
        assert!(
            matches!(found, Err(ExportError::Differs { .. })),
            "{found:?}"
        );
    }

    /// The header's vectors are what the model answers, to the bit.
    #[test]
    fn the_header_says_what_a_user_needs() {
        let model = model(&[10, 8], 5);
        let text = wgsl(&model).expect("exports");
        for word in [
            "3-10-8-1",
            "118 multiply-adds",
            "linear_depth (",
            "rg16float",
            "MIT OR Apache-2.0",
        ] {
            assert!(text.contains(word), "{word} in {text}");
        }
        let tests: Vec<_> = text
            .lines()
            .filter(|l| l.starts_with("// peelnet_weight("))
            .collect();
        assert_eq!(tests.len(), 3);
        for line in tests {
            let (call, answer) = line.rsplit_once(" = ").expect("a vector");
            let inputs: Vec<f32> = call[call.find('(').expect("open") + 1..call.len() - 1]
                .split(", ")
                .map(|x| x.parse().expect("a number"))
                .collect();
            let answer: f32 = answer.parse().expect("a number");
            assert_eq!(answer.to_bits(), model.shader_output(&inputs)[0].to_bits());
        }
    }
}
