//! Exported texts in GLSL, read back by naga's own front end and run: a translation that loses something answers otherwise.
//!
//! The compilers that users have are asked by `cargo xtask languages`.

use naga::{
    ShaderStage,
    back::wgsl,
    front::glsl,
    valid::{Capabilities, ValidationFlags, Validator},
};
use peelnet_core::random::Random;
use peelnet_export::{Language, Options, SelfTest};
use peelnet_gpu::{Gpu, bind::Bind, wgpu};
use peelnet_model::{Model, Recipe};
use peelnet_tests::{gpu, shipped};

fn of(language: Language) -> Options {
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
    let flat: Vec<f32> = rows.iter().flatten().copied().collect();
    let given = gpu.upload("inputs", &flat, wgpu::BufferUsages::STORAGE);
    let bytes = (rows.len() * outputs * size_of::<f32>()) as u64;
    let answers = gpu.storage("outputs", bytes).unwrap();
    let stages = wgpu::ShaderStages::COMPUTE;
    let bound = gpu.bind(
        "languages",
        stages,
        &[Bind::Read(&given), Bind::Write(&answers)],
    );
    let groups = (rows.len() as u32).div_ceil(64);
    gpu.dispatch("languages", &read_back, &bound, groups);
    gpu.read(&answers, 0..bytes).unwrap()
}

#[test]
fn glsl_texts_answer_what_the_network_answers() {
    let gpu = gpu();
    let mut random = Random::new(61, &[]);
    for recipe in Recipe::ALL {
        let model = shipped(recipe);
        let points = SelfTest::of(&model).network;
        assert!(!points.is_empty(), "{recipe}");
        let mut rows: Vec<Vec<f32>> = points.into_iter().map(|p| p.inputs).collect();
        for _ in 0..500 {
            let inputs = model.meta.inputs.iter();
            rows.push(inputs.map(|i| random.between(i.min, i.max)).collect());
        }
        for language in [Language::Glsl, Language::GlslEs] {
            let text = peelnet_export::text(&model, &of(language)).unwrap();
            let found = evaluate(&gpu, &model, &text, &rows);
            let want: Vec<f32> = rows.iter().flat_map(|r| model.shader_output(r)).collect();
            assert_eq!(found.len(), want.len());
            for (found, want) in found.iter().zip(&want) {
                let bound = SAME_TEXT * want.abs().max(1.0) * 4.0;
                assert!(
                    (found - want).abs() <= bound,
                    "{recipe}, {language}: {found} for {want}"
                );
            }
        }
    }
}

/// The functions keep their names in every language, and so do the names by which a description calls targets and values.
#[test]
fn names_survive() {
    for recipe in Recipe::ALL {
        let model = shipped(recipe);
        for language in Language::ALL {
            let text = peelnet_export::text(&model, &of(language)).unwrap();
            let code: Vec<&str> = text.lines().filter(|l| !l.starts_with("//")).collect();
            let code = code.join("\n");
            for name in ["peelnet_statistics(", "peelnet_resolve("] {
                assert!(code.contains(name), "{recipe}, {language}: {name}");
            }
            assert!(!code.contains("void main"), "{recipe}, {language}");
            assert!(!code.contains("peelnet_entry"), "{recipe}, {language}");
            assert!(!code.contains("#version"), "{recipe}, {language}");
        }
    }
}
