//! Links the WGSL of `shaders/` into one module, and checks it.
//!
//! Shaders are written as modules that `import` one another and switch parts with `@if(feature)`, so that a helper
//! exists once and a pass contains only what its scene calls for. [`link`] turns a root module into plain WGSL text;
//! it is the only place that knows the linker (WESL). Text that is not in the repository — an exported network, a
//! method's constants — joins as an extra module. [`validate`] runs naga over the result.

pub use peelnet_wgsl::SOURCES;

use std::{
    borrow::Cow,
    collections::HashMap,
    sync::{Mutex, PoisonError},
};
use wesl::{ModulePath, VirtualResolver, Wesl};

/// Why a shader could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ShaderError {
    /// A module path that cannot be parsed.
    #[error("'{0}' is not a shader module path such as methods::wboit::gather")]
    Path(String),
    /// The linker refused.
    #[error("linking shader {root} failed:\n{message}")]
    Link {
        /// The root module.
        root: String,
        /// The linker's message.
        message: String,
    },
    /// naga refused the linked text.
    #[error("shader {label} is not valid WGSL:\n{message}")]
    Invalid {
        /// Name of the shader.
        label: String,
        /// naga's message with source lines.
        message: String,
    },
}

/// The text of a module as it stands in its file.
///
/// # Errors
/// [`ShaderError::Path`] for a module that is not in [`SOURCES`].
pub fn source(path: &str) -> Result<&'static str, ShaderError> {
    SOURCES
        .iter()
        .find(|(p, _)| *p == path)
        .map(|(_, text)| *text)
        .ok_or_else(|| ShaderError::Path(path.to_owned()))
}

/// Everything that decides a linked text.
type LinkKey = (String, Vec<String>, Vec<(String, String)>);

/// Links `root` (a path such as `methods::wboit::gather`) with the given features on and extra modules in place.
///
/// Linking is deterministic, so its results are kept for the life of the process.
///
/// # Errors
/// An unknown module, a missing import, or WGSL that does not parse.
pub fn link(root: &str, features: &[&str], extra: &[(&str, &str)]) -> Result<String, ShaderError> {
    static LINKED: Mutex<Option<HashMap<LinkKey, String>>> = Mutex::new(None);
    let key: LinkKey = (
        root.to_owned(),
        features.iter().map(|&f| f.to_owned()).collect(),
        extra
            .iter()
            .map(|&(p, t)| (p.to_owned(), t.to_owned()))
            .collect(),
    );
    if let Some(text) = LINKED
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .get_or_insert_default()
        .get(&key)
    {
        return Ok(text.clone());
    }
    let text = link_uncached(root, features, extra)?;
    LINKED
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .get_or_insert_default()
        .insert(key, text.clone());
    Ok(text)
}

fn link_uncached(
    root: &str,
    features: &[&str],
    extra: &[(&str, &str)],
) -> Result<String, ShaderError> {
    let mut resolver = VirtualResolver::new();
    for (path, text) in SOURCES.iter().chain(extra) {
        resolver.add_module(module_path(path)?, Cow::Borrowed(text));
    }
    let mut linker = Wesl::new_barebones().set_custom_resolver(resolver);
    let mut options = wesl::CompileOptions {
        validate: false,
        ..Default::default()
    };
    options.features.default = wesl::Feature::Disable;
    for feature in features {
        options
            .features
            .flags
            .insert((*feature).to_owned(), wesl::Feature::Enable);
    }
    linker
        .set_options(options)
        .set_mangler(wesl::ManglerKind::Escape);
    let text = linker
        .compile(&module_path(root)?)
        .map_err(|e| ShaderError::Link {
            root: root.to_owned(),
            message: e.to_string(),
        })?
        .to_string();
    Ok(text)
}

fn module_path(path: &str) -> Result<ModulePath, ShaderError> {
    format!("package::{path}")
        .parse()
        .map_err(|_| ShaderError::Path(path.to_owned()))
}

/// Parses and validates WGSL with naga, with the portable capabilities and those given.
///
/// # Errors
/// [`ShaderError::Invalid`] with the source lines naga points at.
pub fn validate(
    label: &str,
    wgsl: &str,
    capabilities: naga::valid::Capabilities,
) -> Result<naga::Module, ShaderError> {
    let invalid = |message: String| ShaderError::Invalid {
        label: label.to_owned(),
        message,
    };
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|e| invalid(e.emit_to_string(wgsl)))?;
    naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|e| invalid(e.emit_to_string(wgsl)))?;
    Ok(module)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stand-in for a network that was exported for the methods in `folder`.
    fn learned(folder: &str) -> String {
        let (modules, parameters): (&[&str], &str) = match folder {
            "methods::deep_thesis" => (&["learned::thesis"], "a: f32, b: f32, c: f32"),
            "methods::nmt" => (
                &["learned::nmt", "learned::fragment_nmt"],
                "a: f32, b: f32, c: f32, d: f32, e: f32, f: f32, g: f32",
            ),
            "methods::dfaoit" => (&["learned::dfaoit"], ""),
            _ => (
                &["learned::anchored", "learned::fragment_medium"],
                "a: f32, b: f32, c: f32, d: f32, e: f32",
            ),
        };
        let texts: Vec<_> = modules
            .iter()
            .map(|m| source(m).expect("a module of the table"))
            .collect();
        format!(
            "{}\nfn peelnet_weight({parameters}) -> f32 {{ return 1.0; }}
            fn peelnet_share({parameters}) -> f32 {{ return 1.0; }}
            fn peelnet_tail_color(a: f32, b: f32, c: f32, d: f32, e: f32, f: f32, g: f32, h: f32, i: f32, j: f32) -> vec3f {{
                return vec3f(1.0);
            }}\n",
            texts.join("\n")
        )
    }

    const PARAMETERS: &str = "const FACTOR: f32 = 3e3;\nconst POWER: u32 = 2u;\nconst EPSILON: f32 = 5.0;\nconst BIAS: f32 = 5e-7;\nconst OVERESTIMATION: f32 = 0.25;\nconst K: u32 = 4u;\nconst SAMPLES: u32 = 8u;\nconst HIGHLIGHT: f32 = 1.0;\nconst HIGHLIGHT_SHARE: f32 = 0.5;\n";

    /// What materials call for: alone, and all of it.
    const MATERIALS: [&[&str]; 10] = [
        &["lit", "phong"],
        &["lit", "pbr"],
        &["lit", "pbr", "sun"],
        &["emission"],
        &["cutout"],
        &["vertex_colors"],
        &["mapped", "color_map"],
        &["mapped", "color_map", "clear_map"],
        &["transmission"],
        &[
            "lit",
            "pbr",
            "sun",
            "emission",
            "cutout",
            "vertex_colors",
            "mapped",
            "color_map",
            "clear_map",
            "normal_map",
            "metallic_roughness_map",
            "occlusion_map",
            "emissive_map",
            "transmission",
        ],
    ];

    /// What the colours of a scene call for, and where.
    fn of_colors(path: &str) -> &'static [&'static str] {
        match path {
            "methods::wboit::gather" | "methods::wboit::resolve" | "methods::blended::gather" => {
                &["packed", "tinted"]
            }
            "methods::abuffer::composite"
            | "peel::sort"
            | "methods::linked_list::build"
            | "methods::linked_list::composite"
            | "methods::mboit4::gather"
            | "methods::mboit4::resolve"
            | "methods::mboit6::gather"
            | "methods::anchored::gather"
            | "methods::anchored::resolve" => &["tinted"],
            "peel::store" => &["tinted", "layered", "dataset"],
            "methods::layers::composite" => &["increasing"],
            _ => &[],
        }
    }

    /// Every root (a module with an entry point) links and validates in every feature it names; all failures are
    /// reported at once.
    #[test]
    fn every_shader_links_and_validates() {
        let mut failures = Vec::new();
        let mut roots = 0;
        for (path, text) in SOURCES {
            if !["@vertex", "@fragment", "@compute"]
                .iter()
                .any(|s| text.contains(s))
            {
                continue;
            }
            roots += 1;
            let mut variants: Vec<Vec<&str>> = if *path == "methods::wboit::gather" {
                ["eq7", "eq8", "eq9", "eq10", "inverse_power", "papakostas"]
                    .map(|w| vec![w, "opaque"])
                    .to_vec()
            } else if *path == "methods::kbuffer::gather" {
                ["unweighted", "eq7", "eq8", "eq9"]
                    .map(|w| vec![w, "opaque"])
                    .to_vec()
            } else if ["mboit4", "mboit6", "wavelet"]
                .iter()
                .any(|m| *path == format!("methods::{m}::gather"))
            {
                vec![vec![], vec!["own_share_out", "opaque"]]
            } else if path.starts_with("methods::anchored") {
                vec![
                    vec![],
                    vec!["separate_ends"],
                    vec!["separate_ends", "opaque"],
                    vec!["separate_ends", "tinted"],
                ]
            } else {
                vec![
                    vec![],
                    vec!["opaque"],
                    vec!["sampled"],
                    vec!["opaque", "sampled"],
                ]
            };
            // Which triangle a fragment belongs to, where a shader asks.
            for variant in &mut variants {
                variant.extend(text.contains("surface: Surface").then_some("numbered"));
            }
            let first = variants[0].clone();
            let with = |more: &[&'static str]| [first.as_slice(), more].concat();
            if text.contains("surface: Surface") || text.contains("-> Surface") {
                variants.extend(MATERIALS.map(with));
            }
            variants.extend(of_colors(path).iter().map(|feature| with(&[*feature])));
            for features in variants {
                let learned = learned(path.rsplit_once("::").map_or("", |(folder, _)| folder));
                let extra = [
                    ("learned::weight", learned.as_str()),
                    ("parameters", PARAMETERS),
                ];
                let result = link(path, &features, &extra).and_then(|wgsl| {
                    validate(path, &wgsl, naga::valid::Capabilities::empty()).map(drop)
                });
                if let Err(e) = result {
                    failures.push(format!("{path} {features:?}: {e}"));
                }
            }
        }
        assert!(roots >= 20, "only {roots} shaders found");
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }

    #[test]
    fn a_missing_import_is_named() {
        let e = link("methods::deep_thesis::gather", &[], &[]).expect_err("no learned module");
        assert!(e.to_string().contains("learned"), "{e}");
    }

    #[test]
    fn features_switch_bindings_off() {
        let plain = link("peel::count", &[], &[]).expect("links");
        assert!(!plain.contains("opaque_depth"));
        assert!(
            link("peel::count", &["opaque"], &[])
                .expect("links")
                .contains("opaque_depth")
        );
    }
}
