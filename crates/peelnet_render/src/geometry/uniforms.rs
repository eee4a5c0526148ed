//! What shaders read of the scene, field by field: the structs in `shaders/scene`, compared with naga's offsets by a test.

use bytemuck::{Pod, Zeroable};
use peelnet_scene::{Light, Lighting, Material, SHADER_NUMBERS, Source};

/// `Camera` in `scene/camera.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CameraUniform {
    pub clip_from_world: [[f32; 4]; 4],
    /// World-space position of the eye.
    pub eye: [f32; 3],
    pub light_count: u32,
    /// Frame size in pixels.
    pub frame_size: [u32; 2],
    pub sample_seed: u32,
    pub sample_view: u32,
    pub sample_threshold: u32,
    /// 2^-k with 2^k > far, which maps linear depth to 0 … 1 without rounding.
    pub unit_from_depth: f32,
    /// 1 / near of the depth range that transparent objects span.
    pub warp_inverse_near: f32,
    /// Near end of that range.
    pub warp_near: f32,
    /// 2 / (ln far − ln near) of that range.
    pub warp_scale: f32,
    /// far / (far − near): window depth is this less a multiple of 1 / z.
    pub window_depth_at_infinity: f32,
    pub pad: [u32; 2],
    /// Ends of two stretches of that range without transparent objects.
    pub gaps: [f32; 4],
}

/// `Material` in `scene/material.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct MaterialData {
    pub color: [f32; 4],
    pub specular_or_metallic: f32,
    pub shininess_or_roughness: f32,
    pub alpha_cutoff: f32,
    pub layer: f32,
    /// The numbers that effects read, by the place that each says.
    pub numbers: [f32; SHADER_NUMBERS],
}

impl MaterialData {
    pub fn from_material(m: &Material, layer: u32) -> Self {
        let [r, g, b] = m.color;
        let [specular_or_metallic, shininess_or_roughness] = match m.lighting {
            Lighting::Pbr => [m.metallic, m.roughness],
            _ => [m.specular, m.shininess],
        };
        Self {
            color: [r, g, b, m.alpha],
            specular_or_metallic,
            shininess_or_roughness,
            alpha_cutoff: m.alpha_cutoff.unwrap_or(0.0),
            layer: layer as f32,
            numbers: m.shader_numbers(),
        }
    }
}

/// `Light` in `scene/shade.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LightData {
    /// A point with `is_point` 1, or the direction that light comes from with 0.
    pub position: [f32; 3],
    pub is_point: f32,
    /// Linear RGB times intensity.
    pub color: [f32; 3],
    pub pad: f32,
}

impl LightData {
    pub fn from_light(light: &Light) -> Self {
        let (position, is_point) = match light.source {
            Source::Point(place) => (place, 1.0),
            Source::Toward(direction) => (direction, 0.0),
        };
        Self {
            position: position.to_array(),
            is_point,
            color: light.color.map(|c| c * light.intensity),
            pad: 0.0,
        }
    }
}

/// Which pixels of a view are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSample {
    /// Seed of the hash.
    pub seed: u32,
    /// Number of the view, so that views sample different pixels.
    pub view: u32,
    /// Largest hash that is kept, see [`peelnet_core::hash::sample_threshold`].
    pub threshold: u32,
}

impl PixelSample {
    /// Keeps every pixel.
    pub const ALL: Self = Self {
        seed: 0,
        view: 0,
        threshold: u32::MAX,
    };
}

/// The largest power of two that maps depths up to `far` below 1: multiplying by it loses no bit.
pub(crate) fn unit_from_depth(far: f32) -> f32 {
    (-(far.log2().floor() + 1.0)).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::splats::SplatData;
    use crate::shaders::naga;
    use peelnet_scene::NUMBERS;
    use std::fmt::Debug;

    #[test]
    fn the_unit_of_depth_is_the_next_power_of_two() {
        let fars = [0.5, 0.9, 1.0, 100.0, 128.0];
        let units = fars.map(unit_from_depth);
        assert_eq!(units, [1.0, 1.0, 0.5, 1.0 / 128.0, 1.0 / 256.0]);
    }

    /// Names, order and offsets of a struct's members in the linked text.
    fn members(module: &naga::Module, name: &str) -> (Vec<(String, usize)>, usize) {
        let found = module.types.iter().find_map(|(_, t)| match &t.inner {
            // The linker puts the module's path before the name.
            naga::TypeInner::Struct { members, span }
                if t.name.as_ref().is_some_and(|n| n.ends_with(name)) =>
            {
                let members = members.iter().map(|m| {
                    let name = m.name.clone().unwrap_or_default();
                    (name, m.offset as usize)
                });
                Some((members.collect(), *span as usize))
            }
            _ => None,
        });
        found.unwrap_or_else(|| panic!("the shader has no struct {name}"))
    }

    /// The same of a struct of ours, by the values that it prints: each has 4 bytes.
    fn fields<T: Zeroable + Debug>() -> (Vec<(String, usize)>, usize) {
        let text = format!("{:?}", T::zeroed());
        let (mut fields, mut offset) = (Vec::new(), 0);
        for word in text.split_whitespace() {
            match word.strip_suffix(':') {
                Some("pad") => {}
                Some(name) => fields.push((name.to_owned(), offset)),
                None => offset += 4 * usize::from(word.contains(|c: char| c.is_ascii_digit())),
            }
        }
        assert_eq!(offset, size_of::<T>(), "{text}");
        (fields, offset)
    }

    /// Every struct lies in memory as the shaders read it.
    #[test]
    fn structs_lie_as_shaders_read_them() {
        let features = ["lit", "pbr", "sun", "numbered", "material"];
        let shader = crate::shaders::link("methods::blended::gather", &features, &[]);
        let text = shader.expect("links").text.clone();
        let capabilities = naga::valid::Capabilities::empty();
        let (module, _) = crate::shaders::validate("structs", &text, capabilities).expect("valid");
        assert_eq!(members(&module, "Light"), fields::<LightData>());
        assert_eq!(members(&module, "Camera"), fields::<CameraUniform>());
        let shader = crate::shaders::link("scene::vertex", &["splat", "material"], &[]);
        let text = shader.expect("links").text.clone();
        let (splat, _) = crate::shaders::validate("splats", &text, capabilities).expect("valid");
        assert_eq!(members(&splat, "scene_splat_Splat"), fields::<SplatData>());
        let (mut material, size) = fields::<MaterialData>();
        let (_, begin) = material.pop().expect("numbers are the last");
        let mut numbers: Vec<_> = NUMBERS.iter().filter(|n| n.place.is_some()).collect();
        numbers.sort_by_key(|n| n.place);
        material.extend(numbers.iter().filter_map(|number| {
            let field = number.field.rsplit('.').next()?.trim();
            Some((field.to_owned(), begin + number.place? * size_of::<f32>()))
        }));
        assert_eq!(members(&module, "Material"), (material, size));
    }
}
