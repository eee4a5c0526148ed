//! Which features a pass's shader needs of a material, found in naga's module of the linked text.
//!
//! A pass is linked with all features of a material's variant first. What its entry point then does not read, directly or through
//! the functions that it calls, is switched off, and the pass linked again: a pass without colour fetches no normals, UVs or textures.

use crate::RasterError;
use peelnet_shaders::naga;
use std::{
    collections::{BTreeSet, HashMap},
    sync::{Mutex, PoisonError},
};

/// What a fragment shader reads of the surface it is given, and of the world.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Reads {
    /// Members of the struct that the entry point is given.
    pub surface: BTreeSet<String>,
    /// Whether any texture is sampled.
    pub textures: bool,
}

/// What depends on a member of `Surface` or on textures, and the features that only serve it.
const NEEDS: [(Need, &[&str]); 5] = [
    (Need::Surface(&["triangle"]), &["numbered"]),
    (
        Need::Surface(&["material", "material_color"]),
        &["material"],
    ),
    (Need::Surface(&["color"]), &["vertex_colors"]),
    (
        Need::Surface(&["world"]),
        &[
            "lit",
            "phong",
            "pbr",
            "sun",
            "normal_map",
            "metallic_roughness_map",
            "occlusion_map",
        ],
    ),
    (
        Need::Textures,
        &[
            "mapped",
            "color_map",
            "normal_map",
            "metallic_roughness_map",
            "occlusion_map",
            "emissive_map",
        ],
    ),
];

#[derive(Clone, Copy)]
enum Need {
    /// Any of these members.
    Surface(&'static [&'static str]),
    Textures,
}

/// Links a fragment shader with those of `features` that it needs. Returns the features left and the text.
pub(crate) fn link<'a>(
    shader: &str,
    mut features: Vec<&'a str>,
    extra: &[(&str, &str)],
) -> Result<(Vec<&'a str>, String), RasterError> {
    features.extend(["numbered", "material"]);
    let text = peelnet_shaders::link(shader, &features, extra)?;
    let reads = reads(shader, &text)?;
    let before = features.len();
    for (need, serving) in NEEDS {
        let read = match need {
            Need::Surface(members) => members.iter().any(|&m| reads.surface.contains(m)),
            Need::Textures => reads.textures,
        };
        if !read {
            features.retain(|f| !serving.contains(f));
        }
    }
    if features.len() == before {
        return Ok((features, text));
    }
    let text = peelnet_shaders::link(shader, &features, extra)?;
    Ok((features, text))
}

/// What a text's fragment entry point reads. Texts are few and asked for often: what is known is kept.
pub(crate) fn reads(label: &str, text: &str) -> Result<Reads, RasterError> {
    static KNOWN: Mutex<Option<HashMap<String, Reads>>> = Mutex::new(None);
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(reads) = known().get_or_insert_default().get(text) {
        return Ok(reads.clone());
    }
    let (module, info) = peelnet_shaders::validate(label, text, peelnet_shaders::PORTABLE)?;
    let reads = of_module(&module, &info);
    known()
        .get_or_insert_default()
        .insert(text.to_owned(), reads.clone());
    Ok(reads)
}

fn of_module(module: &naga::Module, info: &naga::valid::ModuleInfo) -> Reads {
    let mut reads = Reads::default();
    for (number, entry) in module.entry_points.iter().enumerate() {
        if entry.stage != naga::ShaderStage::Fragment {
            continue;
        }
        let own = info.get_entry_point(number);
        reads.textures |= !own.sampling_set.is_empty();
        // The linker may have renamed it, but it is what the entry point is given.
        let given = entry.function.arguments.iter().map(|a| a.ty);
        let is_struct = |ty| matches!(module.types[ty].inner, naga::TypeInner::Struct { .. });
        let Some(surface) = given.into_iter().find(|&ty| is_struct(ty)) else {
            continue;
        };
        members_read(module, own, &entry.function, surface, &mut reads.surface);
        let mut called = BTreeSet::new();
        calls(module, &entry.function.body, &mut called);
        for function in called {
            members_read(
                module,
                &info[function],
                &module.functions[function],
                surface,
                &mut reads.surface,
            );
        }
    }
    reads
}

/// Adds the members of the struct `surface` that a function's expressions access.
fn members_read(
    module: &naga::Module,
    info: &naga::valid::FunctionInfo,
    function: &naga::Function,
    surface: naga::Handle<naga::Type>,
    members: &mut BTreeSet<String>,
) {
    for (_, expression) in function.expressions.iter() {
        let naga::Expression::AccessIndex { base, index } = *expression else {
            continue;
        };
        let types = &module.types;
        let handle = match (&info[base].ty, info[base].ty.inner_with(types)) {
            (_, naga::TypeInner::Pointer { base, .. }) => *base,
            (naga::proc::TypeResolution::Handle(handle), _) => *handle,
            _ => continue,
        };
        if let (true, naga::TypeInner::Struct { members: all, .. }) =
            (handle == surface, &types[handle].inner)
        {
            members.extend(all.get(index as usize).and_then(|m| m.name.clone()));
        }
    }
}

/// Adds the functions that a block calls, and those that they call.
fn calls(
    module: &naga::Module,
    block: &naga::Block,
    called: &mut BTreeSet<naga::Handle<naga::Function>>,
) {
    use naga::Statement as S;
    for statement in block {
        match statement {
            S::Call { function, .. } if called.insert(*function) => {
                calls(module, &module.functions[*function].body, called);
            }
            S::Block(block) => calls(module, block, called),
            S::If { accept, reject, .. } => {
                calls(module, accept, called);
                calls(module, reject, called);
            }
            S::Switch { cases, .. } => {
                for case in cases {
                    calls(module, &case.body, called);
                }
            }
            S::Loop {
                body, continuing, ..
            } => {
                calls(module, body, called);
                calls(module, continuing, called);
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [&str; 10] = [
        "lit",
        "pbr",
        "sun",
        "mapped",
        "color_map",
        "clear_map",
        "normal_map",
        "metallic_roughness_map",
        "occlusion_map",
        "vertex_colors",
    ];

    /// A pass that counts reads none of the surface's looks; one that peels reads colour and triangle; one that sums, colour alone. A
    /// word in a comment or of another struct is no read.
    #[test]
    fn passes_need_what_they_read() {
        let needed = |shader: &str| link(shader, ALL.to_vec(), &[]).expect("links").0;
        assert_eq!(needed("peel::count"), ["clear_map"]);
        assert!(needed("peel::store").contains(&"material"));
        let peel = needed("peel::single");
        assert!(peel.contains(&"numbered") && peel.contains(&"normal_map"));
        let sums = needed("methods::weighted_sum::gather");
        assert!(!sums.contains(&"numbered") && sums.contains(&"lit"));
        let commented = "struct Surface { @location(0) world: vec3f, @location(1) depth: f32 }
            struct Other { world: f32 }
            fn unused(surface: Surface) -> f32 { return surface.world.x; }
            // surface.world
            @fragment fn main(surface: Surface) -> @location(0) vec4f {
                let other = Other(1.0);
                return vec4f(other.world, surface.depth, 0.0, 1.0);
            }";
        let found = reads("commented", commented).expect("valid");
        assert_eq!(found.surface, BTreeSet::from(["depth".to_owned()]));
        assert!(!found.textures);
    }
}
