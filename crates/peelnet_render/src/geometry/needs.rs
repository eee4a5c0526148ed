//! What a geometry pass reads of a surface, and the shader features that follow from it: a pass without colour fetches no normals, UVs or
//! textures. What passes say is compared with naga's reflection of their shaders in a test.

use crate::geometry::GeometryPass;
use crate::shaders::{self, ShaderError, naga};
use std::{cell::RefCell, collections::BTreeSet};

bitflags::bitflags! {
    /// What a pass reads of a surface besides where it is.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub struct Needs: u8 {
        /// Nothing: its position and depth alone.
        const DEPTH = 0;
        /// The number of its triangle.
        const TRIANGLE = 1;
        /// The number of its material.
        const MATERIAL = 1 << 1;
        /// How much it covers.
        const OPACITY = 1 << 2 | 1 << 1;
        /// Its radiance.
        const COLOR = 1 << 3 | 1 << 2 | 1 << 1;
    }
}

impl Needs {
    /// The features of a pass's shader for a material that needs these.
    pub(crate) fn features(self, material: &[&'static str]) -> Vec<&'static str> {
        // Holes are where opacity is low.
        let has_holes = material.contains(&"cutout") || material.contains(&"splat");
        let needs = match has_holes {
            true => self | Self::OPACITY,
            false => self,
        };
        // Textures that opacity is read from.
        let mapped = material.contains(&"clear_map")
            || material.contains(&"transmission") && material.contains(&"color_map");
        let serves = |feature: &&str| match *feature {
            "cutout" | "clear_map" | "vertex_colors" | "emission" | "transmission" | "splat" => {
                needs.contains(Self::OPACITY)
            }
            "mapped" | "color_map" => {
                needs.contains(Self::COLOR) || mapped && needs.contains(Self::OPACITY)
            }
            _ => needs.contains(Self::COLOR),
        };
        let of_material = material.iter().copied().filter(serves);
        let numbered = needs.contains(Self::TRIANGLE).then_some("numbered");
        let named = needs.contains(Self::MATERIAL).then_some("material");
        let is_seen = material.contains(&"splat") && needs.contains(Self::COLOR);
        let colored = is_seen.then_some("splat_color");
        (of_material.chain(numbered).chain(named))
            .chain(colored)
            .collect()
    }
}

thread_local! {
    /// While passes are compared: what is wrong with them, and how many there are.
    static COMPARED: RefCell<Option<(BTreeSet<String>, usize)>> = const { RefCell::new(None) };
}

/// Does `work`, and compares what each geometry pass that is built meanwhile on this thread says that it needs with what naga finds that
/// its shader reads: for tests. Returns a line for each pass that says otherwise, and the number of passes.
#[doc(hidden)]
pub fn compare_needs(work: impl FnOnce()) -> (BTreeSet<String>, usize) {
    COMPARED.set(Some(Default::default()));
    work();
    COMPARED.take().unwrap_or_default()
}

/// Compares a pass, where passes are compared.
pub(crate) fn compare(pass: &GeometryPass<'_>) -> Result<(), ShaderError> {
    if COMPARED.with_borrow(Option::is_none) {
        return Ok(());
    }
    // With everything that a material can have: what is read then shows what the pass needs.
    let all = ["numbered", "material", "lit", "pbr", "vertex_colors"];
    let linked = shaders::link(pass.shader, &[pass.features, &all].concat(), pass.extra)?;
    let (module, info) = shaders::validate(pass.shader, &linked.text, shaders::PORTABLE)?;
    let reads = of_module(&module, &info);
    let members = [
        (Needs::TRIANGLE, "triangle"),
        (Needs::MATERIAL, "material"),
        (Needs::OPACITY, "color"),
        (Needs::COLOR, "world"),
    ];
    let differ = members.map(|(need, member)| {
        let says = match (pass.needs.contains(need), reads.contains(member)) {
            (true, false) => "says",
            (false, true) => "does not say",
            _ => return None,
        };
        Some(format!("{} {says} that it reads {member}", pass.shader))
    });
    COMPARED.with_borrow_mut(|compared| {
        if let Some((faults, passes)) = compared {
            faults.extend(differ.into_iter().flatten());
            *passes += 1;
        }
    });
    Ok(())
}

/// The members of `Surface` that a module's functions read. The linker leaves out what is not called.
fn of_module(module: &naga::Module, info: &naga::valid::ModuleInfo) -> BTreeSet<String> {
    let entries = (module.entry_points.iter().enumerate())
        .map(|(number, entry)| (&entry.function, info.get_entry_point(number)));
    let others = module.functions.iter();
    let others = others.map(|(handle, function)| (function, &info[handle]));
    let mut members = BTreeSet::new();
    for (function, info) in entries.chain(others) {
        for (_, expression) in function.expressions.iter() {
            let naga::Expression::AccessIndex { base, index } = *expression else {
                continue;
            };
            let accessed = match info[base].ty.inner_with(&module.types) {
                naga::TypeInner::Pointer { base, .. } => &module.types[*base],
                _ => match info[base].ty.handle() {
                    Some(handle) => &module.types[handle],
                    None => continue,
                },
            };
            // The linker puts the module's path before the name.
            let is_surface = accessed
                .name
                .as_ref()
                .is_some_and(|n| n.ends_with("Surface"));
            if let (true, naga::TypeInner::Struct { members: all, .. }) =
                (is_surface, &accessed.inner)
            {
                members.extend(all[index as usize].name.clone());
            }
        }
    }
    members
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [&str; 12] = [
        "lit",
        "pbr",
        "sun",
        "emission",
        "mapped",
        "color_map",
        "clear_map",
        "normal_map",
        "metallic_roughness_map",
        "occlusion_map",
        "emissive_map",
        "vertex_colors",
    ];

    #[test]
    fn features_follow_from_needs() {
        assert_eq!(Needs::DEPTH.features(&ALL), [""; 0]);
        assert_eq!(Needs::TRIANGLE.features(&ALL), ["numbered"]);
        let opacity = [
            "emission",
            "mapped",
            "color_map",
            "clear_map",
            "vertex_colors",
            "material",
        ];
        assert_eq!(Needs::OPACITY.features(&ALL), opacity);
        let opaque_map = ["lit", "mapped", "color_map"];
        assert_eq!(Needs::OPACITY.features(&opaque_map), ["material"]);
        assert_eq!(Needs::COLOR.features(&ALL).len(), ALL.len() + 1);
        // A hole is found by its opacity.
        let holes = ["cutout", "mapped", "color_map", "clear_map"];
        assert_eq!(Needs::DEPTH.features(&holes).len(), holes.len() + 1);
    }

    /// A word in a comment or of another struct is no read.
    #[test]
    fn reads_are_of_the_surface_alone() {
        let text = "struct Surface { @location(0) world: vec3f, @location(1) depth: f32 }
            struct Other { world: f32 }
            // surface.world
            @fragment fn main(surface: Surface) -> @location(0) vec4f {
                let other = Other(1.0);
                return vec4f(other.world, surface.depth, 0.0, 1.0);
            }";
        let (module, info) =
            crate::shaders::validate("commented", text, crate::shaders::PORTABLE).expect("valid");
        assert_eq!(
            of_module(&module, &info),
            BTreeSet::from(["depth".to_owned()])
        );
    }
}
