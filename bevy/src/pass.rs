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
use std::ops::Range;

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
    let pipeline = |id: Option<CachedRenderPipelineId>| cache.get_render_pipeline(id?);
    let resolve = state.and_then(|state| pipeline(state.resolve));
    let (Some(state), Some(targets), Some(resolve), Some(size)) =
        (state, targets, resolve, camera.physical_target_size)
    else {
        return;
    };
    let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
    let viewport = viewport.unwrap_or(Viewport {
        physical_size: size,
        ..default()
    });
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let cleared = |name: &String, clear: [f64; 4]| {
        // Clear values are small integers, or the least half float.
        let [red, green, blue, alpha] = clear.map(|value| value as f32);
        RenderPassColorAttachment {
            view: &targets.textures[name].default_view,
            depth_slice: None,
            // Samples of coded levels must not be averaged.
            resolve_target: None,
            ops: Operations {
                load: LoadOp::Clear(LinearRgba::new(red, green, blue, alpha).into()),
                store: StoreOp::Store,
            },
        }
    };

    let description = &setup.model.description;
    for (pass, (group, phase)) in description.passes.iter().zip(&targets.passes) {
        let attachments = pass.targets.iter();
        let attachments: Vec<_> = attachments
            .map(|target| Some(cleared(&target.name, target.clear)))
            .collect();
        // Nothing writes depth here. It is stored because it would be lost otherwise.
        let depth = (!pass.is_small()).then(|| depth.get_attachment(StoreOp::Store));
        let mut drawing = context.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("peelnet_pass"),
            color_attachments: &attachments,
            depth_stencil_attachment: depth,
            ..default()
        });
        let span = diagnostics.pass_span(&mut drawing, format!("peelnet_{}", pass.name));
        let origin = viewport.physical_position.as_vec2() / pass.every as f32;
        let size = viewport.physical_size.as_vec2() / pass.every as f32;
        let Range { start, end } = viewport.depth;
        drawing.set_viewport(origin.x, origin.y, size.x, size.y, start, end);
        drawing.set_bind_group(GROUP, group, &[]);
        if let Err(problem) = phase.render(&mut drawing, world, entity) {
            error!("peelnet pass {:?}: {problem}", pass.name);
        }
        span.end(&mut drawing);
        drop(drawing);
        let around = description.around.as_ref().filter(|_| pass.is_small());
        if let (Some(around), Some(made_by), Some(group)) =
            (around, pipeline(state.around), &targets.around_group)
        {
            let texture = cleared(&around.name, [0.0; 4]);
            draw_pixels(&mut context, &around.name, texture, None, made_by, group);
        }
    }
    let output = target.get_color_attachment();
    let group = &targets.resolve_group;
    draw_pixels(
        &mut context,
        "resolve",
        output,
        Some(&viewport),
        resolve,
        group,
    );
}

/// A pass over the pixels of an attachment, or over those of a viewport.
fn draw_pixels(
    context: &mut RenderContext<'_, '_>,
    name: &str,
    attachment: RenderPassColorAttachment<'_>,
    viewport: Option<&Viewport>,
    pipeline: &RenderPipeline,
    group: &BindGroup,
) {
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let mut drawing = context.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("peelnet_pass"),
        color_attachments: &[Some(attachment)],
        ..default()
    });
    let span = diagnostics.pass_span(&mut drawing, format!("peelnet_{name}"));
    if let Some(viewport) = viewport {
        drawing.set_camera_viewport(viewport);
    }
    drawing.set_render_pipeline(pipeline);
    drawing.set_bind_group(0, group, &[]);
    drawing.draw(0..3, 0..1);
    span.end(&mut drawing);
}
