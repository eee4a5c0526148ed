//! Textures on surfaces: mip levels, samplers and bindings.

use crate::geometry::{RenderError, mip_levels::levels};
use crate::gpu::{
    Gpu,
    bind::{Bind, Bound},
    wgpu,
};
use peelnet_scene::{Maps, Material, MaterialFlags, Texture, Wrap};
use std::{ops::Range, sync::Arc};

/// The textures that a material binds, and which of them a variant reads.
#[derive(Debug)]
struct Set {
    maps: Maps,
    read: MaterialFlags,
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
    /// The number of the set that binds the textures of a material that a variant reads; `None` of none, or of no triangles.
    pub fn number(
        &mut self,
        gpu: &Gpu,
        material: &Material,
        variant: MaterialFlags,
        triangles: &Range<usize>,
    ) -> Result<Option<usize>, RenderError> {
        if !variant.contains(MaterialFlags::MAPPED) || triangles.is_empty() {
            return Ok(None);
        }
        let (maps, read) = (&material.maps, variant.maps());
        let same = |set: &Set| {
            let pointers = |maps: &Maps| maps.all().map(|map| map.map(Arc::as_ptr));
            set.read == read
                && pointers(&set.maps) == pointers(maps)
                && (set.maps.wrap, set.maps.nearest) == (maps.wrap, maps.nearest)
        };
        if let Some(known) = self.sets.iter().position(same) {
            return Ok(Some(known));
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
        let flags = MaterialFlags::MAPS.into_iter().zip(IS_SRGB);
        for (map, (flag, srgb)) in maps.all().into_iter().zip(flags) {
            let map = map.filter(|_| read.contains(flag));
            views.push(map.map(|map| self.image(gpu, map, srgb)).transpose()?);
        }
        let mut entries = vec![(0, Bind::Sampler(&sampler))];
        let views = views.iter().zip(1..);
        entries.extend(views.filter_map(|(v, number)| Some((number, Bind::Image(v.as_ref()?)))));
        let bound = gpu.bind("maps", wgpu::ShaderStages::FRAGMENT, &entries);
        self.sets.push(Set {
            maps: maps.clone(),
            read,
            bound,
        });
        Ok(Some(self.sets.len() - 1))
    }

    pub fn bound(&self, number: usize) -> &Bound {
        &self.sets[number].bound
    }

    fn image(
        &mut self,
        gpu: &Gpu,
        map: &Arc<Texture>,
        srgb: bool,
    ) -> Result<wgpu::TextureView, RenderError> {
        let mut known = self.images.iter();
        if let Some((_, _, view)) = known.find(|(m, s, _)| Arc::ptr_eq(m, map) && *s == srgb) {
            return Ok(view.clone());
        }
        let view = gpu.image(&map.name, srgb, &levels(map, srgb))?;
        self.images.push((Arc::clone(map), srgb, view.clone()));
        Ok(view)
    }
}
