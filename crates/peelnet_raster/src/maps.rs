//! Textures on surfaces: mip levels, samplers and bindings.

use crate::RasterError;
use peelnet_core::srgb;
use peelnet_gpu::{
    Gpu,
    bind::{Bind, Bound},
    wgpu,
};
use peelnet_scene::{Maps, Texture, Wrap};
use std::sync::{Arc, LazyLock};

/// The textures that a material binds, and which of them a variant reads.
#[derive(Debug)]
struct Set {
    maps: Maps,
    read: [bool; 5],
    bound: Bound,
}

/// Every set of textures of a scene, each texture uploaded once.
#[derive(Debug, Default)]
pub(crate) struct MapSets {
    sets: Vec<Set>,
    images: Vec<(Arc<Texture>, bool, wgpu::TextureView)>,
}

/// Base colour and emission are stored as they are shown; the others are numbers.
const IS_SRGB: [bool; 5] = [true, false, false, false, true];

impl MapSets {
    /// The number of the set that binds the textures of a material that a variant reads.
    ///
    /// # Errors
    /// A texture beyond the adapter's limits.
    pub fn number(
        &mut self,
        gpu: &Gpu,
        maps: &Maps,
        read: [bool; 5],
    ) -> Result<usize, RasterError> {
        let same = |set: &Set| {
            let pointers = |maps: &Maps| maps.all().map(|map| map.map(Arc::as_ptr));
            set.read == read
                && pointers(&set.maps) == pointers(maps)
                && (set.maps.wrap, set.maps.nearest) == (maps.wrap, maps.nearest)
        };
        if let Some(known) = self.sets.iter().position(same) {
            return Ok(known);
        }
        let mode = |wrap| match wrap {
            Wrap::Repeat => wgpu::AddressMode::Repeat,
            Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
            Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
        };
        let near = if maps.nearest {
            wgpu::FilterMode::Nearest
        } else {
            wgpu::FilterMode::Linear
        };
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("maps"),
            address_mode_u: mode(maps.wrap[0]),
            address_mode_v: mode(maps.wrap[1]),
            mag_filter: near,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let mut views = Vec::with_capacity(5);
        for ((map, srgb), read) in maps.all().into_iter().zip(IS_SRGB).zip(read) {
            let map = map.filter(|_| read);
            views.push(map.map(|map| self.image(gpu, map, srgb)).transpose()?);
        }
        let mut entries = vec![Bind::Sampler(&sampler)];
        entries.extend(
            views
                .iter()
                .map(|v| v.as_ref().map_or(Bind::None, Bind::Image)),
        );
        let bound = gpu.bind("maps", wgpu::ShaderStages::FRAGMENT, &entries);
        self.sets.push(Set {
            maps: maps.clone(),
            read,
            bound,
        });
        Ok(self.sets.len() - 1)
    }

    /// A set's bindings.
    pub fn bound(&self, number: usize) -> &Bound {
        &self.sets[number].bound
    }

    fn image(
        &mut self,
        gpu: &Gpu,
        map: &Arc<Texture>,
        srgb: bool,
    ) -> Result<wgpu::TextureView, RasterError> {
        let mut known = self.images.iter();
        if let Some((_, _, view)) = known.find(|(m, s, _)| Arc::ptr_eq(m, map) && *s == srgb) {
            return Ok(view.clone());
        }
        let view = gpu.image(&map.name, srgb, &levels(map, srgb))?;
        self.images.push((Arc::clone(map), srgb, view.clone()));
        Ok(view)
    }
}

/// Linear light of every byte of sRGB.
static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| srgb::decode(byte as f32 / 255.0)));

/// An image at every size down to one texel. Colours are averaged as light, and count by their opacity: what cannot be seen leaves no
/// fringe.
fn levels(map: &Texture, srgb: bool) -> Vec<([u32; 2], Vec<u8>)> {
    let mut all = vec![(map.size, map.texels.concat())];
    let decode = |t: &[u8; 4]| {
        let alpha = f32::from(t[3]) / 255.0;
        let channel = |byte: u8| {
            if srgb {
                LINEAR[usize::from(byte)] * alpha
            } else {
                f32::from(byte) / 255.0
            }
        };
        [channel(t[0]), channel(t[1]), channel(t[2]), alpha]
    };
    let encode = |t: [f32; 4]| {
        let byte = |x: f32| (x * 255.0).round().clamp(0.0, 255.0) as u8;
        let channel = |x: f32| {
            if srgb {
                byte(srgb::encode(x / t[3].max(1e-6)))
            } else {
                byte(x)
            }
        };
        [channel(t[0]), channel(t[1]), channel(t[2]), byte(t[3])]
    };
    let [width, height] = map.size;
    let flat: Vec<f32> = map.texels.iter().flat_map(decode).collect();
    let Some(mut image) = image::Rgba32FImage::from_raw(width, height, flat) else {
        return all;
    };
    while image.width() > 1 || image.height() > 1 {
        let size = [(image.width() / 2).max(1), (image.height() / 2).max(1)];
        let filter = image::imageops::FilterType::Triangle;
        image = image::imageops::resize(&image, size[0], size[1], filter);
        let bytes = image.pixels().flat_map(|p| encode(p.0)).collect();
        all.push((size, bytes));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels go down to one texel, and light keeps its mean: half black and half white is 0.5 of white, byte 188. An image of one
    /// visible and one invisible colour keeps the visible one.
    #[test]
    fn levels_keep_light() {
        let checker = Texture::of("checker", [8, 4], |x, y| {
            let c = if (x + y) % 2 == 0 { 255 } else { 0 };
            [c, c, c, 255]
        });
        let all = levels(&checker, true);
        let sizes: Vec<_> = all.iter().map(|(size, _)| *size).collect();
        assert_eq!(sizes, [[8, 4], [4, 2], [2, 1], [1, 1]]);
        assert_eq!(all[3].1, [188, 188, 188, 255]);
        assert_eq!(levels(&checker, false)[3].1, [128, 128, 128, 255]);
        let leaf = Texture::of("leaf", [4, 4], |x, _| {
            if x % 2 == 0 {
                [0, 200, 0, 255]
            } else {
                [255, 0, 0, 0]
            }
        });
        let [r, g, b, a] = levels(&leaf, true)[2].1[..] else {
            panic!("one texel");
        };
        assert_eq!((r, g, b, a), (0, 200, 0, 128));
    }
}
