//! What a view with learned transparency has on the GPU.

use crate::{
    CoverageMask,
    group::{BevysBindings, FIRST_BINDING, GROUP, Reads},
    model::{Around, MASK, Target},
    phase::{DrawWeighed, WEIGHED},
    pipelines::{LearnedPipelines, Setup},
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
        view::{ExtractedView, RetainedViewEntity, ViewDepthStencilTexture},
    },
};

#[derive(Default)]
pub(crate) struct LearnedView {
    /// Of the small texture, where there is one.
    pub around: Option<CachedRenderPipelineId>,
    pub resolve: Option<CachedRenderPipelineId>,
    /// Near and far of the weighed surfaces, what both are counted from, and the coverage from which depth is written.
    pub depths: Vec4,
    /// Whether the resolve writes coverage, and whether depth is written where that is enough.
    pub has_mask: bool,
    pub writes_depth: bool,
    /// Frames in a row in which nothing was weighed.
    pub frames_without: u32,
    /// The weighed items of this frame. Until its end they are not in Bevy's phase.
    pub items: Vec<((Entity, MainEntity), Transparent3d)>,
    /// This frame's, if something is weighed.
    pub targets: Option<Targets>,
    range: StorageBuffer<Vec4>,
}

/// The targets by their names, and what reads them and draws into them.
pub(crate) struct Targets {
    pub textures: HashMap<String, CachedTexture>,
    /// Coverage with one sample a pixel, where it is asked for.
    pub mask: Option<CachedTexture>,
    /// Of each pass, with that of depth last where it is asked for: its bind group, and the weighed items with its pipelines.
    pub passes: Vec<(BindGroup, SortedRenderPhase<Transparent3d>)>,
    /// Of the pass that makes the small texture, where there is one.
    pub around_group: Option<BindGroup>,
    pub resolve_group: BindGroup,
}

/// What the small texture is read through.
#[derive(Resource)]
pub(crate) struct Bilinear(Sampler);

impl FromWorld for Bilinear {
    fn from_world(world: &mut World) -> Self {
        let device = world.resource::<RenderDevice>();
        Self(device.create_sampler(&SamplerDescriptor {
            label: Some("peelnet_sampler"),
            mag_filter: FilterMode::Linear,
            min_filter: FilterMode::Linear,
            ..default()
        }))
    }
}

#[derive(Default, Resource)]
pub(crate) struct LearnedViews(pub HashMap<RetainedViewEntity, LearnedView>);

/// Takes the weighed items, and makes targets for this frame. Views without a weighed surface get none.
pub(crate) fn prepare_views(
    mut commands: Commands,
    setup: Res<Setup>,
    mut views: ResMut<LearnedViews>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    pipelines: Res<LearnedPipelines>,
    draw_functions: Res<DrawFunctions<Transparent3d>>,
    cameras: Query<(
        Entity,
        &ExtractedView,
        &ExtractedCamera,
        &Msaa,
        &ViewDepthStencilTexture,
    )>,
    cache: Res<PipelineCache>,
    bilinear: Res<Bilinear>,
    bevys: BevysBindings,
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
    mut textures: ResMut<TextureCache>,
) {
    let draw_material = draw_functions.read().id::<DrawMaterial>();
    let draw_weighed = draw_functions.read().id::<DrawWeighed>();
    for (entity, extracted, camera, msaa, depth) in &cameras {
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
        view.range.set(view.depths);
        view.range.write_buffer(&device, &queue);
        let samples = msaa.samples();
        let mut texture = |name: &String, format, every, sample_count| {
            let descriptor = TextureDescriptor {
                label: Some("peelnet_target"),
                size: size.map(|n| n.div_ceil(every)).to_extents(),
                mip_level_count: 1,
                sample_count,
                dimension: TextureDimension::D2,
                format,
                // Copies are for those who get the mask.
                usage: TextureUsages::RENDER_ATTACHMENT
                    | TextureUsages::TEXTURE_BINDING
                    | TextureUsages::COPY_SRC,
                view_formats: &[],
            };
            (name.clone(), textures.get(&device, descriptor))
        };
        let (model, description) = (&setup.model, &setup.model.description);
        let mut made = HashMap::new();
        for (Target { name, format, .. }, every) in model.targets() {
            let samples = if every == 1 { samples } else { 1 };
            if name != MASK || view.has_mask {
                made.extend([texture(name, *format, every, samples)]);
            }
        }
        let mask = made.get(MASK).cloned();
        // The samples' mean is in a texture of its own.
        let mask = mask.map(|mask| match samples {
            1 => mask,
            _ => texture(&model.mask.name, model.mask.format, 1, 1).1,
        });
        if let Some(Around {
            name,
            format,
            every,
            ..
        }) = &description.around
        {
            made.extend([texture(name, *format, *every, 1)]);
        }
        let group = |reads: Reads<'_>, bevys_entries: &[BindGroupLayoutEntry]| {
            let entry = |binding, resource| BindGroupEntry { binding, resource };
            let range = view.range.binding();
            let range = range.map(|range| entry(FIRST_BINDING, range));
            let mut entries = Vec::from_iter(range);
            for read in &reads.names {
                let texture = BindingResource::TextureView(&made[*read].default_view);
                entries.push(entry(model.binding(read), texture));
                if model.is_around(read) {
                    let bilinear = BindingResource::Sampler(&bilinear.0);
                    entries.push(entry(model.sampler_binding(), bilinear));
                }
            }
            if reads.depth_samples.is_some() {
                let depth = &depth.attachment.texture.default_view;
                let depth = BindingResource::TextureView(depth);
                entries.push(entry(model.depth_binding(), depth));
            }
            let layout = reads.layout(model, bevys_entries);
            bevys.group_with(entity, &layout, entries)
        };
        // Bevy's bindings are those of the view: the same for all items.
        let descriptor = cache.get_render_pipeline_descriptor(view.items[0].1.pipeline);
        let bevys_entries = &descriptor.layout[GROUP].entries;
        let count = description.passes.len() + usize::from(view.writes_depth);
        let passes = model.passes().take(count).enumerate();
        let passes = passes.map(|(number, pass)| {
            let mut phase = SortedRenderPhase::default();
            phase.items.extend(view.items.iter().map(|(key, item)| {
                let item = Transparent3d {
                    pipeline: pipelines.0[&item.pipeline][number],
                    draw_function: draw_weighed,
                    batch_range: item.batch_range.clone(),
                    extra_index: item.extra_index.clone(),
                    ..*item
                };
                (*key, item)
            }));
            let group = group(Reads::of_pass(pass, samples), bevys_entries);
            (group, phase)
        });
        let around = description.around.as_ref();
        let targets = Targets {
            passes: passes.collect(),
            around_group: around.map(|around| group(Reads::of_around(around), &[])),
            resolve_group: group(Reads::new(&description.resolve_reads, samples), &[]),
            mask,
            textures: made,
        };
        if let Some(mask) = &targets.mask {
            commands.entity(entity).insert(CoverageMask(mask.clone()));
        }
        view.targets = Some(targets);
    }
}
