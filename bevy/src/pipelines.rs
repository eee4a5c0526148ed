//! Pipelines of the passes, made from those that Bevy makes for the same mesh and material.
//!
//! A transparent item of Bevy's has a pipeline, and with it a descriptor: vertex shader, bind groups, culling, definitions. The same descriptor with
//! another fragment shader, other targets and one bind group more is the item's pipeline in a pass of ours. So whatever Bevy or a material
//! specialises (skins, morph targets, bindless materials, fog) holds here too.

use crate::{
    model::{Around, Blend, Description, Pass, PeelnetModel, Target},
    shader_text::{GROUP, pass_define},
};
use bevy::{
    asset::AssetId,
    core_pipeline::FullscreenShader,
    platform::collections::{HashMap, HashSet},
    prelude::*,
    render::render_resource::{
        binding_types::{
            sampler, texture_2d, texture_2d_multisampled, texture_depth_2d,
            texture_depth_2d_multisampled, uniform_buffer,
        },
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
    /// Of passes over pixels.
    pub around: Handle<Shader>,
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
        let reads = Reads::of_pass(pass, samples);
        descriptor.layout.push(reads.layout(&setup.model));
        descriptor.multisample = MultisampleState {
            count: if pass.is_small() { 1 } else { samples },
            ..default()
        };
        if pass.is_small() {
            descriptor.depth_stencil = None;
        } else if let Some(depth) = &mut descriptor.depth_stencil {
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

/// A pass over pixels.
#[derive(Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub(crate) enum OverPixels {
    /// Makes the small texture.
    Around,
    /// Composites into a view's texture.
    Resolve { format: TextureFormat, samples: u32 },
}

impl SpecializedRenderPipeline for Setup {
    type Key = OverPixels;

    fn specialize(&self, key: Self::Key) -> RenderPipelineDescriptor {
        let Description {
            around,
            resolve_reads,
            ..
        } = &self.model.description;
        // The resolve's colour is multiplied by its coverage.
        let premultiplied = Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING);
        let (label, shader, reads, blend, format, samples) = match (key, around) {
            (OverPixels::Around, Some(around)) => (
                "peelnet_around_pipeline",
                &self.around,
                Reads::of_around(around),
                None,
                around.format,
                1,
            ),
            (OverPixels::Resolve { format, samples }, _) => (
                "peelnet_resolve_pipeline",
                &self.resolve,
                Reads::new(resolve_reads, samples),
                premultiplied,
                format,
                samples,
            ),
            _ => unreachable!("asked for where a network reads one alone"),
        };
        let multisampled = (samples > 1).then(|| "MULTISAMPLED".into());
        RenderPipelineDescriptor {
            label: Some(label.into()),
            layout: vec![reads.layout(&self.model)],
            vertex: self.fullscreen.to_vertex_state(),
            fragment: Some(FragmentState {
                shader: shader.clone(),
                shader_defs: multisampled.into_iter().collect(),
                targets: vec![Some(ColorTargetState {
                    format,
                    blend,
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

/// What a pass reads beside the range of depths: one bind group.
pub(crate) struct Reads<'a> {
    /// Targets of earlier passes, or the small texture.
    pub names: Vec<&'a String>,
    /// Of the targets.
    samples: u32,
    /// Of the depths of opaque surfaces, where they are read.
    pub depth_samples: Option<u32>,
}

impl<'a> Reads<'a> {
    pub fn new(names: impl IntoIterator<Item = &'a String>, samples: u32) -> Self {
        Self {
            names: names.into_iter().collect(),
            samples,
            depth_samples: None,
        }
    }

    /// Of a pass over surfaces, in a view of so many samples.
    pub fn of_pass(pass: &'a Pass, samples: u32) -> Self {
        Self {
            depth_samples: pass.is_small().then_some(samples),
            ..Self::new(&pass.reads, samples)
        }
    }

    /// Of the pass that makes the small texture.
    pub fn of_around(around: &'a Around) -> Self {
        Self::new(around.pass.targets.iter().map(|target| &target.name), 1)
    }

    pub fn layout(&self, model: &PeelnetModel) -> BindGroupLayoutDescriptor {
        let texture = |samples, filterable| {
            let kind = TextureSampleType::Float { filterable };
            if samples > 1 {
                texture_2d_multisampled(kind)
            } else {
                texture_2d(kind)
            }
        };
        let mut entries = vec![(0, uniform_buffer::<Vec4>(false))];
        for read in &self.names {
            let is_around = model.is_around(read);
            let samples = if is_around { 1 } else { self.samples };
            entries.push((model.binding(read), texture(samples, is_around)));
            if is_around {
                let bilinear = sampler(SamplerBindingType::Filtering);
                entries.push((model.sampler_binding(), bilinear));
            }
        }
        entries.extend(self.depth_samples.map(|samples| {
            let depth = if samples > 1 {
                texture_depth_2d_multisampled()
            } else {
                texture_depth_2d()
            };
            (model.depth_binding(), depth)
        }));
        let entries = entries.into_iter();
        let entries = entries.map(|(binding, ty)| ty.build(binding, ShaderStages::FRAGMENT));
        BindGroupLayoutDescriptor::new("peelnet_layout", &entries.collect::<Vec<_>>())
    }
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
