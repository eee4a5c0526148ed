//! Who draws as a description says gets the colour that the exported self-test names.

use peelnet_export::{Blend, Description, Drawn, SelfTest, Target};
use peelnet_model::Recipe;
use peelnet_tests::{gpu, run_text, shipped};
use std::fmt::Write as _;

/// The GPU computes in 32 bits what the self-test computed in 64: logarithms, exponentials and sums of four.
const SOME_ROUNDINGS: f32 = 1e-4;

fn channels(target: &Target) -> usize {
    match target.format.split(|c: char| c.is_ascii_digit()).next() {
        Some("r") => 1,
        Some("rg") => 2,
        _ => 4,
    }
}

fn kind(channels: usize) -> String {
    if channels == 1 {
        "f32".into()
    } else {
        format!("vec{channels}f")
    }
}

/// A target before anything is drawn.
fn declared(target: &Target) -> String {
    let n = channels(target);
    let clear = target.clear[..n].iter().map(|c| format!("f32({c})"));
    let clear: Vec<String> = clear.collect();
    format!(
        "    var {} = {}({});\n",
        target.name,
        kind(n),
        clear.join(", ")
    )
}

/// A target after one more fragment.
fn blended(target: &Target) -> String {
    let (name, n) = (target.name, channels(target));
    let channel = |k: usize| match n {
        1 => String::new(),
        _ => format!(".{}", ["x", "y", "z", "w"][k]),
    };
    let mut text = format!("        let written_{name} = {};\n", target.write);
    for k in 0..n {
        let (dst, src) = (
            format!("{name}{}", channel(k)),
            format!("written_{name}{}", channel(k)),
        );
        let blend = if k == 3 { target.alpha } else { target.color };
        let value = match blend {
            Blend::Add => format!("{dst} + {src}"),
            Blend::Max => format!("max({dst}, {src})"),
            Blend::Transmit => format!("{dst} * (1.0 - {src})"),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "        {dst} = {value};");
    }
    text
}

fn fragment(f: &Drawn, zeta: &str) -> String {
    let [r, g, b] = f.rgb.map(|c| format!("f32({c})"));
    format!(
        "        let z = f32({});\n        let alpha = f32({});\n        let rgb = vec3f({r}, {g}, {b});\n        {zeta}\n",
        f.z, f.alpha
    )
}

#[test]
fn descriptions_lead_to_the_colour_of_the_self_test() {
    let gpu = gpu();
    let mut drawn = 0;
    for recipe in Recipe::ALL {
        let model = shipped(recipe);
        let Some(pixel) = SelfTest::of(&model).pixel else {
            continue;
        };
        let text = peelnet_export::wgsl(&model).unwrap();
        let description = Description::of(recipe);
        let zeta = if text.contains("fn peelnet_zeta(") {
            format!(
                "let zeta = peelnet_zeta(z, f32({}), f32({}));",
                pixel.near, pixel.far
            )
        } else {
            String::new()
        };
        let mut body = String::new();
        for pass in description.passes {
            body.extend(pass.targets.iter().map(declared));
            // Any order will do: here the farthest comes first.
            for f in pixel.fragments.iter().rev() {
                let compute = pass
                    .compute
                    .map_or_else(String::new, |value| value.to_string());
                let blended: String = pass.targets.iter().map(blended).collect();
                let begin = fragment(f, &zeta);
                let _ = writeln!(body, "    {{\n{begin}        {compute}\n{blended}    }}");
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
{body}
    let background = vec3f({r}, {g}, {b}) + 0.0 * unused[0].xyz;
    answers[id.x] = {resolve};
}}"
        );
        let found: Vec<[f32; 4]> = run_text(&gpu, &program, &[[0.0; 4]], 1);
        for (found, want) in found[0].iter().zip(&pixel.color) {
            assert!(
                (found - want).abs() < SOME_ROUNDINGS,
                "{recipe}: {found} for {want}"
            );
        }
        drawn += 1;
    }
    assert_eq!(
        drawn,
        Recipe::ALL.len() - 1,
        "all but the one that predicts colours"
    );
}
