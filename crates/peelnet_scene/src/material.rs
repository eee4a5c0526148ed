use serde::Deserialize;

/// How a material answers to light.
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

/// A surface's looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name, from the mesh file where there is one.
    pub name: String,
    /// Base colour, linear RGB.
    pub color: [f32; 3],
    /// Opacity, 0 … 1.
    pub alpha: f32,
    /// Answer to light.
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
    /// Cut-out: an opacity below this is a hole, one above it is opaque.
    pub alpha_cutoff: Option<f32>,
    /// Whether back faces are drawn.
    pub double_sided: bool,
    /// Whether an opacity of 1 still takes the transparent path.
    pub blend: bool,
}

impl Material {
    /// What a mesh without material gets: opaque light grey.
    pub fn default_with(lighting: Lighting) -> Self {
        Self {
            name: "default".into(),
            color: [0.8; 3],
            alpha: 1.0,
            lighting,
            specular: 0.3,
            shininess: 32.0,
            metallic: 0.0,
            roughness: 0.5,
            emission: [0.0; 3],
            alpha_cutoff: None,
            double_sided: true,
            blend: false,
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
            alpha_cutoff: None,
            double_sided: true,
            blend: true,
        }
    }

    /// Whether it is drawn by the opaque pass.
    pub fn is_opaque(&self) -> bool {
        self.alpha_cutoff.is_some() || (self.alpha >= 1.0 && !self.blend)
    }

    /// Whether it emits anything.
    pub fn is_emissive(&self) -> bool {
        self.emission != [0.0; 3]
    }
}
