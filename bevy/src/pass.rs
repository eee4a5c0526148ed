//! The passes of a frame: those of the description over all weighed surfaces, and the resolve into the view.

use crate::{pipelines::Setup, shader_text::GROUP, view::LearnedViews};
use bevy::{
    camera::{MainPassResolutionOverride, Viewport},
    log::error,
    prelude::*,
    render::{
        camera::ExtractedCamera,
        diagnostic::RecordDiagnostics,
        render_resource::*,
        renderer::{RenderContext, ViewQuery},
        view::{ExtractedView, ViewDepthStencilTexture, ViewTarget},
    },
};

pub(crate) fn learned_transparent_pass(
    world: &World,
    view: ViewQuery<(
        &ExtractedCamera,
        &ExtractedView,
        &ViewTarget,
        &ViewDepthStencilTexture,
        Option<&MainPassResolutionOverride>,
    )>,
    setup: Res<Setup>,
    views: Res<LearnedViews>,
    cache: Res<PipelineCache>,
    mut context: RenderContext<'_, '_>,
) {
    let entity = view.entity();
    let (camera, extracted, target, depth, resolution) = view.into_inner();
    let state = views.0.get(&extracted.retained_view_entity);
    let targets = state.and_then(|state| state.targets.as_ref());
    let resolve = state.and_then(|state| cache.get_render_pipeline(state.resolve?));
    let (Some(targets), Some(resolve)) = (targets, resolve) else {
        return;
    };
    let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();

    let passes = &setup.model.description.passes;
    for (pass, (group, phase)) in passes.iter().zip(&targets.passes) {
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
        if let Err(problem) = phase.render(&mut drawing, world, entity) {
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
