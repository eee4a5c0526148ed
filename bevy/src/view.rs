//! What a view with learned transparency has on the GPU.

use crate::{
    depths::Depths,
    phase::Learned3d,
    pipelines::{Setup, layout_of},
    shader_text::binding,
};
use bevy::{
    image::ToExtents,
    platform::collections::HashMap,
    prelude::*,
    render::{
        camera::ExtractedCamera,
        render_phase::ViewSortedRenderPhases,
        render_resource::{
            BindGroup, BindGroupEntry, BindingResource, CachedRenderPipelineId, PipelineCache,
            TextureDescriptor, TextureDimension, TextureUsages, UniformBuffer,
        },
        renderer::{RenderDevice, RenderQueue},
        texture::{CachedTexture, TextureCache},
        view::{ExtractedView, RetainedViewEntity},
    },
};

/// The state of one view.
pub(crate) struct LearnedView {
    pub resolve: CachedRenderPipelineId,
    pub samples: u32,
    pub depths: Depths,
    /// Frames in a row in which nothing was weighed.
    pub frames_without: u32,
    /// This frame's, if something is weighed.
    pub textures: Vec<CachedTexture>,
    /// Of each pass, and of the resolve.
    pub groups: Vec<BindGroup>,
    pub resolve_group: Option<BindGroup>,
    uniform: UniformBuffer<Vec4>,
}

impl LearnedView {
    pub fn new(resolve: CachedRenderPipelineId, samples: u32) -> Self {
        Self {
            resolve,
            samples,
            depths: Depths::default(),
            frames_without: 0,
            textures: Vec::new(),
            groups: Vec::new(),
            resolve_group: None,
            uniform: UniformBuffer::default(),
        }
    }
}

/// The state of all views.
#[derive(Default, Resource)]
pub(crate) struct LearnedViews(pub HashMap<RetainedViewEntity, LearnedView>);

/// Targets, and the bind groups that read them, for this frame. Views without a weighed surface get none.
pub(crate) fn prepare_views(
    setup: Option<Res<Setup>>,
    mut views: ResMut<LearnedViews>,
    phases: Res<ViewSortedRenderPhases<Learned3d>>,
    cameras: Query<(&ExtractedView, &ExtractedCamera)>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    mut textures: ResMut<TextureCache>,
) {
    let Some(setup) = setup else { return };
    for (extracted, camera) in &cameras {
        let id = extracted.retained_view_entity;
        let Some(view) = views.0.get_mut(&id) else {
            continue;
        };
        view.textures.clear();
        view.groups.clear();
        view.resolve_group = None;
        let weighed = phases.get(&id).is_some_and(|phase| !phase.items.is_empty());
        let (true, Some(size)) = (weighed, camera.physical_target_size) else {
            continue;
        };
        view.uniform.set(view.depths.uniform());
        view.uniform.write_buffer(&device, &queue);
        view.make(&setup, size, &cache, &device, &mut textures);
    }
}

impl LearnedView {
    fn make(
        &mut self,
        setup: &Setup,
        size: UVec2,
        cache: &PipelineCache,
        device: &RenderDevice,
        textures: &mut TextureCache,
    ) {
        let model = &setup.model;
        self.textures.extend(model.targets.iter().map(|target| {
            let descriptor = TextureDescriptor {
                label: Some("peelnet_target"),
                size: size.to_extents(),
                mip_level_count: 1,
                sample_count: self.samples,
                dimension: TextureDimension::D2,
                format: target.format,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            };
            textures.get(device, descriptor)
        }));
        let group = |targets: &[usize], uniform: Option<BindingResource<'_>>| {
            let layout = layout_of(targets, self.samples, uniform.is_some());
            let depths = uniform.map(|resource| BindGroupEntry {
                binding: 0,
                resource,
            });
            let read = targets.iter().map(|&target| BindGroupEntry {
                binding: binding(target),
                resource: BindingResource::TextureView(&self.textures[target].default_view),
            });
            let entries: Vec<_> = depths.into_iter().chain(read).collect();
            let layout = cache.get_bind_group_layout(&layout);
            device.create_bind_group("peelnet_bind_group", &layout, &entries)
        };
        let passes = model.passes.iter();
        let groups = passes.map(|pass| group(&pass.reads, self.uniform.binding()));
        (self.groups, self.resolve_group) =
            (groups.collect(), Some(group(&model.resolve_reads, None)));
    }
}
