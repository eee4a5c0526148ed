//! What a view with learned transparency has on the GPU.

use crate::{
    phase::Learned3d,
    pipelines::{Setup, layout_of},
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

#[derive(Default)]
pub(crate) struct LearnedView {
    pub resolve: Option<CachedRenderPipelineId>,
    /// Near and far of the weighed surfaces, and what both are counted from.
    pub depths: Vec4,
    /// Frames in a row in which nothing was weighed.
    pub frames_without: u32,
    /// This frame's, if something is weighed.
    pub targets: Option<Targets>,
    uniform: UniformBuffer<Vec4>,
}

/// The targets by their names, and the bind groups that read them.
pub(crate) struct Targets {
    pub textures: HashMap<String, CachedTexture>,
    /// Of each pass.
    pub groups: Vec<BindGroup>,
    pub resolve_group: BindGroup,
}

#[derive(Default, Resource)]
pub(crate) struct LearnedViews(pub HashMap<RetainedViewEntity, LearnedView>);

/// Targets for this frame. Views without a weighed surface get none.
pub(crate) fn prepare_views(
    setup: Option<Res<Setup>>,
    mut views: ResMut<LearnedViews>,
    phases: Res<ViewSortedRenderPhases<Learned3d>>,
    cameras: Query<(&ExtractedView, &ExtractedCamera, &Msaa)>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    mut textures: ResMut<TextureCache>,
) {
    let Some(setup) = setup else { return };
    for (extracted, camera, msaa) in &cameras {
        let id = extracted.retained_view_entity;
        let Some(view) = views.0.get_mut(&id) else {
            continue;
        };
        view.targets = None;
        let weighed = phases.get(&id).is_some_and(|phase| !phase.items.is_empty());
        let (true, Some(size)) = (weighed, camera.physical_target_size) else {
            continue;
        };
        view.uniform.set(view.depths);
        view.uniform.write_buffer(&device, &queue);
        let samples = msaa.samples();
        let sized = |format| TextureDescriptor {
            label: Some("peelnet_target"),
            size: size.to_extents(),
            mip_level_count: 1,
            sample_count: samples,
            dimension: TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        };
        let made = setup.model.targets().map(|target| {
            let texture = textures.get(&device, sized(target.format));
            (target.name.clone(), texture)
        });
        let made: HashMap<String, CachedTexture> = made.collect();
        let group = |reads: &Vec<String>| {
            let depths = view.uniform.binding().map(|resource| BindGroupEntry {
                binding: 0,
                resource,
            });
            let read = reads.iter().map(|target| BindGroupEntry {
                binding: setup.model.binding(target),
                resource: BindingResource::TextureView(&made[target].default_view),
            });
            let entries: Vec<_> = depths.into_iter().chain(read).collect();
            let layout = cache.get_bind_group_layout(&layout_of(&setup.model, reads, samples));
            device.create_bind_group("peelnet_bind_group", &layout, &entries)
        };
        let description = &setup.model.description;
        view.targets = Some(Targets {
            groups: description.passes.iter().map(|p| group(&p.reads)).collect(),
            resolve_group: group(&description.resolve_reads),
            textures: made,
        });
    }
}
