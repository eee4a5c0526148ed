//! Pipelines of the passes, made from those that Bevy makes for the same mesh and material.
//!
//! A transparent item of Bevy's has a pipeline, and with it a descriptor: vertex shader, bind groups, culling, definitions. The same descriptor with
//! another fragment shader, other targets and one bind group more is the item's pipeline in a pass of ours. So whatever Bevy or a material
//! specialises (skins, morph targets, bindless materials, fog) holds here too.

use crate::{
    model::{Blend, Pass, PeelnetModel, Target},
    shader_text::{GROUP, pass_define},
};
use bevy::{
    asset::AssetId,
    core_pipeline::FullscreenShader,
    platform::collections::{HashMap, HashSet},
    prelude::*,
    render::render_resource::{
        binding_types::{texture_2d, texture_2d_multisampled, uniform_buffer},
        *,
    },
    shader::Shader,
};

/// The network in use and the shaders around it, for the life of the application.
#[derive(Clone, Resource)]
pub(crate) struct Setup {
    pub model: PeelnetModel,
    /// Bevy's shader of StandardMaterial, and the one that replaces it.
    pub bevy_standard: Handle<Shader>,
    pub standard: Handle<Shader>,
    /// Kept alive: materials import it by its path.
    #[expect(dead_code, reason = "held, not read")]
    pub draw: Handle<Shader>,
    pub resolve: Handle<Shader>,
    pub fullscreen: FullscreenShader,
}

/// Fragment shaders of materials that import `bevy_peelnet::draw`.
#[derive(Default, Resource)]
pub(crate) struct HookedShaders(pub HashSet<AssetId<Shader>>);

/// What is known of the passes' pipelines for one of Bevy's.
pub(crate) enum Found {
    /// Bevy's own is not there yet, or ours are compiled.
    Waiting,
    /// The material's shader does not import `bevy_peelnet::draw`.
    NoHook,
    Ready,
}

/// Pipelines of all passes, by the pipeline of Bevy's that they are made from.
#[derive(Default, Resource)]
pub(crate) struct LearnedPipelines(
    pub HashMap<CachedRenderPipelineId, Vec<CachedRenderPipelineId>>,
);

impl LearnedPipelines {
    /// Asks for the pipelines of all passes, and says whether they can be drawn with.
    pub fn find(
        &mut self,
        base: CachedRenderPipelineId,
        cache: &PipelineCache,
        setup: &Setup,
        hooked: &HookedShaders,
    ) -> Found {
        if !self.0.contains_key(&base) {
            // Pipelines that were asked for in this frame are not in the list yet.
            let Some(cached) = cache.pipelines().nth(base.id()) else {
                return Found::Waiting;
            };
            let Some(all) = learned_descriptors(&cached.descriptor, setup, hooked) else {
                return Found::NoHook;
            };
            let queued = all.into_iter().map(|d| cache.queue_render_pipeline(d));
            self.0.insert(base, queued.collect());
        }
        let is_ready = |&id: &CachedRenderPipelineId| cache.get_render_pipeline(id).is_some();
        if self.0[&base].iter().all(is_ready) {
            Found::Ready
        } else {
            Found::Waiting
        }
    }
}

fn learned_descriptors(
    base: &PipelineDescriptor,
    setup: &Setup,
    hooked: &HookedShaders,
) -> Option<Vec<RenderPipelineDescriptor>> {
    let PipelineDescriptor::RenderPipelineDescriptor(base) = base else {
        return None;
    };
    let shader = &base.fragment.as_ref()?.shader;
    let shader = if shader.id() == setup.bevy_standard.id() {
        &setup.standard
    } else if hooked.0.contains(&shader.id()) {
        shader
    } else {
        return None;
    };
    // The group of the statistics must be free.
    if base.layout.len() != GROUP {
        return None;
    }
    let descriptor = |(number, pass): (usize, &Pass)| {
        let mut descriptor = RenderPipelineDescriptor::clone(base);
        descriptor.label = Some(format!("peelnet_{}_pipeline", pass.name).into());
        let samples = descriptor.multisample.count;
        let layout = layout_of(&setup.model, &pass.reads, samples);
        descriptor.layout.push(layout);
        descriptor.multisample = MultisampleState {
            count: samples,
            ..default()
        };
        if let Some(depth) = &mut descriptor.depth_stencil {
            depth.depth_write_enabled = Some(false);
        }
        let fragment = descriptor.fragment.as_mut()?;
        fragment.shader = shader.clone();
        let targets = pass.targets.iter();
        fragment.targets = targets.map(|target| Some(state_of(target))).collect();
        let defines = &mut fragment.shader_defs;
        defines.extend(["PEELNET".into(), pass_define(number).into()]);
        for (variable, define) in [
            ("alpha", "PEELNET_NEEDS_ALPHA"),
            ("rgb", "PEELNET_NEEDS_COLOR"),
        ] {
            if pass.needs(variable) {
                defines.push(define.into());
            }
        }
        Some(descriptor)
    };
    let passes = setup.model.description.passes.iter();
    passes.enumerate().map(descriptor).collect()
}

/// The pipeline that composites into a view's texture, by its format and samples.
impl SpecializedRenderPipeline for Setup {
    type Key = (TextureFormat, u32);

    fn specialize(&self, (format, samples): Self::Key) -> RenderPipelineDescriptor {
        let reads = &self.model.description.resolve_reads;
        let multisampled = (samples > 1).then(|| "MULTISAMPLED".into());
        RenderPipelineDescriptor {
            label: Some("peelnet_resolve_pipeline".into()),
            layout: vec![layout_of(&self.model, reads, samples)],
            vertex: self.fullscreen.to_vertex_state(),
            fragment: Some(FragmentState {
                shader: self.resolve.clone(),
                shader_defs: multisampled.into_iter().collect(),
                targets: vec![Some(ColorTargetState {
                    format,
                    // The resolve's colour is multiplied by its coverage.
                    blend: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: ColorWrites::ALL,
                })],
                ..default()
            }),
            multisample: MultisampleState {
                count: samples,
                ..default()
            },
            ..default()
        }
    }
}

/// The layout of a bind group with the range of depths and the targets that are read.
pub(crate) fn layout_of(
    model: &PeelnetModel,
    targets: &[String],
    samples: u32,
) -> BindGroupLayoutDescriptor {
    let not_filtered = TextureSampleType::Float { filterable: false };
    let texture = if samples > 1 {
        texture_2d_multisampled(not_filtered)
    } else {
        texture_2d(not_filtered)
    };
    let read = targets.iter().map(|t| (model.binding(t), texture));
    let entries = std::iter::once((0, uniform_buffer::<Vec4>(false))).chain(read);
    let entries = entries.map(|(binding, ty)| ty.build(binding, ShaderStages::FRAGMENT));
    BindGroupLayoutDescriptor::new("peelnet_layout", &entries.collect::<Vec<_>>())
}

fn state_of(target: &Target) -> ColorTargetState {
    let component = |blend| BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::One,
        operation: if blend == Blend::Max {
            BlendOperation::Max
        } else {
            BlendOperation::Add
        },
    };
    ColorTargetState {
        format: target.format,
        blend: Some(BlendState {
            color: component(target.color),
            alpha: component(target.alpha),
        }),
        write_mask: ColorWrites::ALL,
    }
}
