//! The passes of a frame: those of the description over all weighed surfaces, the resolve into the view, and the surfaces' depth.

use crate::{
    group::GROUP,
    model::{MASK, Pass},
    pipelines::Setup,
    view::{LearnedView, LearnedViews, Targets},
};
use bevy::{
    camera::{MainPassResolutionOverride, Viewport},
    core_pipeline::core_3d::Transparent3d,
    log::error,
    prelude::*,
    render::{
        camera::ExtractedCamera,
        diagnostic::RecordDiagnostics,
        render_phase::SortedRenderPhase,
        render_resource::*,
        renderer::{RenderContext, ViewQuery},
        view::{ExtractedView, ViewDepthStencilTexture, ViewTarget},
    },
};
use std::ops::Range;

type ViewParts<'w> = (
    &'w ExtractedCamera,
    &'w ExtractedView,
    &'w ViewTarget,
    &'w ViewDepthStencilTexture,
    Option<&'w MainPassResolutionOverride>,
);

/// A view in which something is weighed, and where its passes draw.
struct Drawn<'w> {
    world: &'w World,
    entity: Entity,
    state: &'w LearnedView,
    targets: &'w Targets,
    image: &'w ViewTarget,
    depth: &'w ViewDepthStencilTexture,
    viewport: Viewport,
}

impl<'w> Drawn<'w> {
    fn new(
        world: &'w World,
        entity: Entity,
        (camera, extracted, image, depth, resolution): ViewParts<'w>,
        views: &'w LearnedViews,
    ) -> Option<Self> {
        let state = views.0.get(&extracted.retained_view_entity)?;
        Some(Self {
            world,
            entity,
            state,
            targets: state.targets.as_ref()?,
            image,
            depth,
            viewport: viewport_of(camera, resolution)?,
        })
    }

    /// A pass over all weighed surfaces.
    fn draw_surfaces(
        &self,
        context: &mut RenderContext<'_, '_>,
        pass: &Pass,
        (group, phase): &(BindGroup, SortedRenderPhase<Transparent3d>),
        attachments: &[Option<RenderPassColorAttachment<'_>>],
    ) {
        let diagnostics = context.diagnostic_recorder();
        let diagnostics = diagnostics.as_deref();
        let depth = (!pass.is_small()).then_some(self.depth);
        let mut drawing = context.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("peelnet_pass"),
            color_attachments: attachments,
            // Stored where nothing writes it, too: it would be lost otherwise.
            depth_stencil_attachment: depth.map(|depth| depth.get_attachment(StoreOp::Store)),
            ..default()
        });
        let span = diagnostics.pass_span(&mut drawing, format!("peelnet_{}", pass.name));
        let viewport = &self.viewport;
        let origin = viewport.physical_position.as_vec2() / pass.every as f32;
        let size = viewport.physical_size.as_vec2() / pass.every as f32;
        let Range { start, end } = viewport.depth;
        drawing.set_viewport(origin.x, origin.y, size.x, size.y, start, end);
        drawing.set_bind_group(GROUP, group, &[]);
        if let Err(problem) = phase.render(&mut drawing, self.world, self.entity) {
            error!("peelnet pass {:?}: {problem}", pass.name);
        }
        span.end(&mut drawing);
    }
}

pub(crate) fn learned_transparent_pass(
    world: &World,
    view: ViewQuery<ViewParts<'static>>,
    setup: Res<Setup>,
    views: Res<LearnedViews>,
    cache: Res<PipelineCache>,
    mut context: RenderContext<'_, '_>,
) {
    let Some(drawn) = Drawn::new(world, view.entity(), view.into_inner(), &views) else {
        return;
    };
    let (state, targets) = (drawn.state, drawn.targets);
    let pipeline = |id: Option<CachedRenderPipelineId>| cache.get_render_pipeline(id?);
    let Some(resolve) = pipeline(state.resolve) else {
        return;
    };
    let description = &setup.model.description;
    for (pass, surfaces) in description.passes.iter().zip(&targets.passes) {
        let attachments = pass.targets.iter();
        let attachments: Vec<_> = attachments
            .map(|target| Some(cleared(targets, &target.name, target.clear)))
            .collect();
        drawn.draw_surfaces(&mut context, pass, surfaces, &attachments);
        let around = description.around.as_ref().filter(|_| pass.is_small());
        if let (Some(around), Some(made_by), Some(group)) =
            (around, pipeline(state.around), &targets.around_group)
        {
            let texture = cleared(targets, &around.name, [0.0; 4]);
            let attachments = [Some(texture)];
            draw_pixels(
                &mut context,
                &around.name,
                &attachments,
                None,
                made_by,
                group,
            );
        }
    }
    let mut attachments = vec![Some(drawn.image.get_color_attachment())];
    if let Some(mask) = &targets.mask {
        let mut samples = cleared(targets, MASK, setup.model.mask.clear);
        let is_mean = mask.texture.id() != targets.textures[MASK].texture.id();
        samples.resolve_target = is_mean.then_some(&*mask.default_view);
        attachments.push(Some(samples));
    }
    let group = &targets.resolve_group;
    draw_pixels(
        &mut context,
        "resolve",
        &attachments,
        Some(&drawn.viewport),
        resolve,
        group,
    );
}

/// Writes the depth of the nearest weighed surface, where enough is covered.
pub(crate) fn learned_depth_pass(
    world: &World,
    view: ViewQuery<ViewParts<'static>>,
    setup: Res<Setup>,
    views: Res<LearnedViews>,
    mut context: RenderContext<'_, '_>,
) {
    let Some(drawn) = Drawn::new(world, view.entity(), view.into_inner(), &views) else {
        return;
    };
    let mut passes = setup.model.passes().zip(&drawn.targets.passes);
    if let Some((pass, surfaces)) = passes.find(|(pass, _)| pass.writes_depth) {
        drawn.draw_surfaces(&mut context, pass, surfaces, &[]);
    }
}

/// The part of its target that a camera draws into.
fn viewport_of(
    camera: &ExtractedCamera,
    resolution: Option<&MainPassResolutionOverride>,
) -> Option<Viewport> {
    let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
    viewport.or(camera.physical_target_size.map(|physical_size| Viewport {
        physical_size,
        ..default()
    }))
}

fn cleared<'a>(targets: &'a Targets, name: &str, clear: [f64; 4]) -> RenderPassColorAttachment<'a> {
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
}

/// A pass over the pixels of attachments, or over those of a viewport.
fn draw_pixels(
    context: &mut RenderContext<'_, '_>,
    name: &str,
    attachments: &[Option<RenderPassColorAttachment<'_>>],
    viewport: Option<&Viewport>,
    pipeline: &RenderPipeline,
    group: &BindGroup,
) {
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let mut drawing = context.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("peelnet_pass"),
        color_attachments: attachments,
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
