//! What a geometry pass reads of a surface, and the shader features that follow from it: a pass without colour fetches no normals, UVs or
//! textures. What passes say is compared with naga's reflection of their shaders in a test.

use crate::shaders::{ShaderError, link, naga};
use std::{cell::RefCell, collections::BTreeSet, ops::BitOr};

/// What a pass reads of a surface besides where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Needs(u8);

impl Needs {
    /// Nothing: its position and depth alone.
    pub const DEPTH: Self = Self(0);
    /// The number of its triangle.
    pub const TRIANGLE: Self = Self(1);
    /// The number of its material.
    pub const MATERIAL: Self = Self(1 << 1);
    /// How much it covers.
    pub const OPACITY: Self = Self(1 << 2 | 1 << 1);
    /// Its radiance.
    pub const COLOR: Self = Self(1 << 3 | 1 << 2 | 1 << 1);

    /// Whether all of `other` is in it.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The features of a pass's shader for a material that needs these.
    pub(crate) fn features(self, material: &[&'static str]) -> Vec<&'static str> {
        // Holes are where opacity is low.
        let needs = match material.contains(&"cutout") {
            true => self | Self::OPACITY,
            false => self,
        };
        // Textures that opacity is read from.
        let mapped = material.contains(&"clear_map")
            || material.contains(&"transmission") && material.contains(&"color_map");
        let serves = |feature: &&str| match *feature {
            "cutout" | "clear_map" | "vertex_colors" | "emission" | "transmission" => {
                needs.has(Self::OPACITY)
            }
            "mapped" | "color_map" => needs.has(Self::COLOR) || mapped && needs.has(Self::OPACITY),
            _ => needs.has(Self::COLOR),
        };
        let of_material = material.iter().copied().filter(serves);
        let numbered = needs.has(Self::TRIANGLE).then_some("numbered");
        let named = needs.has(Self::MATERIAL).then_some("material");
        of_material.chain(numbered).chain(named).collect()
    }
}

impl BitOr for Needs {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// A pass that was built: its shader, features and modules without those of materials, and what it says that it needs.
type Built = (String, Vec<String>, Vec<(String, String)>, Needs);

thread_local! {
    static BUILT: RefCell<Option<Vec<Built>>> = const { RefCell::new(None) };
}

pub(crate) fn note(shader: &str, features: &[&str], extra: &[(&str, &str)], needs: Needs) {
    BUILT.with_borrow_mut(|built| {
        if let Some(built) = built {
            let features = features.iter().map(|&f| f.to_owned()).collect();
            let owned = |&(path, text): &(&str, &str)| (path.to_owned(), text.to_owned());
            let extra = extra.iter().map(owned).collect();
            built.push((shader.to_owned(), features, extra, needs));
        }
    });
}

/// Does `work`, and compares what each geometry pass that is built meanwhile on this thread says that it needs with what naga finds that
/// its shader reads: for tests. Returns a line for each pass that says otherwise, and the number of passes.
#[doc(hidden)]
pub fn compare_needs(work: impl FnOnce()) -> Result<(Vec<String>, usize), ShaderError> {
    BUILT.set(Some(Vec::new()));
    work();
    let built = BUILT.take().unwrap_or_default();
    let mut faults = BTreeSet::new();
    for (shader, features, extra, needs) in &built {
        // With everything that a material can have: what is read then shows what the pass needs.
        let all = ["numbered", "material", "lit", "pbr", "vertex_colors"];
        let features: Vec<_> = features.iter().map(String::as_str).chain(all).collect();
        let extra: Vec<_> = extra
            .iter()
            .map(|(p, t)| (p.as_str(), t.as_str()))
            .collect();
        let linked = link(shader, &features, &extra)?;
        let (module, info) =
            crate::shaders::validate(shader, &linked.text, crate::shaders::PORTABLE)?;
        let reads = of_module(&module, &info);
        for (need, member) in [
            (Needs::TRIANGLE, "triangle"),
            (Needs::MATERIAL, "material"),
            (Needs::OPACITY, "color"),
            (Needs::COLOR, "world"),
        ] {
            if needs.has(need) != reads.contains(member) {
                let says = if needs.has(need) {
                    "says"
                } else {
                    "does not say"
                };
                faults.insert(format!("{shader} {says} that it reads {member}"));
            }
        }
    }
    Ok((faults.into_iter().collect(), built.len()))
}

/// The members of `Surface` that a module's fragment entry point reads.
fn of_module(module: &naga::Module, info: &naga::valid::ModuleInfo) -> BTreeSet<String> {
    let mut reads = BTreeSet::new();
    for (number, entry) in module.entry_points.iter().enumerate() {
        if entry.stage != naga::ShaderStage::Fragment {
            continue;
        }
        let own = info.get_entry_point(number);
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
