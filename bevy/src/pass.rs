//! The passes of a frame: those of the description over all weighed surfaces, and the resolve into the view.

use crate::{
    phase::Learned3d,
    pipelines::{LearnedPipelines, Setup},
    shader_text::GROUP,
    view::LearnedViews,
};
use bevy::{
    camera::{MainPassResolutionOverride, Viewport},
    log::error,
    pbr::{
        DrawMesh, MATERIAL_BIND_GROUP_INDEX, SetMaterialBindGroup, SetMeshBindGroup,
        SetMeshViewBindGroup, SetMeshViewBindingArrayBindGroup,
    },
    prelude::*,
    render::{
        camera::ExtractedCamera,
        diagnostic::RecordDiagnostics,
        render_phase::{
            CachedRenderPipelinePhaseItem, DrawError, DrawFunctions, PhaseItem, SortedRenderPhase,
            TrackedRenderPass, ViewSortedRenderPhases,
        },
        render_resource::{
            LoadOp, Operations, PipelineCache, RenderPassColorAttachment, RenderPassDescriptor,
            RenderPipeline, StoreOp,
        },
        renderer::{RenderContext, ViewQuery},
        view::{ExtractedView, ViewDepthStencilTexture, ViewTarget},
    },
};

/// What Bevy does to draw a material, but for the pipeline: that depends on the pass.
pub(crate) type DrawLearned = (
    SetMeshViewBindGroup<0>,
    SetMeshViewBindingArrayBindGroup<1>,
    SetMeshBindGroup<2>,
    SetMaterialBindGroup<MATERIAL_BIND_GROUP_INDEX>,
    DrawMesh,
);

pub(crate) fn learned_transparent_pass(
    world: &World,
    view: ViewQuery<(
        &ExtractedCamera,
        &ExtractedView,
        &ViewTarget,
        &ViewDepthStencilTexture,
        Option<&MainPassResolutionOverride>,
    )>,
    setup: Option<Res<Setup>>,
    views: Res<LearnedViews>,
    phases: Res<ViewSortedRenderPhases<Learned3d>>,
    pipelines: Res<LearnedPipelines>,
    cache: Res<PipelineCache>,
    mut context: RenderContext<'_, '_>,
) {
    let entity = view.entity();
    let (camera, extracted, target, depth, resolution) = view.into_inner();
    let id = extracted.retained_view_entity;
    let (Some(setup), Some(state), Some(phase)) = (setup, views.0.get(&id), phases.get(&id)) else {
        return;
    };
    let resolve = state.resolve.and_then(|id| cache.get_render_pipeline(id));
    let (Some(targets), Some(resolve)) = (&state.targets, resolve) else {
        return;
    };
    let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();

    let passes = &setup.model.description.passes;
    for (number, (pass, group)) in passes.iter().zip(&targets.groups).enumerate() {
        let attachments = pass.targets.iter().map(|target| {
            // Clear values are small integers, or the least half float.
            let [red, green, blue, alpha] = target.clear.map(|value| value as f32);
            Some(RenderPassColorAttachment {
                view: &targets.textures[&target.name].default_view,
                depth_slice: None,
                // Samples of coded levels must not be averaged.
                resolve_target: None,
                ops: Operations {
                    load: LoadOp::Clear(LinearRgba::new(red, green, blue, alpha).into()),
                    store: StoreOp::Store,
                },
            })
        });
        let attachments: Vec<_> = attachments.collect();
        let mut drawing = context.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("peelnet_pass"),
            color_attachments: &attachments,
            // Nothing writes depth here. It is stored because it would be lost otherwise.
            depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
            ..default()
        });
        let span = diagnostics.pass_span(&mut drawing, format!("peelnet_{}", pass.name));
        if let Some(viewport) = &viewport {
            drawing.set_camera_viewport(viewport);
        }
        drawing.set_bind_group(GROUP, group, &[]);
        if let Err(problem) = draw(phase, world, &mut drawing, entity, &|item| {
            cache.get_render_pipeline(pipelines.get(item.cached_pipeline(), number)?)
        }) {
            error!("peelnet pass {:?}: {problem}", pass.name);
        }
        span.end(&mut drawing);
    }

    let mut drawing = context.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("peelnet_resolve"),
        color_attachments: &[Some(target.get_color_attachment())],
        ..default()
    });
    let span = diagnostics.pass_span(&mut drawing, "peelnet_resolve");
    if let Some(viewport) = &viewport {
        drawing.set_camera_viewport(viewport);
    }
    drawing.set_render_pipeline(resolve);
    drawing.set_bind_group(0, &targets.resolve_group, &[]);
    drawing.draw(0..3, 0..1);
    span.end(&mut drawing);
}

/// Draws all batches with the pipelines of one pass.
fn draw<'w>(
    phase: &SortedRenderPhase<Learned3d>,
    world: &'w World,
    drawing: &mut TrackedRenderPass<'w>,
    view: Entity,
    pipeline_of: &dyn Fn(&Learned3d) -> Option<&'w RenderPipeline>,
) -> Result<(), DrawError> {
    let functions = world.resource::<DrawFunctions<Learned3d>>();
    let mut functions = functions.write();
    functions.prepare(world);
    let function = functions.id::<DrawLearned>();
    let mut index = 0;
    while let Some((_, item)) = phase.items.get_index(index) {
        // A batch stands at its first item, and the others of it are passed over.
        let instances = item.batch_range().len();
        if instances > 0
            && let Some(pipeline) = pipeline_of(item)
            && let Some(function) = functions.get_mut(function)
        {
            drawing.set_render_pipeline(pipeline);
            function.draw(world, drawing, view, item)?;
        }
        index += instances.max(1);
    }
    Ok(())
}
