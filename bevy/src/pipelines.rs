//! Pipelines of the passes, made from those that Bevy makes for the same mesh and material.
//!
//! A transparent item of Bevy's has a pipeline, and with it a descriptor: vertex shader, bind groups, culling, definitions. The same descriptor with
//! another fragment shader, other targets and one bind group more is the item's pipeline in a pass of ours. So whatever Bevy or a material
//! specialises (skins, morph targets, bindless materials, fog) holds here too.

use crate::{
    model::{Blend, PeelnetModel, Target},
    shader_text::{GROUP, binding, pass_define},
};
use bevy::{
    asset::AssetId,
    core_pipeline::FullscreenShader,
    platform::collections::{HashMap, HashSet},
    prelude::*,
    render::render_resource::{
        BindGroupLayoutDescriptor, BindGroupLayoutEntryBuilder, BlendComponent, BlendFactor,
        BlendOperation, BlendState, CachedRenderPipelineId, ColorTargetState, ColorWrites,
        FragmentState, MultisampleState, PipelineCache, PipelineDescriptor,
        RenderPipelineDescriptor, ShaderStages, TextureFormat, TextureSampleType,
        binding_types::{texture_2d, texture_2d_multisampled, uniform_buffer},
    },
    shader::{Shader, ShaderDefVal},
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
    /// For one sample a pixel, and for several.
    pub resolve: [Handle<Shader>; 2],
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

/// Pipelines by the pipeline of Bevy's that they are made from.
#[derive(Default, Resource)]
pub(crate) struct LearnedPipelines {
    by_base: HashMap<CachedRenderPipelineId, Option<Vec<CachedRenderPipelineId>>>,
    resolve: HashMap<(TextureFormat, u32), CachedRenderPipelineId>,
}

impl LearnedPipelines {
    /// Asks for the pipelines of all passes, and says whether they can be drawn with.
    pub fn find(
        &mut self,
        base: CachedRenderPipelineId,
        cache: &PipelineCache,
        setup: &Setup,
        hooked: &HookedShaders,
    ) -> Found {
        if !self.by_base.contains_key(&base) {
            // Pipelines that were asked for in this frame are not in the list yet.
            let Some(cached) = cache.pipelines().nth(base.id()) else {
                return Found::Waiting;
            };
            let PipelineDescriptor::RenderPipelineDescriptor(descriptor) = &cached.descriptor
            else {
                return Found::NoHook;
            };
            let pipelines = learned_descriptors(descriptor, setup, hooked)
                .map(|all| all.into_iter().map(|d| cache.queue_render_pipeline(d)));
            self.by_base.insert(base, pipelines.map(Iterator::collect));
        }
        let is_ready = |&id: &CachedRenderPipelineId| cache.get_render_pipeline(id).is_some();
        match self.by_base.get(&base) {
            Some(Some(ids)) if ids.iter().all(is_ready) => Found::Ready,
            Some(None) => Found::NoHook,
            _ => Found::Waiting,
        }
    }

    /// The pipeline of a pass.
    pub fn get(&self, base: CachedRenderPipelineId, pass: usize) -> Option<CachedRenderPipelineId> {
        self.by_base.get(&base)?.as_ref()?.get(pass).copied()
    }

    /// The pipeline that composites into the view's texture.
    pub fn resolve(
        &mut self,
        format: TextureFormat,
        samples: u32,
        cache: &PipelineCache,
        setup: &Setup,
        fullscreen: &FullscreenShader,
    ) -> CachedRenderPipelineId {
        *self.resolve.entry((format, samples)).or_insert_with(|| {
            cache.queue_render_pipeline(resolve_descriptor(format, samples, setup, fullscreen))
        })
    }

    /// A shader came or changed: those that had no hook may have one now.
    pub fn ask_again(&mut self) {
        self.by_base.retain(|_, pipelines| pipelines.is_some());
    }
}

fn learned_descriptors(
    base: &RenderPipelineDescriptor,
    setup: &Setup,
    hooked: &HookedShaders,
) -> Option<Vec<RenderPipelineDescriptor>> {
    let fragment = base.fragment.as_ref()?;
    let shader = if fragment.shader.id() == setup.bevy_standard.id() {
        &setup.standard
    } else if hooked.0.contains(&fragment.shader.id()) {
        &fragment.shader
    } else {
        return None;
    };
    // The group of the statistics must be free.
    if base.layout.len() != GROUP {
        return None;
    }
    let model = &setup.model;
    let descriptor = |(number, pass): (usize, &crate::model::Pass)| {
        let mut descriptor = base.clone();
        descriptor.label = Some(format!("peelnet_{}_pipeline", pass.name).into());
        let samples = descriptor.multisample.count;
        descriptor
            .layout
            .push(layout_of(&pass.reads, samples, true));
        descriptor.multisample = MultisampleState {
            count: samples,
            ..default()
        };
        if let Some(depth) = &mut descriptor.depth_stencil {
            depth.depth_write_enabled = Some(false);
        }
        let fragment = descriptor.fragment.as_mut()?;
        fragment.shader = shader.clone();
        fragment.targets = model.targets[pass.targets.clone()]
            .iter()
            .map(|target| Some(state_of(target)))
            .collect();
        let defines = [
            Some("PEELNET".to_owned()),
            Some(pass_define(number)),
            pass.needs_alpha.then(|| "PEELNET_NEEDS_ALPHA".to_owned()),
            pass.needs_color.then(|| "PEELNET_NEEDS_COLOR".to_owned()),
        ];
        let defines = defines.into_iter().flatten().map(ShaderDefVal::from);
        fragment.shader_defs.extend(defines);
        Some(descriptor)
    };
    model.passes.iter().enumerate().map(descriptor).collect()
}

fn resolve_descriptor(
    format: TextureFormat,
    samples: u32,
    setup: &Setup,
    fullscreen: &FullscreenShader,
) -> RenderPipelineDescriptor {
    RenderPipelineDescriptor {
        label: Some("peelnet_resolve_pipeline".into()),
        layout: vec![layout_of(&setup.model.resolve_reads, samples, false)],
        vertex: fullscreen.to_vertex_state(),
        fragment: Some(FragmentState {
            shader: setup.resolve[usize::from(samples > 1)].clone(),
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

/// The layout of a bind group with the targets that are read, and with the range of depths in passes over surfaces.
pub(crate) fn layout_of(
    targets: &[usize],
    samples: u32,
    with_depths: bool,
) -> BindGroupLayoutDescriptor {
    let depths = uniform_buffer::<Vec4>(false);
    let not_filtered = TextureSampleType::Float { filterable: false };
    let texture = if samples > 1 {
        texture_2d_multisampled(not_filtered)
    } else {
        texture_2d(not_filtered)
    };
    let entry =
        |binding, ty: BindGroupLayoutEntryBuilder| ty.build(binding, ShaderStages::FRAGMENT);
    let mut entries: Vec<_> = with_depths.then(|| entry(0, depths)).into_iter().collect();
    entries.extend(targets.iter().map(|&t| entry(binding(t), texture)));
    BindGroupLayoutDescriptor::new("peelnet_layout", &entries)
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
