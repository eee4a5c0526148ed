//! Links the WGSL of `shaders/` into one module, and checks it.
//!
//! Shaders are written as modules that `import` one another and switch parts with `@if(feature)`, so that a helper
//! exists once and a pass contains only what its scene needs. [`link`] turns a root module into plain WGSL text;
//! it is the only place that knows the linker (WESL). Text that is not in the repository — an exported network, a
//! method's constants — joins as an extra module. [`validate`] runs naga over the result.

pub use naga;
pub use peelnet_shaders::SOURCES;

use crate::gpu::locked;
use std::{
    borrow::Cow,
    cell::RefCell,
    collections::{BTreeSet, HashMap},
    sync::{Arc, LazyLock, Mutex},
};
use wesl::{EscapeMangler, Mangler as _, ModulePath, VirtualResolver, Wesl};

/// Why a shader could not be made: a path that is no module's, what the linker refused, or what naga refused with its source lines.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ShaderError(String);

impl ShaderError {
    pub(crate) const fn new(message: String) -> Self {
        Self(message)
    }
}

fn no_module(path: &str) -> ShaderError {
    ShaderError(format!(
        "'{path}' is not a shader module path such as methods::wboit::gather"
    ))
}

/// The text of a module as it stands in its file.
///
/// # Errors
/// A module that is not in [`SOURCES`].
pub fn source(path: &str) -> Result<&'static str, ShaderError> {
    let found = SOURCES.iter().find(|(p, _)| *p == path);
    found.map(|(_, text)| *text).ok_or_else(|| no_module(path))
}

thread_local! {
    /// The module that has another text on this thread, and that text.
    static ALTERED: RefCell<Option<(String, String)>> = const { RefCell::new(None) };
}

/// Runs `work` with another text in place of one of the repository's modules, in all that this thread links meanwhile: for tests that change
/// a shader and look whether it shows. Not to be nested.
#[doc(hidden)]
pub fn with_altered<T>(path: &str, text: &str, work: impl FnOnce() -> T) -> T {
    ALTERED.set(Some((path.to_owned(), text.to_owned())));
    let done = work();
    ALTERED.set(None);
    done
}

/// A shader's number in this process: equal for equal modules, features and texts, so that it stands for the text in keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShaderId(u32);

/// A linked shader.
#[derive(Debug)]
pub struct Shader {
    /// See [`ShaderId`].
    pub id: ShaderId,
    /// The root module.
    pub name: String,
    /// Plain WGSL.
    pub text: String,
    /// The resources that it declares.
    pub bindings: Vec<Binding>,
}

/// A resource that a shader declares.
#[derive(Debug)]
pub struct Binding {
    /// The bind group.
    pub group: u32,
    /// The number in it.
    pub number: u32,
    /// The variable.
    pub name: String,
    /// Its address space and access, as in `<storage, read>`; empty of textures and samplers.
    pub space: String,
}

/// All that decides a linked shader's text.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct ShaderKey {
    root: String,
    /// In alphabetical order.
    features: BTreeSet<String>,
    /// Paths and texts of modules that are not in the repository; of equal paths, the last counts.
    modules: Vec<(String, String)>,
}

/// Links `root` (a path such as `methods::wboit::gather`) with the given features on and extra modules in place.
///
/// Linking is deterministic, so its results are kept for the life of the process.
///
/// # Errors
/// An unknown module, a missing import, or WGSL that does not parse.
pub fn link(
    root: &str,
    features: &[&str],
    extra: &[(&str, &str)],
) -> Result<Arc<Shader>, ShaderError> {
    let altered = ALTERED.with_borrow(Clone::clone).into_iter();
    let owned = |&(path, text): &(&str, &str)| (path.to_owned(), text.to_owned());
    let key = ShaderKey {
        root: root.to_owned(),
        features: features.iter().map(|&f| f.to_owned()).collect(),
        modules: altered.chain(extra.iter().map(owned)).collect(),
    };
    interned(key, link_uncached)
}

/// A shader whose text is complete.
pub fn plain(name: &str, text: &str) -> Arc<Shader> {
    let key = ShaderKey {
        root: name.to_owned(),
        features: BTreeSet::new(),
        modules: vec![(String::new(), text.to_owned())],
    };
    let linked = |_: &ShaderKey| Ok((text.to_owned(), Vec::new()));
    interned(key, linked).expect("nothing is linked")
}

type Linked = (String, Vec<Binding>);

/// The shader of a key, linked where it is not known.
fn interned(
    key: ShaderKey,
    link: impl FnOnce(&ShaderKey) -> Result<Linked, ShaderError>,
) -> Result<Arc<Shader>, ShaderError> {
    static KNOWN: LazyLock<Mutex<HashMap<ShaderKey, Arc<Shader>>>> =
        LazyLock::new(Default::default);
    if let Some(shader) = locked(&KNOWN).get(&key) {
        return Ok(shader.clone());
    }
    // Linking takes long: the lock is not held meanwhile, and the first of two equal shaders stays.
    let (text, bindings) = link(&key)?;
    let mut known = locked(&KNOWN);
    let shader = Arc::new(Shader {
        id: ShaderId(known.len() as u32),
        name: key.root.clone(),
        text,
        bindings,
    });
    Ok(known.entry(key).or_insert(shader).clone())
}

fn link_uncached(key: &ShaderKey) -> Result<Linked, ShaderError> {
    let mut resolver = VirtualResolver::new();
    let modules = key.modules.iter().map(|(p, t)| (p.as_str(), t.as_str()));
    for (path, text) in SOURCES.iter().copied().chain(modules) {
        resolver.add_module(module_path(path)?, Cow::Borrowed(text));
    }
    let mut linker = Wesl::new_barebones().set_custom_resolver(resolver);
    let mut options = wesl::CompileOptions {
        validate: false,
        ..Default::default()
    };
    options.features.default = wesl::Feature::Disable;
    let on = key.features.iter().cloned();
    let on = on.map(|feature| (feature, wesl::Feature::Enable));
    options.features.flags.extend(on);
    linker
        .set_options(options)
        .set_mangler(wesl::ManglerKind::Escape);
    let root = &key.root;
    let linked = linker.compile(&module_path(root)?);
    let linked = linked.map_err(|e| ShaderError(format!("linking shader {root} failed:\n{e}")))?;
    let text = linked.to_string();
    let bindings = bindings(&text);
    Ok((text, bindings))
}

/// The resources that a linked text declares, as `@group(1) @binding(0) var<storage, read> name: …`.
fn bindings(text: &str) -> Vec<Binding> {
    let number = |text: &str, word: &str| -> Option<u32> {
        let (_, rest) = text.rsplit_once(word)?;
        rest.split_once(')')?.0.trim().parse().ok()
    };
    let binding = |statement: &str| {
        let (attributes, variable) = statement.rsplit_once(':')?.0.rsplit_once("var")?;
        let at = variable.rfind(['>', ' '])? + 1;
        let (space, name) = variable.split_at(at);
        // Of another module than the root.
        let imported = name
            .starts_with("package_")
            .then(|| EscapeMangler.unmangle(name));
        let name = imported
            .flatten()
            .map_or_else(|| name.to_owned(), |(_, item)| item);
        Some(Binding {
            group: number(attributes, "@group(")?,
            number: number(attributes, "@binding(")?,
            name,
            space: space.trim().to_owned(),
        })
    };
    text.split(';').filter_map(binding).collect()
}

fn module_path(path: &str) -> Result<ModulePath, ShaderError> {
    format!("package::{path}")
        .parse()
        .map_err(|_| no_module(path))
}

/// What of naga's capabilities every WebGPU device has: WGSL's own `pack2x16float`, which only old OpenGL lacks.
pub const PORTABLE: naga::valid::Capabilities =
    naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;

/// Parses and validates WGSL with naga, with these capabilities. Returns naga's module and what it knows of it.
///
/// # Errors
/// Text that naga refuses, with the source lines that it points at.
pub fn validate(
    label: &str,
    wgsl: &str,
    capabilities: naga::valid::Capabilities,
) -> Result<(naga::Module, naga::valid::ModuleInfo), ShaderError> {
    let invalid = |message| ShaderError(format!("shader {label} is not valid WGSL:\n{message}"));
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|e| invalid(e.emit_to_string(wgsl)))?;
    let info = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|e| invalid(e.emit_to_string(wgsl)))?;
    Ok((module, info))
}

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_scene::{EFFECTS, MaterialFlags};

    /// A shipped network of the methods in a folder.
    fn learned(folder: &str, features: &[&str]) -> &'static str {
        let name = match folder {
            "methods::deep_thesis" => "thesis",
            "methods::nmt" => "nmt",
            "methods::dfaoit" => "dfaoit",
            "methods::slabs" | "methods::splat" => {
                let layouts = ["small", "medium"];
                let layout = layouts.into_iter().find(|l| features.contains(l));
                layout.unwrap_or("large")
            }
            "methods::one" if features.contains(&"wide") => "one-wide",
            "methods::one" | "passes::tiles" => "one",
            _ if features.contains(&"separate_ends") => "anchored-medium",
            _ => "anchored-small",
        };
        peelnet_shipped_networks::find(name).expect("ships").wgsl
    }

    /// Stand-ins for the constants that methods write: whole numbers, which take the type that is needed.
    fn parameters() -> String {
        let imports = SOURCES.iter().flat_map(|(_, text)| text.lines());
        let names: BTreeSet<&str> = imports
            .filter_map(|line| line.trim().strip_prefix("import package::parameters::"))
            .flat_map(words)
            .collect();
        let constants = names.iter().map(|name| format!("const {name} = 4;\n"));
        constants.collect()
    }

    /// Features that materials need: each effect's alone, on a lit surface where it needs that, and all of them with either
    /// model of lighting.
    fn of_materials() -> Vec<Vec<&'static str>> {
        let models = [MaterialFlags::PHONG, MaterialFlags::PBR];
        let alone = EFFECTS.iter().map(|effect| {
            let is_lit = effect.flag.needs_light() && !models.contains(&effect.flag);
            let model = is_lit.then_some(MaterialFlags::PBR);
            effect.flag | model.unwrap_or_default()
        });
        let all = models.map(|model| {
            let others = EFFECTS.iter().filter(|e| !models.contains(&e.flag));
            let clear = model | MaterialFlags::CLEAR_MAP;
            others.fold(clear, |all, effect| all | effect.flag)
        });
        let flags = alone.chain(all).map(MaterialFlags::with_implied);
        flags.map(MaterialFlags::features).collect()
    }

    /// The sets of features that a shader is linked with, by the line `// Variants: a | b c | none` at its head; only one without
    /// any where it has no such line. Features of materials and views are not among them.
    fn variants(text: &'static str) -> Vec<Vec<&'static str>> {
        let mut lines = text.lines().take_while(|line| line.starts_with("//"));
        let line = lines.find_map(|line| line.strip_prefix("// Variants: "));
        line.unwrap_or("none")
            .split('|')
            .map(|set| set.split_whitespace().filter(|f| *f != "none").collect())
            .collect()
    }

    /// Features that a view may bring to any pass over surfaces.
    const OF_VIEWS: [&[&str]; 4] = [&[], &["opaque"], &["sampled"], &["opaque", "sampled"]];

    /// Words of a text that features, loops and parameters are found by.
    fn words(text: &'static str) -> impl Iterator<Item = &'static str> {
        let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        words.filter(|word| !word.is_empty())
    }

    /// Features that a text switches on, but for those of materials and views.
    fn own_features(text: &'static str) -> BTreeSet<&'static str> {
        let conditions = text.split("@if(").skip(1);
        let conditions = conditions.filter_map(|t| t.split(')').next());
        let of_views = OF_VIEWS.into_iter().flatten().copied();
        let of_scenes = of_materials().into_iter().flatten().chain(of_views);
        let of_scenes: Vec<_> = of_scenes.chain(["numbered", "material"]).collect();
        let all = conditions.flat_map(words);
        all.filter(|f| !of_scenes.contains(f)).collect()
    }

    /// Every root (a module with an entry point) links and validates in every variant that its head names, with every material
    /// and view; all failures are reported at once.
    #[test]
    fn every_shader_links_and_validates() {
        let parameters = parameters();
        let mut failures = Vec::new();
        let mut roots = 0;
        for (path, text) in SOURCES {
            let entries = ["@vertex", "@fragment", "@compute"];
            if !entries.iter().any(|s| text.contains(s)) {
                continue;
            }
            roots += 1;
            let own = variants(text);
            for feature in own_features(text) {
                if !own.iter().flatten().any(|f| *f == feature) {
                    failures.push(format!(
                        "{path}: no variant has the feature {feature}; name one at the head of the file, as in // Variants: none | {feature}"
                    ));
                }
            }
            let carried: &[&str] = match text.contains("Surface") {
                true => &["numbered", "material"],
                false => &[],
            };
            let with = |set: &[&'static str], more: &[&'static str]| [set, more, carried].concat();
            let views = own
                .iter()
                .flat_map(|set| OF_VIEWS.map(|view| with(set, view)));
            let mut all: Vec<Vec<&str>> = views.collect();
            if text.contains("surface: Surface") || text.contains("-> Surface") {
                all.extend(of_materials().iter().map(|m| with(&own[0], m)));
            }
            let folder = path.rsplit_once("::").map_or("", |(folder, _)| folder);
            for features in all {
                let extra = [
                    ("learned::weight", learned(folder, &features)),
                    ("parameters", parameters.as_str()),
                ];
                let linked = link(path, &features, &extra);
                let valid = linked.and_then(|shader| validate(path, &shader.text, PORTABLE));
                if let Err(e) = valid {
                    failures.push(format!("{path} {features:?}: {e}"));
                }
            }
        }
        assert!(roots >= 20, "only {roots} shaders found");
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }

    /// The head of a shader says how many loops it has, and why a scene cannot make them long, as in `// Loops: 1: at most 16 samples.`: some
    /// drivers end loops of more than 65,535 iterations without an error, and watchdogs end what takes long.
    #[test]
    fn every_loop_has_a_bound() {
        let is_loop = |word: &&str| ["for", "while", "loop"].contains(word);
        let code = |line: &'static str| line.split("//").next().unwrap_or_default();
        for (path, text) in SOURCES {
            let code = text.lines().map(code);
            let found = code.flat_map(words).filter(is_loop).count();
            let said = text.lines().find_map(|l| l.strip_prefix("// Loops: "));
            let (loops, bound) = said.and_then(|l| l.split_once(": ")).unwrap_or_default();
            let loops = loops.parse().unwrap_or(0);
            assert_eq!((loops, bound.is_empty()), (found, found == 0), "{path}");
        }
    }

    #[test]
    fn a_missing_import_is_named() {
        let e = link("methods::deep_thesis::gather", &[], &[]).expect_err("no learned module");
        assert!(e.to_string().contains("learned"), "{e}");
    }

    #[test]
    fn features_switch_bindings_off() {
        let plain = link("peel::count", &[], &[]).expect("links");
        assert!(!plain.text.contains("opaque_depth"));
        let opaque = link("peel::count", &["opaque"], &[]).expect("links");
        assert!(opaque.text.contains("opaque_depth"));
        let names = |shader: &Shader| -> Vec<_> {
            let of_pass = shader.bindings.iter().filter(|b| b.group == 1);
            of_pass.map(|b| (b.number, b.name.clone())).collect()
        };
        assert_eq!(names(&plain), [(0, "counts".to_owned())]);
        assert_eq!(names(&opaque), names(&plain));
        assert_ne!(plain.id, opaque.id);
        assert_eq!(plain.id, link("peel::count", &[], &[]).expect("links").id);
    }
}
