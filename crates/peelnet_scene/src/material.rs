use crate::texture::Maps;
use serde::Deserialize;

/// How a surface is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lighting {
    /// Its colour is its radiance.
    Unlit,
    /// Blinn–Phong (Blinn 1977).
    Phong,
    /// Cook–Torrance with a GGX distribution (Walter et al. 2007), metallic and roughness as in glTF 2.0.
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
    /// Light that passes through what its opacity covers, linear RGB, 0 … 1: stained glass. None where it is black.
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

    /// A transparent surface whose colour is its radiance; drawn as a transparent one even where `alpha` is 1.
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

    /// The same material with every number moved a share of the way to another's; textures stay.
    pub(crate) fn towards(&self, other: &Self, share: f32) -> Self {
        let mix = |a: f32, b: f32| a + share * (b - a);
        let each = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|k| mix(a[k], b[k]));
        let (maps, next) = (&self.maps, &other.maps);
        Self {
            color: each(self.color, other.color),
            alpha: mix(self.alpha, other.alpha),
            specular: mix(self.specular, other.specular),
            shininess: mix(self.shininess, other.shininess),
            metallic: mix(self.metallic, other.metallic),
            roughness: mix(self.roughness, other.roughness),
            emission: each(self.emission, other.emission),
            transmission: each(self.transmission, other.transmission),
            alpha_cutoff: self
                .alpha_cutoff
                .map(|a| mix(a, other.alpha_cutoff.unwrap_or(a))),
            maps: Maps {
                normal_scale: mix(maps.normal_scale, next.normal_scale),
                occlusion_strength: mix(maps.occlusion_strength, next.occlusion_strength),
                ..maps.clone()
            },
            ..self.clone()
        }
    }

    /// Whether it is drawn by the opaque pass.
    pub fn is_opaque(&self) -> bool {
        let whole = self.alpha_cutoff.is_some() || self.alpha >= 1.0;
        whole && !self.blend && !self.is_transmissive()
    }

    /// Whether light passes through what its opacity covers.
    pub fn is_transmissive(&self) -> bool {
        self.transmission != [0.0; 3]
    }

    /// Whether it emits anything.
    pub fn is_emissive(&self) -> bool {
        self.emission != [0.0; 3]
    }
}
