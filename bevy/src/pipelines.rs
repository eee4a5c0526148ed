//! Pipelines of the passes, made from those that Bevy makes for the same mesh and material.
//!
//! A transparent item of Bevy's has a pipeline, and with it a descriptor: vertex shader, bind groups, culling, definitions. The same descriptor with
//! another fragment shader, other targets and more bindings in one of its groups is the item's pipeline in a pass of ours. So whatever Bevy or a
//! material specialises (skins, morph targets, bindless materials, fog) holds here too.

use crate::{
    group::{GROUP, Reads, excess},
    model::{Blend, Description, Pass, PeelnetModel, Target},
    shader_text::pass_define,
};
use bevy::{
    asset::AssetId,
    core_pipeline::FullscreenShader,
    platform::collections::{HashMap, HashSet},
    prelude::*,
    render::render_resource::*,
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
    /// More is needed than the device allows.
    Excess(String),
    Ready,
}

/// Pipelines of all passes, by the pipeline of Bevy's that they are made from.
#[derive(Default, Resource)]
pub(crate) struct LearnedPipelines(
    pub HashMap<CachedRenderPipelineId, Vec<CachedRenderPipelineId>>,
);

impl LearnedPipelines {
    /// Asks for the pipelines of all passes, and says whether they can be drawn with. That of depth is drawn with once it is there.
    pub fn find(
        &mut self,
        base: CachedRenderPipelineId,
        writes_depth: bool,
        cache: &PipelineCache,
        setup: &Setup,
        hooked: &HookedShaders,
        limits: &WgpuLimits,
    ) -> Found {
        let needed = setup.model.description.passes.len();
        let wanted = needed + usize::from(writes_depth);
        let known = self.0.entry(base).or_default();
        if known.len() < wanted {
            // Pipelines that were asked for in this frame are not in the list yet.
            let Some(cached) = cache.pipelines().nth(base.id()) else {
                return Found::Waiting;
            };
            match learned_descriptors(&cached.descriptor, setup, hooked, limits) {
                Ok(all) => {
                    let new = all.into_iter().take(wanted).skip(known.len());
                    known.extend(new.map(|d| cache.queue_render_pipeline(d)));
                }
                Err(found) => return found,
            }
        }
        let mut needed = known.iter().take(needed);
        if needed.all(|id| cache.get_render_pipeline(*id).is_some()) {
            Found::Ready
        } else {
            Found::Waiting
        }
    }
}

/// The pipelines of all passes, or why there are none.
fn learned_descriptors(
    base: &PipelineDescriptor,
    setup: &Setup,
    hooked: &HookedShaders,
    limits: &WgpuLimits,
) -> Result<Vec<RenderPipelineDescriptor>, Found> {
    let PipelineDescriptor::RenderPipelineDescriptor(base) = base else {
        return Err(Found::NoHook);
    };
    let shader = base.fragment.as_ref().map(|fragment| &fragment.shader);
    let shader = match shader {
        Some(shader) if shader.id() == setup.bevy_standard.id() => &setup.standard,
        Some(shader) if hooked.0.contains(&shader.id()) => shader,
        _ => return Err(Found::NoHook),
    };
    let descriptor = |(number, pass): (usize, &Pass)| {
        let mut descriptor = RenderPipelineDescriptor::clone(base);
        descriptor.label = Some(format!("peelnet_{}_pipeline", pass.name).into());
        let samples = descriptor.multisample.count;
        let group = &mut descriptor.layout[GROUP];
        *group = Reads::of_pass(pass, samples).layout(&setup.model, &group.entries);
        if let Some(excess) = excess(&descriptor.layout, limits) {
            return Err(Found::Excess(excess));
        }
        descriptor.multisample = MultisampleState {
            count: if pass.is_small() { 1 } else { samples },
            ..default()
        };
        if pass.is_small() {
            descriptor.depth_stencil = None;
        } else if let Some(depth) = &mut descriptor.depth_stencil {
            depth.depth_write_enabled = Some(pass.writes_depth);
        }
        let fragment = descriptor.fragment.get_or_insert_default();
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
        Ok(descriptor)
    };
    let passes = setup.model.passes().enumerate();
    passes.map(descriptor).collect()
}

/// A pass over pixels.
#[derive(Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub(crate) enum OverPixels {
    /// Makes the small texture.
    Around,
    /// Composites into a view's texture, and into a mask.
    Resolve {
        format: TextureFormat,
        samples: u32,
        mask: bool,
    },
}

impl SpecializedRenderPipeline for Setup {
    type Key = OverPixels;

    fn specialize(&self, key: Self::Key) -> RenderPipelineDescriptor {
        let Description {
            around,
            resolve_reads,
            ..
        } = &self.model.description;
        let target = |format, blend| ColorTargetState {
            format,
            blend,
            write_mask: ColorWrites::ALL,
        };
        let (label, shader, reads, targets, samples, defines) = match (key, around) {
            (OverPixels::Around, Some(around)) => (
                "peelnet_around_pipeline",
                &self.around,
                Reads::of_around(around),
                vec![target(around.format, None)],
                1,
                vec![],
            ),
            (
                OverPixels::Resolve {
                    format,
                    samples,
                    mask,
                },
                _,
            ) => {
                // The colour is multiplied by its coverage.
                let premultiplied = Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING);
                let mut targets = vec![target(format, premultiplied)];
                let mut defines = vec![];
                if samples > 1 {
                    defines.push("MULTISAMPLED".into());
                }
                if mask {
                    targets.push(target(self.model.mask.format, None));
                    defines.push("PEELNET_MASK".into());
                }
                (
                    "peelnet_resolve_pipeline",
                    &self.resolve,
                    Reads::new(resolve_reads, samples),
                    targets,
                    samples,
                    defines,
                )
            }
            _ => unreachable!("asked for where a network reads one alone"),
        };
        RenderPipelineDescriptor {
            label: Some(label.into()),
            layout: vec![reads.layout(&self.model, &[])],
            vertex: self.fullscreen.to_vertex_state(),
            fragment: Some(FragmentState {
                shader: shader.clone(),
                shader_defs: defines,
                targets: targets.into_iter().map(Some).collect(),
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
