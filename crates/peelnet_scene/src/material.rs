use serde::Deserialize;

/// How a material answers to light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lighting {
    /// Its colour is its radiance.
    Unlit,
    /// Blinn–Phong (Blinn 1977).
    Phong,
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
            double_sided: true,
            blend: true,
        }
    }

    /// Whether it is drawn by the opaque pass.
    pub fn is_opaque(&self) -> bool {
        self.alpha >= 1.0 && !self.blend
    }
}
