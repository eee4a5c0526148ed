//! The render phase of learned transparency, and how items come into it.
//!
//! Bevy queues every transparent mesh into its own phase, once, and keeps it there until it changes. Each frame the items that can be weighed are
//! lent from that phase to [`Learned3d`] after queueing, so that batching makes one list for each, and go back after the frame. So Bevy's bookkeeping
//! of what is retained and what is stale stays right, and whatever is not lent is drawn by Bevy as ever: sorted, over the weighed surfaces.

use crate::{
    DepthRange, LearnedTransparency,
    depths::{Boxes, clipped, depths_of_boxes},
    device::Refusals,
    error::{Gravity, PeelnetMessages},
    pipelines::{Found, HookedShaders, LearnedPipelines, Setup},
    view::LearnedViews,
};
use bevy::{
    core_pipeline::{core_3d::Transparent3d, oit::OrderIndependentTransparencySettings},
    ecs::{entity::EntityHash, system::SystemParam},
    material::labels::DrawFunctionId,
    pbr::{DrawMaterial, PreparedMaterial, RenderMaterialInstances},
    platform::collections::HashSet,
    prelude::*,
    render::{
        camera::ExtractedCamera,
        erased_render_asset::ErasedRenderAssets,
        render_phase::{
            CachedRenderPipelinePhaseItem, DrawFunctions, PhaseItem, PhaseItemExtraIndex,
            SortedPhaseItem, SortedRenderPhase, ViewSortedRenderPhases,
        },
        render_resource::{CachedRenderPipelineId, PipelineCache, SpecializedRenderPipelines},
        renderer::{RenderAdapter, RenderDevice},
        sync_world::MainEntity,
        view::{ExtractedView, RetainedViewEntity},
    },
};
use indexmap::IndexMap;
use std::ops::Range;

/// A transparent mesh that is weighed, not sorted. It is Bevy's item: same entity, same draw, same material.
pub(crate) struct Learned3d(Transparent3d);

impl PhaseItem for Learned3d {
    fn entity(&self) -> Entity {
        self.0.entity()
    }

    fn main_entity(&self) -> MainEntity {
        self.0.main_entity()
    }

    fn draw_function(&self) -> DrawFunctionId {
        self.0.draw_function()
    }

    fn batch_range(&self) -> &Range<u32> {
        self.0.batch_range()
    }

    fn batch_range_mut(&mut self) -> &mut Range<u32> {
        self.0.batch_range_mut()
    }

    fn extra_index(&self) -> PhaseItemExtraIndex {
        self.0.extra_index()
    }

    fn batch_range_and_extra_index_mut(&mut self) -> (&mut Range<u32>, &mut PhaseItemExtraIndex) {
        self.0.batch_range_and_extra_index_mut()
    }
}

impl SortedPhaseItem for Learned3d {
    // Any order gives the same image, so items of one pipeline stand together: that makes long batches. The entity keeps the order of frames
    // the same, and with it how sums round.
    type SortKey = (usize, MainEntity);

    fn sort_key(&self) -> Self::SortKey {
        (self.0.pipeline.id(), self.0.main_entity())
    }

    fn recalculate_sort_keys(
        _: &mut IndexMap<(Entity, MainEntity), Self, EntityHash>,
        _: &ExtractedView,
    ) {
    }

    fn indexed(&self) -> bool {
        self.0.indexed
    }
}

impl CachedRenderPipelinePhaseItem for Learned3d {
    fn cached_pipeline(&self) -> CachedRenderPipelineId {
        self.0.pipeline
    }
}

/// What decides whether an item can be weighed.
#[derive(SystemParam)]
pub(crate) struct Materials<'w> {
    instances: Res<'w, RenderMaterialInstances>,
    prepared: Res<'w, ErasedRenderAssets<PreparedMaterial>>,
    draw_functions: Res<'w, DrawFunctions<Transparent3d>>,
    hooked: Res<'w, HookedShaders>,
}

impl Materials<'_> {
    /// Whether weights apply to the item at all: a mesh that is drawn as Bevy draws materials, and that absorbs what is behind it. Sums of
    /// light (`AlphaMode::Add`) and filters (`AlphaMode::Multiply`) have no order or no coverage.
    fn applies(&self, item: &Transparent3d) -> bool {
        if self.draw_functions.read().get_id::<DrawMaterial>() != Some(item.draw_function) {
            return false;
        }
        let instance = self.instances.instances.get(&item.main_entity());
        let material = instance.and_then(|instance| self.prepared.get(instance.asset_id));
        material.is_some_and(|material| {
            let mode = material.properties.alpha_mode;
            matches!(mode, AlphaMode::Blend | AlphaMode::Premultiplied)
        })
    }
}

/// Frames without transparent surfaces before that is said: meshes and materials take some to load.
const FRAMES_TO_LOAD: u32 = 60;

pub(crate) fn lend_items(
    setup: Option<Res<Setup>>,
    messages: Res<PeelnetMessages>,
    materials: Materials<'_>,
    boxes: Res<Boxes>,
    cache: Res<PipelineCache>,
    (device, adapter): (Res<RenderDevice>, Res<RenderAdapter>),
    mut pipelines: ResMut<LearnedPipelines>,
    mut resolves: ResMut<SpecializedRenderPipelines<Setup>>,
    mut transparent: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    mut learned: ResMut<ViewSortedRenderPhases<Learned3d>>,
    mut views: ResMut<LearnedViews>,
    mut refusals: ResMut<Refusals>,
    cameras: Query<
        (
            &ExtractedView,
            &LearnedTransparency,
            &Msaa,
            Has<OrderIndependentTransparencySettings>,
        ),
        With<ExtractedCamera>,
    >,
) {
    // Without a network the reason stands in the log since start-up.
    let Some(setup) = setup else { return };
    let mut live: HashSet<RetainedViewEntity> = HashSet::default();
    for (view, settings, msaa, has_bevys) in &cameras {
        let id = view.retained_view_entity;
        let camera = id.main_entity;
        let samples = msaa.samples();
        let refusal = if has_bevys {
            Some("it has OrderIndependentTransparencySettings, Bevy's own technique, as well; remove one of the two".to_owned())
        } else {
            refusals.find(&setup.model, samples, &device, &adapter)
        };
        if let Some(reason) = refusal {
            let text = format!(
                "camera {} has no learned transparency: {reason}. Its transparent surfaces are drawn by Bevy",
                camera.id()
            );
            messages.report(Gravity::Error, text);
            continue;
        }
        let Some(from) = transparent.get_mut(&id) else {
            continue;
        };
        live.insert(id);
        let into = learned.entry(id).or_default();
        let key = (view.target_format, samples);
        let resolve = resolves.specialize(&cache, &setup, key);
        let state = views.0.entry(id).or_default();
        state.resolve = Some(resolve);
        if cache.get_render_pipeline(resolve).is_none() {
            continue;
        }
        let lent = from.items.extract_if(.., |_, item| {
            if !materials.applies(item) {
                return false;
            }
            match pipelines.find(item.pipeline, &cache, &setup, &materials.hooked) {
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
            }
        });
        let lent = lent.map(|(key, item)| (key, Learned3d(item)));
        into.items.extend(lent);
        // Sorted by pipeline, not by depth.
        into.sort();
        state.frames_without += 1;
        if !into.items.is_empty() {
            state.frames_without = 0;
        }
        if state.frames_without == FRAMES_TO_LOAD {
            let text = format!(
                "camera {} sees no transparent surface that learned transparency applies to; nothing is added to its frames",
                camera.id()
            );
            messages.report(Gravity::Info, text);
        }
        state.depths = depths_of(view, settings, into, &boxes, &messages);
    }
    learned.retain(|id, _| live.contains(id));
    views.0.retain(|id, _| live.contains(id));
}

/// Gives all items back, as they were queued.
pub(crate) fn return_items(
    mut transparent: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    mut learned: ResMut<ViewSortedRenderPhases<Learned3d>>,
) {
    for (id, phase) in learned.iter_mut() {
        let into = transparent.get_mut(id);
        let items = phase.items.drain(..);
        let Some(into) = into else { continue };
        into.items.extend(items.map(|(key, Learned3d(mut item))| {
            item.batch_range = 0..1;
            item.extra_index = PhaseItemExtraIndex::None;
            (key, item)
        }));
    }
}

fn depths_of(
    view: &ExtractedView,
    settings: &LearnedTransparency,
    phase: &SortedRenderPhase<Learned3d>,
    boxes: &Boxes,
    messages: &PeelnetMessages,
) -> Vec4 {
    if let DepthRange::Fixed { near, far } = settings.depth_range {
        return clipped(near, far, view.clip_from_view);
    }
    let placed = phase.items.values().map(|item| {
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
