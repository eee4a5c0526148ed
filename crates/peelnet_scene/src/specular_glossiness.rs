//! The specular–glossiness workflow, converted to metallic and roughness at load, so that shaders know one workflow.
//!
//! A surface of diffuse colour d and specular colour s reflects as one of base colour b and metallic m does where
//! d (1 − max s) = b (1 − 0.04) (1 − m) and s = 0.04 (1 − m) + b m. With brightnesses in place of colours this is a quadratic equation for m. Then
//! b follows from either equation; the second is trusted by m², as the first divides by 1 − m, and the second by m.
//! From Khronos' example of the conversion: KhronosGroup/glTF, `extensions/2.0/Archived/KHR_materials_pbrSpecularGlossiness/examples`.

use crate::{files::Files, material::Material, texture::Texture};
use peelnet_core::srgb;
use std::sync::Arc;

/// Reflectance of a dielectric seen head-on, as in glTF 2.0.
pub(crate) const DIELECTRIC: f32 = 0.04;

/// Divisors are at least this.
const LEAST: f32 = 1e-6;

/// A material's values, linear; each multiplies a texture's where there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Values {
    pub diffuse: [f32; 3],
    pub specular: [f32; 3],
    pub glossiness: f32,
}

/// Weights as the example has them.
fn brightness([r, g, b]: [f32; 3]) -> f32 {
    (0.299 * r * r + 0.587 * g * g + 0.114 * b * b).sqrt()
}

fn metallic(diffuse: f32, specular: f32, one_minus_strength: f32) -> f32 {
    if specular < DIELECTRIC {
        return 0.0;
    }
    let a = DIELECTRIC;
    let b = diffuse * one_minus_strength / (1.0 - DIELECTRIC) + specular - 2.0 * DIELECTRIC;
    let c = DIELECTRIC - specular;
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
    ((root - b) / (2.0 * a)).clamp(0.0, 1.0)
}

/// Base colour, metallic and roughness.
fn converted(values: Values) -> ([f32; 3], f32, f32) {
    let (diffuse, specular) = (values.diffuse, values.specular);
    let one_minus_strength = 1.0 - specular.into_iter().fold(0.0, f32::max);
    let [d, s] = [diffuse, specular].map(brightness);
    let m = metallic(d, s, one_minus_strength);
    let color = [0, 1, 2].map(|k| {
        let by_diffuse =
            diffuse[k] * one_minus_strength / (1.0 - DIELECTRIC) / (1.0 - m).max(LEAST);
        let by_specular = (specular[k] - DIELECTRIC * (1.0 - m)) / m.max(LEAST);
        let color = by_diffuse + m * m * (by_specular - by_diffuse);
        color.clamp(0.0, 1.0)
    });
    (color, m, 1.0 - values.glossiness)
}

/// Converts a material, whose colour map is the diffuse one, in sRGB and with an opacity: per texel where there are textures. `specular` is
/// sRGB, with the glossiness in its alpha. Of an error nothing is changed.
pub(crate) fn convert(
    values: Values,
    material: &mut Material,
    specular: Option<&Arc<Texture>>,
    files: &mut Files<'_>,
) -> Result<(), String> {
    let both = [material.maps.color.as_ref(), specular];
    if both == [None, None] {
        (material.color, material.metallic, material.roughness) = converted(values);
        material.maps.metallic_roughness = None;
        return Ok(());
    }
    let linear: Vec<f32> = (0..=255u8)
        .map(|byte| srgb::decode(f32::from(byte) / 255.0))
        .collect();
    let at = |d: [u8; 4], s: [u8; 4]| {
        let product = |factor: [f32; 3], texel: [u8; 4]| {
            [0, 1, 2].map(|k| factor[k] * linear[usize::from(texel[k])])
        };
        converted(Values {
            diffuse: product(values.diffuse, d),
            specular: product(values.specular, s),
            glossiness: values.glossiness * f32::from(s[3]) / 255.0,
        })
    };
    let byte = |x: f32| (x * 255.0).round() as u8;
    let color = files.joined(&format!("colours by {values:?}"), both, |d, s| {
        let [r, g, b] = at(d, s).0.map(srgb::encode8);
        [r, g, b, d[3]]
    })?;
    let metal = files.joined(&format!("metal by {values:?}"), both, |d, s| {
        let (_, metallic, roughness) = at(d, s);
        [255, byte(roughness), byte(metallic), 255]
    })?;
    // The values are in the maps.
    (material.color, material.metallic, material.roughness) = ([1.0; 3], 1.0, 1.0);
    material.maps.color = Some(color);
    material.maps.metallic_roughness = Some(metal);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grey between both: what the two workflows reflect is the same.
    #[test]
    fn what_is_reflected_stays() {
        for d in [0.0, 0.1, 0.4, 0.9] {
            for s in [0.05, 0.1, 0.3, 0.6] {
                let ([b, ..], m, _) = converted(Values {
                    diffuse: [d; 3],
                    specular: [s; 3],
                    glossiness: 0.5,
                });
                let (diffuse, specular) = (b * 0.96 * (1.0 - m), 0.04 * (1.0 - m) + b * m);
                assert!((diffuse - d * (1.0 - s)).abs() < 2e-3, "{d} {s}: {diffuse}");
                assert!((specular - s).abs() < 2e-3, "{d} {s}: {specular}");
            }
        }
    }
}
