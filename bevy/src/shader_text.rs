//! The shader texts around an exported network, written from its description.
//!
//! `draw.wesl` is the module that materials import. One function of it serves all passes: `PEELNET_PASS_<number>` says which one is compiled. The
//! names of targets, the statements and the expressions are those of `model.json`.

use crate::{
    group::{FIRST_BINDING, GROUP},
    model::{Around, PeelnetModel, Target},
};
use std::fmt::Write as _;

/// The definition that says which pass a shader is compiled for.
pub(crate) fn pass_define(pass: usize) -> String {
    format!("PEELNET_PASS_{pass}")
}

/// The type of a target's texels, and how they are taken out of four channels.
fn type_of(target: &Target) -> (&'static str, &'static str) {
    match target.format.components() {
        1 => ("f32", ".x"),
        2 => ("vec2f", ".xy"),
        _ => ("vec4f", ""),
    }
}

/// The network's own text, and the targets as textures of a bind group.
fn network_text(model: &PeelnetModel, group: usize) -> String {
    let mut text = format!(
        "{}\n// Written by bevy_peelnet from the description of this network.\n\n",
        model.wgsl
    );
    let mut declare = |condition: &str, binding, variable: &str, kind: &str| {
        let _ = writeln!(
            text,
            "@if({condition})\n@group({group}) @binding({binding}) var {variable}: {kind};"
        );
    };
    for (Target { name, .. }, every) in model.targets() {
        let (binding, variable) = (model.binding(name), format!("peelnet_target_{name}"));
        if every > 1 {
            declare("true", binding, &variable, "texture_2d<f32>");
            continue;
        }
        for (condition, kind) in [
            ("MULTISAMPLED", "texture_multisampled_2d<f32>"),
            ("!MULTISAMPLED", "texture_2d<f32>"),
        ] {
            declare(condition, binding, &variable, kind);
        }
    }
    if let Some(Around { name, .. }) = &model.description.around {
        let binding = model.binding(name);
        declare("true", binding, "peelnet_around", "texture_2d<f32>");
        let binding = model.sampler_binding();
        declare("true", binding, "peelnet_bilinear", "sampler");
        let binding = model.depth_binding();
        for (condition, kind) in [
            ("MULTISAMPLED", "texture_depth_multisampled_2d"),
            ("!MULTISAMPLED", "texture_depth_2d"),
        ] {
            declare(condition, binding, "peelnet_depth", kind);
        }
    }
    text
}

/// Reads targets into variables of their names, and says what else a network's calls name. The last argument is the sample of a multisampled texture, and the level of another, where it is 0.
fn reads(model: &PeelnetModel, names: &[String]) -> String {
    let targets = model.targets().filter(|(t, _)| names.contains(&t.name));
    let lines = targets.map(|(target, _)| {
        let (name, (_, channels)) = (&target.name, type_of(target));
        format!(
            "    let {name} = textureLoad(peelnet_target_{name}, peelnet_at, peelnet_sample){channels};\n"
        )
    });
    let mut text: String = lines.collect();
    if let Some(Around { name, every, .. }) = &model.description.around
        && names.contains(name)
    {
        let _ = writeln!(
            text,
            "    let {name} = textureSampleLevel(peelnet_around, peelnet_bilinear, position.xy / ({every}.0 * vec2f(textureDimensions(peelnet_around))), 0.0);"
        );
    }
    if model.wgsl.contains("fn peelnet_noise(") {
        text.push_str("    let noise = peelnet_noise(vec2u(peelnet_at));\n");
    }
    text
}

/// The module `bevy_peelnet::draw`.
pub(crate) fn draw_text(model: &PeelnetModel) -> String {
    let mut text = format!(
        "import bevy_pbr::render::view_transformations::depth_ndc_to_view_z;

{}
// Near and far of the transparent surfaces in view, the distance that both are counted from, and the coverage from which depth is written.
@group({GROUP}) @binding({FIRST_BINDING}) var<storage> peelnet_depths: vec4f;

// What a material's fragment shader returns in the pass that it is compiled for.
struct PeelnetOutput {{
",
        network_text(model, GROUP)
    );
    for (number, pass) in model.passes().enumerate() {
        if pass.writes_depth {
            let _ = writeln!(
                text,
                "    @if({})\n    @builtin(frag_depth) depth: f32,",
                pass_define(number)
            );
        }
        for (location, target) in pass.targets.iter().enumerate() {
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
    for (number, pass) in model.passes().enumerate() {
        let _ = writeln!(text, "@if({}) {{", pass_define(number));
        if pass.is_small() {
            let every = pass.every;
            let _ = writeln!(
                text,
                "    // What hides a fragment is at the pixel that is looked at.
    let peelnet_looked = min({every} * peelnet_at + {}, vec2i(textureDimensions(peelnet_depth)) - 1);
    if position.z < textureLoad(peelnet_depth, peelnet_looked, 0) {{
        discard;
    }}",
                every / 2
            );
        }
        text.push_str(&reads(model, &pass.reads));
        if let Some(compute) = &pass.compute {
            let _ = writeln!(text, "    {compute}");
        }
        for target in &pass.targets {
            let _ = writeln!(text, "    peelnet_out.{} = {};", target.name, target.write);
        }
        if pass.writes_depth {
            text.push_str("    peelnet_out.depth = position.z;\n");
        }
        text.push_str("}\n");
    }
    text.push_str("    return peelnet_out;\n}\n");
    text
}

/// The full-screen shader of the small texture: each texel from the nine around it.
pub(crate) fn around_text(model: &PeelnetModel) -> String {
    let Some(around) = &model.description.around else {
        return String::new();
    };
    let lines = around.pass.targets.iter().map(|target| {
        let (name, (_, channels)) = (&target.name, type_of(target));
        format!("            let {name} = textureLoad(peelnet_target_{name}, at, 0){channels};\n")
    });
    format!(
        "{}
@fragment
fn peelnet_texel(@builtin(position) position: vec4f) -> @location(0) vec4f {{
    let last = vec2i(textureDimensions(peelnet_target_{})) - 1;
    var sum = mat4x4f();
    for (var y = -1; y <= 1; y++) {{
        for (var x = -1; x <= 1; x++) {{
            let at = clamp(vec2i(position.xy) + vec2i(x, y), vec2i(0), last);
{}            sum += {};
        }}
    }}
    return {};
}}
",
        network_text(model, 0),
        around.pass.targets[0].name,
        lines.collect::<String>(),
        around.sum,
        around.write
    )
}

/// The full-screen shader that composites a pixel's sums, or a sample's. Its colour is premultiplied by coverage, for blending over the opaque scene;
/// coverage by itself is the mask.
pub(crate) fn resolve_text(model: &PeelnetModel) -> String {
    format!(
        "{}
struct PeelnetPixel {{
    @location(0) color: vec4f,
@if(PEELNET_MASK)
    @location(1) mask: f32,
}}

@fragment
fn peelnet_resolve_pixel(
    @builtin(position) position: vec4f,
@if(MULTISAMPLED)
    @builtin(sample_index) sample_index: u32,
) -> PeelnetPixel {{
@if(!MULTISAMPLED)
    let sample_index = 0u;
    let peelnet_at = vec2i(position.xy);
    let peelnet_sample = i32(sample_index);
{}    let background = vec3f(0.0);
    var pixel: PeelnetPixel;
    pixel.color = {};
@if(PEELNET_MASK)
    pixel.mask = pixel.color.a;
    return pixel;
}}
",
        network_text(model, 0),
        reads(model, &model.description.resolve_reads),
        model.description.resolve
    )
}
