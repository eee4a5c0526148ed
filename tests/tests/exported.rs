//! Exported texts: the committed ones are what the exporter writes, who draws as a description says gets the colour that the self-test
//! names, and GLSL answers what the network answers. Frames drawn with WGSL texts are compared in `references`.
//!
//! The compilers that users have are asked by `cargo xtask languages`.

use naga::{
    ShaderStage,
    back::wgsl,
    front::glsl,
    valid::{Capabilities, ValidationFlags, Validator},
};
use peelnet_core::random::Random;
use peelnet_export::{Blend, Description, Language, Options, SelfTest, Target, verify};
use peelnet_model::{Model, Recipe};
use peelnet_render::gpu::Gpu;
use peelnet_tests::{assert_near, gpu, shipped};
use std::{fs, path::Path};

/// What engines are given is what the renderer draws with. `PEELNET_UPDATE=1` writes the texts anew.
#[test]
fn committed_texts_are_what_is_exported_today() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let is_current = |file: &Path, text: &str| {
        let committed = fs::read_to_string(file).unwrap();
        let hint = "run this test with PEELNET_UPDATE=1";
        assert!(committed == text, "{}: {hint}", file.display());
    };
    for recipe in Recipe::ALL {
        let model = shipped(recipe);
        let folder = models.join(recipe.to_string());
        for language in Language::ALL {
            let file = folder.join(format!("model.{}", language.extension()));
            let options = options(language);
            if std::env::var_os("PEELNET_UPDATE").is_some() {
                peelnet_export::export(&gpu(), &model, &file, &options).unwrap();
            }
            is_current(&file, &peelnet_export::text(&model, &options).unwrap());
        }
        let json = peelnet_export::json(&model).unwrap();
        is_current(&folder.join("model.json"), &json);
    }
}

/// The GPU computes in 32 bits what the self-test computed in 64: logarithms, exponentials and sums of four.
const SOME_ROUNDINGS: f32 = 1e-4;

fn channels(target: &Target) -> (usize, &'static str) {
    match target.format.split(|c: char| c.is_ascii_digit()).next() {
        Some("r") => (1, "f32"),
        Some("rg") => (2, "vec2f"),
        _ => (4, "vec4f"),
    }
}

/// A target before anything is drawn.
fn declared(target: &Target) -> String {
    let (n, kind) = channels(target);
    let clear = target.clear[..n].iter().map(|c| format!("f32({c})"));
    let clear: Vec<String> = clear.collect();
    format!("    var {} = {kind}({});\n", target.name, clear.join(", "))
}

/// A target after one more fragment.
fn blended(target: &Target) -> String {
    let (name, (n, _)) = (target.name, channels(target));
    let mut text = format!("        let written_{name} = {};\n", target.write);
    for (k, channel) in [".x", ".y", ".z", ".w"].iter().take(n).enumerate() {
        let channel = if n == 1 { "" } else { channel };
        let [dst, src] = ["", "written_"].map(|of| format!("{of}{name}{channel}"));
        let value = match if k == 3 { target.alpha } else { target.color } {
            Blend::Add => format!("{dst} + {src}"),
            Blend::Max => format!("max({dst}, {src})"),
            Blend::Transmit => format!("{dst} * (1.0 - {src})"),
        };
        text += &format!("        {dst} = {value};\n");
    }
    text
}

#[test]
fn descriptions_lead_to_the_colour_of_the_self_test() {
    let gpu = gpu();
    let mut drawn = 0;
    for recipe in Recipe::ALL {
        let model = shipped(recipe);
        let Some(pixel) = SelfTest::new(&model).pixel else {
            continue;
        };
        let text = peelnet_export::wgsl(&model).unwrap();
        verify(&gpu, &model, &text).unwrap();
        let description = Description::new(recipe);
        let (near, far) = (pixel.near, pixel.far);
        let zeta = format!("let zeta = peelnet_zeta(z, f32({near}), f32({far}));");
        let has_zeta = text.contains("fn peelnet_zeta(");
        let zeta = if has_zeta { &zeta } else { "" };
        let reads_around = text.contains("fn peelnet_even(");
        let around = "let quantiles = peelnet_even();\n    let noise = 0.5;";
        let around = if reads_around { around } else { "" };
        let mut body = String::new();
        for pass in description.passes {
            body.extend(pass.targets.iter().map(declared));
            // Any order will do: here the farthest comes first.
            for f in pixel.fragments.iter().rev() {
                let compute = pass.compute.map(|value| value.to_string());
                let compute = compute.unwrap_or_default();
                let blended: String = pass.targets.iter().map(blended).collect();
                let [r, g, b] = f.rgb.map(|c| format!("f32({c})"));
                body += &format!(
                    "    {{\n        let z = f32({});\n        let alpha = f32({});\n        let rgb = vec3f({r}, {g}, {b});
        {zeta}\n        {compute}\n{blended}    }}\n",
                    f.z, f.alpha
                );
            }
        }
        let [r, g, b] = pixel.background.map(|c| format!("f32({c})"));
        let resolve = description.resolve;
        let program = format!(
            "{text}
@group(0) @binding(0) var<storage, read> unused: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> answers: array<vec4f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {{
    if id.x >= arrayLength(&answers) {{ return; }}
    {around}
{body}
    let background = vec3f({r}, {g}, {b}) + 0.0 * unused[0].xyz;
    answers[id.x] = {resolve};
}}"
        );
        let found: Vec<[f32; 4]> = gpu.run(&program, &[[0f32; 4]], 1, 1).unwrap();
        assert_near(found[0], pixel.color, SOME_ROUNDINGS, recipe);
        drawn += 1;
    }
    // All but the one that predicts colours.
    assert_eq!(drawn, Recipe::ALL.len() - 1);
}

fn options(language: Language) -> Options {
    Options {
        language,
        ..Options::default()
    }
}

/// The same function of the same numbers, compiled twice, in different orders of operations.
const SAME_TEXT: f32 = 1e-5;

/// Answers of the network's function in a GLSL text, one for each row of inputs and each output.
fn evaluate(gpu: &Gpu, model: &Model, text: &str, rows: &[Vec<f32>]) -> Vec<f32> {
    let inputs = model.meta.inputs.len();
    let outputs = model.meta.output.count();
    let arguments: Vec<String> = (0..inputs)
        .map(|k| format!("inputs[id * {inputs}u + {k}u]"))
        .collect();
    let arguments = arguments.join(", ");
    let body = if outputs == 1 {
        format!("outputs[id] = peelnet_weight({arguments});")
    } else {
        format!(
            "vec3 answer = peelnet_color({arguments});
            outputs[id * 3u] = answer.x;
            outputs[id * 3u + 1u] = answer.y;
            outputs[id * 3u + 2u] = answer.z;"
        )
    };
    let source = format!(
        "#version 450
        layout(local_size_x = 64) in;
        layout(set = 0, binding = 0) readonly buffer Inputs {{ float inputs[]; }};
        layout(set = 0, binding = 1) buffer Outputs {{ float outputs[]; }};
        {text}
        void main() {{
            uint id = gl_GlobalInvocationID.x;
            if (id < {count}u) {{
                {body}
            }}
        }}",
        count = rows.len()
    );
    let options = glsl::Options::from(ShaderStage::Compute);
    let module = glsl::Frontend::default().parse(&options, &source);
    let module = module.unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).unwrap();
    let read_back = wgsl::write_string(&module, &info, wgsl::WriterFlags::empty()).unwrap();
    let mut flat: Vec<f32> = rows.iter().flatten().copied().collect();
    flat.resize(flat.len().next_multiple_of(4), 0.0);
    let (quads, _) = flat.as_chunks::<4>();
    let count = rows.len() * outputs;
    gpu.run(&read_back, quads, count, count as u32).unwrap()
}

#[test]
fn glsl_texts_answer_what_the_network_answers() {
    let gpu = gpu();
    let mut random = Random::new(61, &[]);
    for recipe in Recipe::ALL {
        let model = shipped(recipe);
        let points = SelfTest::new(&model).network;
        assert!(!points.is_empty(), "{recipe}");
        let mut rows: Vec<Vec<f32>> = points.into_iter().map(|p| p.inputs).collect();
        for _ in 0..500 {
            let inputs = model.meta.inputs.iter();
            rows.push(inputs.map(|i| random.between(i.min, i.max)).collect());
        }
        for language in [Language::Glsl, Language::GlslEs] {
            let text = peelnet_export::text(&model, &options(language)).unwrap();
            let found = evaluate(&gpu, &model, &text, &rows);
            let want: Vec<f32> = rows.iter().flat_map(|r| model.shader_output(r)).collect();
            assert_eq!(found.len(), want.len());
            for (found, want) in found.iter().zip(&want) {
                let error = (found - want).abs();
                let bound = SAME_TEXT * want.abs().max(1.0) * 4.0;
                assert!(error <= bound, "{recipe}, {language}: {found} for {want}");
            }
        }
    }
}
