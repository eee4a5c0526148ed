//! Which features a pass's shader needs of a material, found in naga's module of the linked text.
//!
//! A pass is linked with all features of a material's variant first. What its functions then do not read is switched off, and the pass
//! linked again: a pass without colour fetches no normals, UVs or textures.

use crate::geometry::RenderError;
use crate::shaders::naga;
use std::{
    collections::{BTreeSet, HashMap},
    sync::{Mutex, PoisonError},
};

/// Stands for textures among the members of `Surface`.
const TEXTURES: &str = "any texture";

/// Members of `Surface` and textures, and the features that only serve them.
const NEEDS: [(&[&str], &[&str]); 5] = [
    (&["triangle"], &["numbered"]),
    (&["material", "material_color"], &["material"]),
    (&["color"], &["vertex_colors"]),
    (
        &["world"],
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
        &[TEXTURES],
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

/// Links a fragment shader with those of `features` that it needs. Returns the features left and the text.
pub(crate) fn link<'a>(
    shader: &str,
    mut features: Vec<&'a str>,
    extra: &[(&str, &str)],
) -> Result<(Vec<&'a str>, String), RenderError> {
    features.extend(["numbered", "material"]);
    let text = crate::shaders::link(shader, &features, extra)?;
    let reads = reads(shader, &text)?;
    let before = features.len();
    for (read, serving) in NEEDS {
        if !read.iter().any(|&member| reads.contains(member)) {
            features.retain(|f| !serving.contains(f));
        }
    }
    if features.len() == before {
        return Ok((features, text));
    }
    let text = crate::shaders::link(shader, &features, extra)?;
    Ok((features, text))
}

/// The members of `Surface` that a text's fragment entry point reads, and [`TEXTURES`] where it samples any. Texts are few and asked for
/// often: what is known is kept.
fn reads(label: &str, text: &str) -> Result<BTreeSet<String>, RenderError> {
    static KNOWN: Mutex<Option<HashMap<String, BTreeSet<String>>>> = Mutex::new(None);
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(reads) = known().get_or_insert_default().get(text) {
        return Ok(reads.clone());
    }
    let (module, info) = crate::shaders::validate(label, text, crate::shaders::PORTABLE)?;
    let reads = of_module(&module, &info);
    known()
        .get_or_insert_default()
        .insert(text.to_owned(), reads.clone());
    Ok(reads)
}

fn of_module(module: &naga::Module, info: &naga::valid::ModuleInfo) -> BTreeSet<String> {
    let mut reads = BTreeSet::new();
    for (number, entry) in module.entry_points.iter().enumerate() {
        if entry.stage != naga::ShaderStage::Fragment {
            continue;
        }
        let own = info.get_entry_point(number);
        reads.extend((!own.sampling_set.is_empty()).then(|| TEXTURES.to_owned()));
        // The linker may have renamed it, but it is what the entry point is given.
        let given = entry.function.arguments.iter().map(|a| a.ty);
        let is_struct = |ty| matches!(module.types[ty].inner, naga::TypeInner::Struct { .. });
        let Some(surface) = given.into_iter().find(|&ty| is_struct(ty)) else {
            continue;
        };
        members_read(module, own, &entry.function, surface, &mut reads);
        // The linker leaves out what is not called.
        for (handle, function) in module.functions.iter() {
            members_read(module, &info[handle], function, surface, &mut reads);
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
            // surface.world
            @fragment fn main(surface: Surface) -> @location(0) vec4f {
                let other = Other(1.0);
                return vec4f(other.world, surface.depth, 0.0, 1.0);
            }";
        let found = reads("commented", commented).expect("valid");
        assert_eq!(found, BTreeSet::from(["depth".to_owned()]));
    }
}
