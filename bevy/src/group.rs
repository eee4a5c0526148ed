//! Bind group 1 of the passes over surfaces: what Bevy binds there, and what a pass reads.
//!
//! WebGPU promises four bind groups, and Bevy's meshes use all of them: the view, its light probes and decals, the mesh, the material. The second has
//! few bindings and is one for all meshes of a view. So in our passes it has ours as well, behind Bevy's.

use crate::model::{Around, Pass, PeelnetModel};
use bevy::{
    ecs::system::SystemParam,
    image::Image,
    light::{EnvironmentMapLight, IrradianceVolume},
    pbr::{
        RenderViewLightProbes,
        decal::clustered::{DecalsBuffer, RenderClusteredDecals},
    },
    prelude::*,
    render::{
        render_asset::RenderAssets,
        render_resource::{
            binding_types::{
                sampler, storage_buffer_read_only, texture_2d, texture_2d_multisampled,
                texture_depth_2d, texture_depth_2d_multisampled,
            },
            *,
        },
        renderer::RenderDevice,
        texture::{FallbackImage, GpuImage},
    },
};
use std::iter;

/// The bind group of light probes and decals.
pub(crate) const GROUP: usize = 1;

/// The first binding that is ours. Bevy's are 0 to 7.
pub(crate) const FIRST_BINDING: u32 = 8;

/// What Bevy binds in the group. It makes bind groups of its own from the same, in `prepare_mesh_view_bind_groups`.
#[derive(SystemParam)]
pub(crate) struct BevysBindings<'w, 's> {
    images: Res<'w, RenderAssets<GpuImage>>,
    fallback: Res<'w, FallbackImage>,
    decals: Res<'w, RenderClusteredDecals>,
    decals_buffer: Res<'w, DecalsBuffer>,
    probes: Query<
        'w,
        's,
        (
            Option<&'static RenderViewLightProbes<EnvironmentMapLight>>,
            Option<&'static RenderViewLightProbes<IrradianceVolume>>,
        ),
    >,
    cache: Res<'w, PipelineCache>,
    device: Res<'w, RenderDevice>,
}

impl BevysBindings<'_, '_> {
    /// A bind group with Bevy's bindings of a view, where the layout has them, and ours.
    pub fn group_with(
        &self,
        view: Entity,
        layout: &BindGroupLayoutDescriptor,
        ours: Vec<BindGroupEntry<'_>>,
    ) -> BindGroup {
        let bevys = layout.entries.iter().filter(|e| e.binding < FIRST_BINDING);
        let images: Vec<_> = bevys.clone().map(|e| self.images_of(view, e)).collect();
        let views = images.iter().map(|images| {
            let views = images.iter().map(|image| &*image.texture_view);
            views.collect::<Vec<&WgpuTextureView>>()
        });
        let views: Vec<_> = views.collect();
        let bevys = bevys.zip(iter::zip(&images, &views));
        let bevys = bevys.filter_map(|(entry, (images, views))| {
            let resource = match (entry.ty, entry.count) {
                (BindingType::Texture { .. }, None) => BindingResource::TextureView(views[0]),
                (BindingType::Texture { .. }, _) => BindingResource::TextureViewArray(views),
                // All images of an array are read through the sampler of the first.
                (BindingType::Sampler(_), _) => BindingResource::Sampler(&images[0].sampler),
                _ => self.decals_buffer.buffer()?.as_entire_binding(),
            };
            let binding = entry.binding;
            Some(BindGroupEntry { binding, resource })
        });
        let entries: Vec<_> = bevys.chain(ours).collect();
        let layout = self.cache.get_bind_group_layout(layout);
        self.device
            .create_bind_group("peelnet_bind_group", &layout, &entries)
    }

    /// The images of one of Bevy's bindings, or of the binding whose sampler it is. Never none.
    fn images_of(&self, view: Entity, entry: &BindGroupLayoutEntry) -> Vec<&GpuImage> {
        let (maps, volumes) = self.probes.get(view).unwrap_or_default();
        let maps = maps.map_or(&[][..], |maps| &maps.binding_index_to_textures);
        let (ids, missing): (Vec<AssetId<Image>>, _) = match entry.binding {
            0 | 2 => (
                maps.iter().map(|map| map.diffuse).collect(),
                &self.fallback.cube,
            ),
            1 => (
                maps.iter().map(|map| map.specular).collect(),
                &self.fallback.cube,
            ),
            3 | 4 => (
                volumes.map_or(vec![], |all| all.binding_index_to_textures.clone()),
                &self.fallback.d3,
            ),
            _ => (
                self.decals.binding_index_to_textures.clone(),
                &self.fallback.d2,
            ),
        };
        // Where arrays may be bound in part, Bevy's layouts declare long ones.
        let partly = WgpuFeatures::PARTIALLY_BOUND_BINDING_ARRAY;
        let count = match entry.count {
            Some(count) if !self.device.features().contains(partly) => count.get() as usize,
            _ => ids.len().max(1),
        };
        let found = ids.iter().map(|id| self.images.get(*id).unwrap_or(missing));
        found.chain(iter::repeat(missing)).take(count).collect()
    }
}

/// What a pass reads beside the range of depths.
pub(crate) struct Reads<'a> {
    /// Targets of earlier passes, or the small texture.
    pub names: Vec<&'a String>,
    /// Of the targets.
    samples: u32,
    /// Of the depths of opaque surfaces, where they are read.
    pub depth_samples: Option<u32>,
}

impl<'a> Reads<'a> {
    pub fn new(names: impl IntoIterator<Item = &'a String>, samples: u32) -> Self {
        Self {
            names: names.into_iter().collect(),
            samples,
            depth_samples: None,
        }
    }

    /// Of a pass over surfaces, in a view of so many samples.
    pub fn of_pass(pass: &'a Pass, samples: u32) -> Self {
        Self {
            depth_samples: pass.is_small().then_some(samples),
            ..Self::new(&pass.reads, samples)
        }
    }

    /// Of the pass that makes the small texture.
    pub fn of_around(around: &'a Around) -> Self {
        Self::new(around.pass.targets.iter().map(|target| &target.name), 1)
    }

    /// The layout of a bind group with these behind Bevy's bindings, if there are any.
    pub fn layout(
        &self,
        model: &PeelnetModel,
        bevys: &[BindGroupLayoutEntry],
    ) -> BindGroupLayoutDescriptor {
        let texture = |samples, filterable| {
            let kind = TextureSampleType::Float { filterable };
            if samples > 1 {
                texture_2d_multisampled(kind)
            } else {
                texture_2d(kind)
            }
        };
        // Not a uniform: wgpu allows none beside Bevy's arrays of textures.
        let mut entries = vec![(FIRST_BINDING, storage_buffer_read_only::<Vec4>(false))];
        for read in &self.names {
            let is_around = model.is_around(read);
            let samples = if is_around { 1 } else { self.samples };
            entries.push((model.binding(read), texture(samples, is_around)));
            if is_around {
                let bilinear = sampler(SamplerBindingType::Filtering);
                entries.push((model.sampler_binding(), bilinear));
            }
        }
        entries.extend(self.depth_samples.map(|samples| {
            let depth = if samples > 1 {
                texture_depth_2d_multisampled()
            } else {
                texture_depth_2d()
            };
            (model.depth_binding(), depth)
        }));
        let ours = entries.into_iter();
        let ours = ours.map(|(binding, kind)| kind.build(binding, ShaderStages::FRAGMENT));
        let entries: Vec<_> = bevys.iter().copied().chain(ours).collect();
        BindGroupLayoutDescriptor::new("peelnet_layout", &entries)
    }
}

/// What fragment shaders with these bind groups would have too many of, if anything.
pub(crate) fn excess(groups: &[BindGroupLayoutDescriptor], limits: &WgpuLimits) -> Option<String> {
    let entries = groups.iter().flat_map(|group| &group.entries);
    // Textures of arrays count by themselves, and ours has no arrays.
    let single =
        entries.filter(|e| e.visibility.contains(ShaderStages::FRAGMENT) && e.count.is_none());
    let (mut textures, mut samplers, mut buffers) = (0, 0, 0);
    for entry in single {
        match entry.ty {
            BindingType::Texture { .. } => textures += 1,
            BindingType::Sampler(_) => samplers += 1,
            BindingType::Buffer {
                ty: BufferBindingType::Storage { .. },
                ..
            } => buffers += 1,
            _ => {}
        }
    }
    let all = [
        (
            textures,
            "textures",
            limits.max_sampled_textures_per_shader_stage,
        ),
        (samplers, "samplers", limits.max_samplers_per_shader_stage),
        (
            buffers,
            "storage buffers",
            limits.max_storage_buffers_per_shader_stage,
        ),
    ];
    let excess = all.iter().find(|(found, _, allowed)| found > allowed);
    excess.map(|(found, what, allowed)| format!("{found} {what}, the device allows {allowed}"))
}
