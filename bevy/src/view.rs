//! What a view with learned transparency has on the GPU.

use crate::{
    phase::WEIGHED,
    pipelines::{LearnedPipelines, Setup, layout_of},
};
use bevy::{
    core_pipeline::core_3d::Transparent3d,
    image::ToExtents,
    pbr::DrawMaterial,
    platform::collections::HashMap,
    prelude::*,
    render::{
        camera::ExtractedCamera,
        render_phase::{DrawFunctions, SortedRenderPhase, ViewSortedRenderPhases},
        render_resource::*,
        renderer::{RenderDevice, RenderQueue},
        sync_world::MainEntity,
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
    /// The weighed items of this frame. Until its end they are not in Bevy's phase.
    pub items: Vec<((Entity, MainEntity), Transparent3d)>,
    /// This frame's, if something is weighed.
    pub targets: Option<Targets>,
    uniform: UniformBuffer<Vec4>,
}

/// The targets by their names, and what reads them and draws into them.
pub(crate) struct Targets {
    pub textures: HashMap<String, CachedTexture>,
    /// Of each pass: its bind group, and the weighed items with its pipelines.
    pub passes: Vec<(BindGroup, SortedRenderPhase<Transparent3d>)>,
    pub resolve_group: BindGroup,
}

#[derive(Default, Resource)]
pub(crate) struct LearnedViews(pub HashMap<RetainedViewEntity, LearnedView>);

/// Takes the weighed items, and makes targets for this frame. Views without a weighed surface get none.
pub(crate) fn prepare_views(
    setup: Res<Setup>,
    mut views: ResMut<LearnedViews>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    pipelines: Res<LearnedPipelines>,
    draw_functions: Res<DrawFunctions<Transparent3d>>,
    cameras: Query<(&ExtractedView, &ExtractedCamera, &Msaa)>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
    mut textures: ResMut<TextureCache>,
) {
    let draw_material = draw_functions.read().id::<DrawMaterial>();
    for (extracted, camera, msaa) in &cameras {
        let id = extracted.retained_view_entity;
        let (Some(view), Some(phase)) = (views.0.get_mut(&id), phases.get_mut(&id)) else {
            continue;
        };
        view.targets = None;
        let is_weighed = |_: &_, item: &mut Transparent3d| item.draw_function == WEIGHED;
        let weighed = phase.items.extract_if(.., is_weighed);
        view.items.extend(weighed.map(|(key, mut item)| {
            item.draw_function = draw_material;
            (key, item)
        }));
        let (false, Some(size)) = (view.items.is_empty(), camera.physical_target_size) else {
            continue;
        };
        view.uniform.set(view.depths);
        view.uniform.write_buffer(&device, &queue);
        let samples = msaa.samples();
        let made = setup.model.targets().map(|target| {
            let descriptor = TextureDescriptor {
                label: Some("peelnet_target"),
                size: size.to_extents(),
                mip_level_count: 1,
                sample_count: samples,
                dimension: TextureDimension::D2,
                format: target.format,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            };
            (target.name.clone(), textures.get(&device, descriptor))
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
        let passes = description.passes.iter().enumerate().map(|(number, pass)| {
            let mut phase = SortedRenderPhase::default();
            phase.items.extend(view.items.iter().map(|(key, item)| {
                let item = Transparent3d {
                    pipeline: pipelines.0[&item.pipeline][number],
                    batch_range: item.batch_range.clone(),
                    extra_index: item.extra_index.clone(),
                    ..*item
                };
                (*key, item)
            }));
            (group(&pass.reads), phase)
        });
        view.targets = Some(Targets {
            passes: passes.collect(),
            resolve_group: group(&description.resolve_reads),
            textures: made,
        });
    }
}
