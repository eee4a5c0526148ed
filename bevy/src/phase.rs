//! Which transparent surfaces are weighed.
//!
//! Bevy queues every transparent mesh into its phase, once, and keeps it there until it changes. Each frame the items that can be weighed are
//! marked, so that batching keeps them apart from others, are taken out when they are batched ([`crate::view`]), and go back after the frame. So
//! Bevy's bookkeeping of what is retained and what is stale stays right, and whatever is not taken is drawn by Bevy as ever: sorted, over the
//! weighed surfaces.

use crate::{
    CoverageMask, DepthRange, LearnedTransparency,
    depths::{Boxes, clipped, depths_of_boxes},
    device::{Refusals, refusal_of},
    error::{Gravity, PeelnetMessages},
    pipelines::{Found, HookedShaders, LearnedPipelines, OverPixels, Setup},
    view::LearnedViews,
};
use bevy::{
    core_pipeline::{core_3d::Transparent3d, oit::OrderIndependentTransparencySettings},
    material::labels::DrawFunctionId,
    pbr::{
        DrawMaterial, DrawMesh, MATERIAL_BIND_GROUP_INDEX, PreparedMaterial,
        RenderMaterialInstances, SetMaterialBindGroup, SetMeshBindGroup, SetMeshViewBindGroup,
    },
    platform::collections::HashSet,
    prelude::*,
    render::{
        camera::ExtractedCamera,
        erased_render_asset::ErasedRenderAssets,
        render_phase::*,
        render_resource::{PipelineCache, SpecializedRenderPipelines, TextureUsages},
        renderer::{RenderAdapter, RenderDevice},
        view::{ExtractedView, RetainedViewEntity},
    },
};

/// Marks items that are weighed, between sorting and batching. No such function exists: Bevy never sees one.
pub(crate) const WEIGHED: DrawFunctionId = DrawFunctionId(u32::MAX);

/// Draws a weighed item as Bevy draws materials, but for the bind group that is the pass's own ([`crate::group`]).
pub(crate) type DrawWeighed = (
    SetItemPipeline,
    SetMeshViewBindGroup<0>,
    SetMeshBindGroup<2>,
    SetMaterialBindGroup<MATERIAL_BIND_GROUP_INDEX>,
    DrawMesh,
);

/// Whether weights apply to the item's material: it absorbs what is behind it. Sums of light (`AlphaMode::Add`) and filters
/// (`AlphaMode::Multiply`) have no order or no coverage.
fn absorbs(
    item: &Transparent3d,
    instances: &RenderMaterialInstances,
    prepared: &ErasedRenderAssets<PreparedMaterial>,
) -> bool {
    let instance = instances.instances.get(&item.main_entity());
    let material = instance.and_then(|instance| prepared.get(instance.asset_id));
    let mode = material.map(|material| material.properties.alpha_mode);
    matches!(mode, Some(AlphaMode::Blend | AlphaMode::Premultiplied))
}

/// Frames without transparent surfaces before that is said: meshes and materials take some to load.
const FRAMES_TO_LOAD: u32 = 60;

pub(crate) fn mark_items(
    setup: Res<Setup>,
    messages: Res<PeelnetMessages>,
    instances: Res<RenderMaterialInstances>,
    prepared: Res<ErasedRenderAssets<PreparedMaterial>>,
    draw_functions: Res<DrawFunctions<Transparent3d>>,
    hooked: Res<HookedShaders>,
    boxes: Res<Boxes>,
    cache: Res<PipelineCache>,
    (device, adapter): (Res<RenderDevice>, Res<RenderAdapter>),
    mut pipelines: ResMut<LearnedPipelines>,
    mut over_pixels: ResMut<SpecializedRenderPipelines<Setup>>,
    mut transparent: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    mut views: ResMut<LearnedViews>,
    mut refusals: ResMut<Refusals>,
    mut cameras: Query<
        (
            &ExtractedView,
            &LearnedTransparency,
            &Msaa,
            &mut Camera3d,
            Has<OrderIndependentTransparencySettings>,
        ),
        With<ExtractedCamera>,
    >,
) {
    // Meshes that are drawn as Bevy draws materials.
    let draw_material = draw_functions.read().get_id::<DrawMaterial>();
    let limits = device.limits();
    let mut live: HashSet<RetainedViewEntity> = HashSet::default();
    for (view, settings, msaa, mut camera_3d, has_bevys) in &mut cameras {
        let id = view.retained_view_entity;
        let camera = id.main_entity;
        let samples = msaa.samples();
        let refusal = if has_bevys {
            Some("it has OrderIndependentTransparencySettings, Bevy's own technique, as well; remove one of the two".to_owned())
        } else {
            let refusal = refusals.0.entry(samples);
            refusal
                .or_insert_with(|| refusal_of(&setup.model, samples, &device, &adapter))
                .clone()
        };
        if let Some(reason) = refusal {
            let text = format!(
                "camera {} has no learned transparency: {reason}. Its transparent surfaces are drawn by Bevy",
                camera.id()
            );
            messages.report(Gravity::Error, text);
            continue;
        }
        let Some(phase) = transparent.get_mut(&id) else {
            continue;
        };
        live.insert(id);
        let mut pipeline = |key| over_pixels.specialize(&cache, &setup, key);
        let state = views.0.entry(id).or_default();
        state.writes_depth = settings.depth_threshold.is_some();
        state.has_mask = settings.mask || state.writes_depth;
        state.resolve = Some(pipeline(OverPixels::Resolve {
            format: view.target_format,
            samples,
            mask: state.has_mask,
        }));
        if setup.model.description.around.is_some() {
            state.around = Some(pipeline(OverPixels::Around));
            // One pixel in many looks at the depths of opaque surfaces itself.
            camera_3d.depth_texture_usages.0 |= TextureUsages::TEXTURE_BINDING.bits();
        }
        let mut needed = state.around.into_iter().chain(state.resolve);
        if needed.any(|pipeline| cache.get_render_pipeline(pipeline).is_none()) {
            continue;
        }
        let mut is_weighed = |item: &Transparent3d| {
            if Some(item.draw_function) != draw_material || !absorbs(item, &instances, &prepared) {
                return false;
            }
            let (base, writes_depth) = (item.pipeline, state.writes_depth);
            match pipelines.find(base, writes_depth, &cache, &setup, &hooked, &limits) {
                Found::Ready => true,
                Found::Waiting => false,
                Found::NoHook => {
                    let text = format!(
                        "the material of entity {} is not weighed, and Bevy draws it over all that are: its fragment shader does not import \
                         bevy_peelnet::draw",
                        item.main_entity().id()
                    );
                    messages.report(Gravity::Warning, text);
                    false
                }
                Found::Excess(excess) => {
                    let text = format!(
                        "some materials are not weighed, and Bevy draws them over all that are: their shaders would need {excess}"
                    );
                    messages.report(Gravity::Warning, text);
                    false
                }
            }
        };
        for item in phase.items.values_mut() {
            if is_weighed(item) {
                item.draw_function = WEIGHED;
            }
        }
        // Any order gives the same image, so items of one pipeline stand together: that makes long batches. The entity keeps the order of
        // frames the same, and with it how sums round. Others come first and keep Bevy's order.
        phase.items.sort_by_key(|_, item| {
            (item.draw_function == WEIGHED).then_some((item.pipeline.id(), item.main_entity()))
        });
        let items = &phase.items;
        let first = items.partition_point(|_, item| item.draw_function != WEIGHED);
        let weighed = items.values().skip(first);
        state.frames_without += 1;
        if weighed.len() > 0 {
            state.frames_without = 0;
        }
        if state.frames_without == FRAMES_TO_LOAD {
            let text = format!(
                "camera {} sees no transparent surface that learned transparency applies to; nothing is added to its frames",
                camera.id()
            );
            messages.report(Gravity::Info, text);
        }
        let depths = depths_of(view, settings, weighed, &boxes, &messages);
        state.depths = depths.with_w(settings.depth_threshold.unwrap_or_default());
    }
    views.0.retain(|id, _| live.contains(id));
}

/// Gives all items back. Masks are of one frame.
pub(crate) fn return_items(
    mut commands: Commands,
    masks: Query<Entity, With<CoverageMask>>,
    mut transparent: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    mut views: ResMut<LearnedViews>,
) {
    for (id, view) in &mut views.0 {
        let items = view.items.drain(..);
        if let Some(into) = transparent.get_mut(id) {
            into.items.extend(items);
        }
    }
    for view in &masks {
        commands.entity(view).remove::<CoverageMask>();
    }
}

fn depths_of<'a>(
    view: &ExtractedView,
    settings: &LearnedTransparency,
    weighed: impl Iterator<Item = &'a Transparent3d>,
    boxes: &Boxes,
    messages: &PeelnetMessages,
) -> Vec4 {
    if let DepthRange::Fixed { near, far } = settings.depth_range {
        return clipped(near, far, view.clip_from_view);
    }
    let placed = weighed.map(|item| {
        let placed = boxes.0.get(&item.main_entity()).copied();
        if placed.is_none() {
            let text = format!(
                "entity {} is transparent and has no Aabb: the range of depths is the whole camera's, which costs accuracy; give it one, or \
                 set LearnedTransparency::depth_range",
                item.main_entity().id()
            );
            messages.report(Gravity::Warning, text);
        }
        placed
    });
    let view_from_world = view.world_from_view.affine().inverse();
    depths_of_boxes(view_from_world, view.clip_from_view, placed)
}
