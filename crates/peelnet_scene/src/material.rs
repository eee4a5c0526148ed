//! Materials: their numbers, and the keys of both numbers and the rest in scene files.

use crate::{
    error::{Fault, within},
    file::raw::MapRef,
    texture::{Maps, Wrap},
};
use bytemuck::{cast_slice, cast_slice_mut};
use serde::Deserialize;
use std::{
    any::Any,
    slice::{from_mut, from_ref},
};

/// How a surface is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lighting {
    /// Its colour is its radiance.
    Unlit,
    /// Blinn–Phong (Blinn 1977).
    Phong,
    /// Cook–Torrance with a GGX distribution (Walter et al. 2007), metallic and roughness as in
    /// glTF 2.0.
    Pbr,
}

/// A surface's appearance. Any value may be changed between frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name, from the mesh file where there is one.
    pub name: String,
    /// Base colour, linear RGB.
    pub color: [f32; 3],
    /// Opacity, 0 … 1.
    pub alpha: f32,
    /// How it is lit.
    pub lighting: Lighting,
    /// Strength of the highlight.
    pub specular: f32,
    /// Exponent of the highlight.
    pub shininess: f32,
    /// How much of a metal it is, 0 … 1; for physically based shading.
    pub metallic: f32,
    /// Roughness, 0 … 1; for physically based shading.
    pub roughness: f32,
    /// Radiance that it emits beyond what its opacity covers, linear RGB.
    pub emission: [f32; 3],
    /// Light that passes through what its opacity covers, linear RGB, 0 … 1: stained glass. None
    /// where it is black.
    pub transmission: [f32; 3],
    /// Textures.
    pub maps: Maps,
    /// Cut-out: an opacity below this is a hole; one above it is opaque, unless it blends.
    pub alpha_cutoff: Option<f32>,
    /// Whether back faces are drawn.
    pub double_sided: bool,
    /// Whether it takes the transparent path even where its opacity is 1 or it has holes.
    pub blend: bool,
}

impl Material {
    /// The material of a mesh without one: opaque light grey.
    pub(crate) fn default_with(lighting: Lighting) -> Self {
        Self {
            name: "default".into(),
            lighting,
            specular: 0.3,
            shininess: 32.0,
            blend: false,
            ..Self::unlit([0.8; 3], 1.0)
        }
    }

    /// A transparent surface whose colour is its radiance; drawn as a transparent one even where
    /// `alpha` is 1.
    pub const fn unlit(color: [f32; 3], alpha: f32) -> Self {
        Self {
            name: String::new(),
            color,
            alpha,
            lighting: Lighting::Unlit,
            specular: 0.0,
            shininess: 1.0,
            metallic: 0.0,
            roughness: 0.5,
            emission: [0.0; 3],
            transmission: [0.0; 3],
            maps: Maps::NONE,
            alpha_cutoff: None,
            double_sided: true,
            blend: true,
        }
    }

    /// The same material with every number moved a fraction of the way to another's; textures stay.
    pub(crate) fn towards(&self, other: &Self, fraction: f32) -> Self {
        let mix = |a: f32, b: f32| a + fraction * (b - a);
        let mut mixed = self.clone();
        for number in NUMBERS {
            let values = (number.values_mut)(&mut mixed);
            for (value, next) in values.iter_mut().zip((number.values)(other)) {
                *value = mix(*value, *next);
            }
        }
        let cutoff = |own| mix(own, other.alpha_cutoff.unwrap_or(own));
        mixed.alpha_cutoff = self.alpha_cutoff.map(cutoff);
        mixed
    }

    /// Its cutoff once its opacity is `alpha`: what was a hole stays one.
    pub(crate) fn cutoff_at(&self, alpha: f32) -> Option<f32> {
        let factor = if self.alpha > 0.0 {
            alpha / self.alpha
        } else {
            1.0
        };
        self.alpha_cutoff.map(|cutoff| cutoff * factor)
    }

    /// Whether it is drawn by the opaque pass.
    pub fn is_opaque(&self) -> bool {
        let whole = self.alpha_cutoff.is_some() || self.alpha >= 1.0;
        whole && !self.blend && self.transmission == [0.0; 3]
    }
}

/// A number of a material, or the three of a colour. Scene files, timelines, edited scenes, the
/// viewer and shaders go through [`NUMBERS`].
#[derive(Debug)]
pub struct Number {
    /// Its key in scene files.
    pub key: &'static str,
    /// Its field in [`Material`], and the last word of it in the shader's `Material`.
    pub field: &'static str,
    /// How many floats it has: 1, or 3 of a colour.
    pub length: usize,
    /// Its first float's place in [`Material::shader_numbers`]; `None` where shaders read it
    /// otherwise or not at all. A colour begins at a multiple of 4, as WGSL lays it out.
    pub place: Option<usize>,
    /// How the viewer changes it.
    pub control: Option<Control>,
    /// Its floats.
    pub values: fn(&Material) -> &[f32],
    /// Its floats, to be changed.
    pub values_mut: fn(&mut Material) -> &mut [f32],
}

impl Number {
    /// Whether it is 0, or black.
    pub fn is_zero(&self, material: &Material) -> bool {
        (self.values)(material).iter().all(|x| *x == 0.0)
    }
}

/// A slider of the viewer, or the button of a colour.
#[derive(Debug)]
pub struct Control {
    /// Its label.
    pub label: &'static str,
    /// Least and largest value of a slider.
    pub range: [f32; 2],
    /// Whether the slider is logarithmic.
    pub logarithmic: bool,
    /// The shading models that it is shown with.
    pub models: &'static [Lighting],
}

impl Control {
    /// From 0 to 1.
    const fn new(label: &'static str, models: &'static [Lighting]) -> Option<Self> {
        Some(Self {
            label,
            range: [0.0, 1.0],
            logarithmic: false,
            models,
        })
    }
}

/// How many floats [`Material::shader_numbers`] has, in whole `vec4f`.
pub const SHADER_NUMBERS: usize = 8;

impl Material {
    /// The numbers that effects read in shaders, each at its [`Number::place`].
    pub fn shader_numbers(&self) -> [f32; SHADER_NUMBERS] {
        let mut all = [0.0; SHADER_NUMBERS];
        for number in NUMBERS {
            if let Some(place) = number.place {
                all[place..place + number.length].copy_from_slice((number.values)(self));
            }
        }
        all
    }
}

/// Declares the keys of a material, all of which may be left out: type, bounds of each number, and
/// of those that are fields of [`Material`] the field, with [`Number::place`] and
/// [`Number::control`] where they have any.
macro_rules! material_keys {
    ($(
        $key:ident: $type:ty $(=> [$low:expr, $high:expr])?
        $(as $($field:ident).+ { $($property:tt)* })?,
    )*) => {
        /// The values of a material that a scene file sets; the mesh's own material has the others.
        #[derive(Clone, Debug, Default, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(crate) struct RawMaterial {
            $(pub $key: Option<$type>,)*
        }

        impl RawMaterial {
            /// This material's values, and an earlier state's where this one has none.
            pub fn after(&self, earlier: &Self) -> Self {
                Self { $($key: self.$key.clone().or_else(|| earlier.$key.clone()),)* }
            }

            pub fn given(&self) -> Vec<&'static str> {
                let all = [$((self.$key.is_some(), stringify!($key)),)*].into_iter();
                all.filter_map(|(given, key)| given.then_some(key)).collect()
            }

            /// The maps that are given.
            pub fn maps(&self) -> impl Iterator<Item = &MapRef> {
                let values = [$(&self.$key as &dyn Any,)*].into_iter();
                values.filter_map(|value| value.downcast_ref::<Option<MapRef>>()?.as_ref())
            }

            pub fn check_bounds(&self) -> Result<(), Fault> {
                $($(
                    for value in cast_slice(self.$key.as_slice()) {
                        within(stringify!($key), *value, $low, $high)?;
                    }
                )?)*
                Ok(())
            }

            /// Sets the numbers that are given.
            pub fn set_numbers(&self, material: &mut Material) {
                $($(
                    if let Some(value) = self.$key {
                        material.$($field).+ = value;
                    }
                )?)*
            }
        }

        /// The numbers of a material, in the order of the keys.
        pub const NUMBERS: &[Number] = &[$($(
            Number {
                $($property)*
                ..Number {
                    key: stringify!($key),
                    field: stringify!($($field).+),
                    length: size_of::<$type>() / size_of::<f32>(),
                    place: None,
                    control: None,
                    values: |material| cast_slice(from_ref(&material.$($field).+)),
                    values_mut: |material| cast_slice_mut(from_mut(&mut material.$($field).+)),
                }
            },
        )?)*];
    };
}

/// Longest displacement, scene units, and farthest middle.
const MOST_DISPLACED: f32 = 1e9;

const ALL: &[Lighting] = &[Lighting::Unlit, Lighting::Phong, Lighting::Pbr];
const PHONG: &[Lighting] = &[Lighting::Phong];
const PBR: &[Lighting] = &[Lighting::Pbr];

material_keys! {
    color: [f32; 3] as color { control: Control::new("Colour", ALL), },
    alpha: f32 => [0.0, 1.0] as alpha { control: Control::new("Opacity", ALL), },
    lighting: Lighting,
    specular: f32 => [0.0, f32::MAX] as specular { control: Control::new("Highlight", PHONG), },
    // pow(0, 0) is not defined in shaders.
    shininess: f32 => [1.0, f32::MAX] as shininess {
        control: Some(Control {
            label: "Exponent",
            range: [1.0, 512.0],
            logarithmic: true,
            models: PHONG,
        }),
    },
    metallic: f32 => [0.0, 1.0] as metallic { control: Control::new("Metallic", PBR), },
    roughness: f32 => [0.0, 1.0] as roughness { control: Control::new("Roughness", PBR), },
    specular_color: [f32; 3] => [0.0, 1.0],
    glossiness: f32 => [0.0, 1.0],
    emission: [f32; 3] => [0.0, f32::MAX] as emission {
        place: Some(0),
        control: Control::new("Emission", ALL),
    },
    transmission_color: [f32; 3] => [0.0, 1.0] as transmission { place: Some(4), },
    color_map: MapRef,
    normal_map: MapRef,
    metallic_roughness_map: MapRef,
    specular_color_map: MapRef,
    glossiness_map: MapRef,
    specular_glossiness_map: MapRef,
    occlusion_map: MapRef,
    emissive_map: MapRef,
    displacement_map: MapRef,
    displacement_scale: f32 => [-MOST_DISPLACED, MOST_DISPLACED],
    displacement_middle: f32 => [-MOST_DISPLACED, MOST_DISPLACED],
    displacement_level: u32,
    normal_scale: f32 => [-100.0, 100.0] as maps.normal_scale { place: Some(3), },
    occlusion_strength: f32 => [0.0, 1.0] as maps.occlusion_strength { place: Some(7), },
    wrap: Wrap,
    alpha_mode: AlphaMode,
    alpha_cutoff: f32 => [0.0, 1.0],
    double_sided: bool,
    blend: bool,
}

/// What opacity means, as in glTF 2.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum AlphaMode {
    Opaque,
    Mask,
    Blend,
}
