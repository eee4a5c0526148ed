//! The shader texts around an exported network, written from its description.
//!
//! `draw.wesl` is the module that materials import. One function of it serves all passes: `PEELNET_PASS_<number>` says which one is compiled. The
//! names of targets, the statements and the expressions are those of `model.json`.

use crate::model::{PeelnetModel, Target};
use std::fmt::Write as _;

/// The bind group of the statistics: the one after Bevy's view, light probes, meshes and materials.
pub(crate) const GROUP: usize = 4;

/// The definition that says which pass a shader is compiled for.
pub(crate) fn pass_define(pass: usize) -> String {
    format!("PEELNET_PASS_{pass}")
}

/// The binding of a target in the bind groups of passes, and in that of the resolve.
pub(crate) fn binding(target: usize) -> u32 {
    // 0 is the range of depths. A network has a handful of targets.
    1 + u32::try_from(target).unwrap_or(u32::MAX)
}

/// The type of a target's texels, and how they are taken out of four channels.
fn type_of(target: &Target) -> (&'static str, &'static str) {
    match target.format.components() {
        1 => ("f32", ".x"),
        2 => ("vec2f", ".xy"),
        _ => ("vec4f", ""),
    }
}

/// Reads targets into variables of their names. The last argument is the sample of a multisampled texture, and the level of another, where it is 0.
fn reads(model: &PeelnetModel, targets: &[usize], indent: &str) -> String {
    targets.iter().fold(String::new(), |mut text, &index| {
        let target = &model.targets[index];
        let (name, (_, channels)) = (&target.name, type_of(target));
        let _ = writeln!(
            text,
            "{indent}let {name} = textureLoad(peelnet_target_{name}, peelnet_at, peelnet_sample){channels};"
        );
        text
    })
}

/// The module `bevy_peelnet::draw`.
pub(crate) fn draw_text(model: &PeelnetModel) -> String {
    let mut text =
        String::from("import bevy_pbr::render::view_transformations::depth_ndc_to_view_z;\n\n");
    text.push_str(&model.wgsl);
    let _ = write!(
        text,
        "\n// Written by bevy_peelnet from the description of this network.\n
// Near and far of the transparent surfaces in view, and the distance that both are counted from.
@group({GROUP}) @binding(0) var<uniform> peelnet_depths: vec4f;
"
    );
    for (index, target) in model.targets.iter().enumerate() {
        let (name, binding) = (&target.name, binding(index));
        for (condition, kind) in [
            ("MULTISAMPLED", "texture_multisampled_2d"),
            ("!MULTISAMPLED", "texture_2d"),
        ] {
            let _ = writeln!(
                text,
                "@if({condition})\n@group({GROUP}) @binding({binding}) var peelnet_target_{name}: {kind}<f32>;"
            );
        }
    }
    text.push_str("\n// What a material's fragment shader returns in the pass that it is compiled for.\nstruct PeelnetOutput {\n");
    for (number, pass) in model.passes.iter().enumerate() {
        for (location, target) in model.targets[pass.targets.clone()].iter().enumerate() {
            let (define, name) = (pass_define(number), &target.name);
            let (kind, _) = type_of(target);
            let _ = writeln!(
                text,
                "    @if({define})\n    @location({location}) {name}: {kind},"
            );
        }
    }
    text.push_str(
        "}

// position: the fragment shader's. color: what the material's fragment shader returns elsewhere, for its alpha mode. In passes without
// PEELNET_NEEDS_COLOR its rgb may be anything, without PEELNET_NEEDS_ALPHA all of it.
fn peelnet_output(position: vec4f, sample_index: u32, color: vec4f) -> PeelnetOutput {
    let distance = -depth_ndc_to_view_z(position.z) - peelnet_depths.z;
    let zeta = peelnet_zeta(distance, peelnet_depths.x, peelnet_depths.y);
    let alpha = clamp(color.a, 0.0, 1.0);
@if(BLEND_PREMULTIPLIED_ALPHA)
    let rgb = color.rgb / max(alpha, 1e-6);
@if(!BLEND_PREMULTIPLIED_ALPHA)
    let rgb = color.rgb;
    let peelnet_at = vec2i(position.xy);
    let peelnet_sample = i32(sample_index);
    var peelnet_out: PeelnetOutput;
",
    );
    for (number, pass) in model.passes.iter().enumerate() {
        let _ = writeln!(text, "@if({}) {{", pass_define(number));
        text.push_str(&reads(model, &pass.reads, "    "));
        if !pass.compute.is_empty() {
            let _ = writeln!(text, "    {}", pass.compute);
        }
        for target in &model.targets[pass.targets.clone()] {
            let _ = writeln!(text, "    peelnet_out.{} = {};", target.name, target.write);
        }
        text.push_str("}\n");
    }
    text.push_str("    return peelnet_out;\n}\n");
    text
}

/// The full-screen shader that composites a pixel's sums, or a sample's. Its answer is premultiplied by coverage, for blending over the opaque scene.
pub(crate) fn resolve_text(model: &PeelnetModel, multisampled: bool) -> String {
    let mut text = model.wgsl.to_string();
    text.push_str("\n// Written by bevy_peelnet from the description of this network.\n\n");
    let kind = if multisampled {
        "texture_multisampled_2d"
    } else {
        "texture_2d"
    };
    for &index in &model.resolve_reads {
        let (name, binding) = (&model.targets[index].name, binding(index));
        let _ = writeln!(
            text,
            "@group(0) @binding({binding}) var peelnet_target_{name}: {kind}<f32>;"
        );
    }
    let (parameter, sample) = if multisampled {
        (
            ", @builtin(sample_index) sample_index: u32",
            "i32(sample_index)",
        )
    } else {
        ("", "0")
    };
    let _ = write!(
        text,
        "
@fragment
fn peelnet_resolve_pixel(@builtin(position) position: vec4f{parameter}) -> @location(0) vec4f {{
    let peelnet_at = vec2i(position.xy);
    let peelnet_sample = {sample};
{}    let background = vec3f(0.0);
    return {};
}}
",
        reads(model, &model.resolve_reads, "    "),
        model.resolve
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pass_reads_and_writes_what_the_description_says() {
        let text = draw_text(&PeelnetModel::medium());
        for line in [
            "let range = textureLoad(peelnet_target_range, peelnet_at, peelnet_sample).xy;",
            "let s = peelnet_statistics(alpha, zeta, range);",
            "peelnet_out.nearest = s.nearest;",
            "peelnet_out.sums = vec4f(alpha * rgb, alpha) * w;",
        ] {
            assert!(text.contains(line), "{line}\n{text}");
        }
    }

    #[test]
    fn samples_are_resolved_one_by_one() {
        let model = PeelnetModel::medium();
        let one = resolve_text(&model, false);
        let four = resolve_text(&model, true);
        assert!(!one.contains("sample_index"));
        assert!(four.contains("@builtin(sample_index)") && four.contains("i32(sample_index)"));
        assert!(four.contains("return peelnet_resolve(sums, absorbances.x"));
    }
}
