//! Order-independent transparency with learned weights, for Bevy.
//!
//! Transparent surfaces may be drawn in any order, may intersect, and nothing is sorted. A frame goes like this:
//!
//! 1. Bevy draws what is opaque, as ever.
//! 2. **Range**: all transparent surfaces write the two ends of their pixel's depths, under MAX. Nothing is lit.
//! 3. **Statistics**: all write what a pixel keeps of its layers into two to four targets, under MAX and ADD. Nothing is lit.
//! 4. **Weights**: all are lit, and add their colours, each weighed by a small network that guesses from the statistics how much of the
//!    surface is visible.
//! 5. **Resolve**: the sums become the pixel's colour, over the opaque scene. Tone mapping and the rest of Bevy's frame follow.
//!
//! The passes, their targets and their shader text come from the exported network ([`PeelnetModel`]); nothing here depends on a recipe.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_peelnet::{LearnedTransparency, PeelnetPlugin};
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, PeelnetPlugin::default()))
//!     .add_systems(Startup, |mut commands: Commands| {
//!         commands.spawn((Camera3d::default(), LearnedTransparency::default()));
//!     })
//!     .run();
//! ```
//!
//! # Materials
//!
//! `StandardMaterial`, and extensions of it that keep its fragment shader, need nothing. A material with a fragment shader of its own imports
//! two names from `bevy_peelnet::draw` and returns another structure in our passes:
//!
//! ```wgsl
//! @if(PEELNET)
//! import bevy_peelnet::draw::{PeelnetOutput, peelnet_output};
//!
//! fn shade(in: VertexOutput) -> vec4f { /* as before */ }
//!
//! @if(!PEELNET)
//! @fragment
//! fn fragment(in: VertexOutput) -> @location(0) vec4f { return shade(in); }
//!
//! @if(PEELNET)
//! @fragment
//! fn fragment(in: VertexOutput, @builtin(sample_index) sample_index: u32) -> PeelnetOutput {
//!     return peelnet_output(in.position, sample_index, shade(in));
//! }
//! ```
//!
//! `PEELNET_NEEDS_COLOR` is defined in the pass that needs the lit colour, `PEELNET_NEEDS_ALPHA` where at least opacity matters. Materials that
//! do not import the module are drawn by Bevy, sorted, over the weighed surfaces, and a message says so once. So are `AlphaMode::Add` and
//! `AlphaMode::Multiply`, without a message.
//!
//! # What is refused
//!
//! A network of another version or recipe, a device without five bind groups or the needed blending, and a camera that has Bevy's
//! own technique as well: one message each ([`PeelnetMessages`], and the log), and Bevy draws the scene as if the plugin were not there.
//!
//! A lost device is Bevy's to replace (`RenderErrorHandler`, by default it quits). Where it does, learned transparency uses the new one.

mod depths;
mod device;
mod error;
mod model;
mod pass;
mod phase;
mod pipelines;
mod shader_text;
mod view;

pub use error::{Gravity, PeelnetError, PeelnetMessages};
pub use model::PeelnetModel;

use bevy::{
    core_pipeline::{
        FullscreenShader,
        core_3d::{main_opaque_pass_3d, main_transparent_pass_3d},
        schedule::{Core3d, Core3dSystems},
    },
    pbr::{MeshPipeline, main_transmissive_pass_3d},
    platform::collections::HashSet,
    prelude::*,
    render::{
        Extract, ExtractSchedule, GpuResourceAppExt, Render, RenderApp, RenderDebugFlags,
        RenderStartup, RenderSystems,
        extract_component::{ExtractComponent, ExtractComponentPlugin},
        render_phase::{AddRenderCommand, DrawFunctions, SortedRenderPhasePlugin},
        render_resource::SpecializedRenderPipelines,
    },
    shader::{Shader, ShaderImport},
};
use pipelines::{HookedShaders, LearnedPipelines, Setup};

/// The path of Bevy's fragment shader of `StandardMaterial`.
const BEVY_STANDARD: &str = "embedded://bevy_pbr/render/pbr.wesl";
/// What materials import.
const HOOK: &str = "bevy_peelnet::draw";

/// Where the range of depths comes from that transparent surfaces span.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub enum DepthRange {
    /// From the boxes (`Aabb`) of the transparent meshes in view, every frame.
    #[default]
    Boxes,
    /// Distances along the view's axis. For vertex shaders that move surfaces out of their boxes.
    Fixed {
        /// Of the nearest surface.
        near: f32,
        /// Of the farthest surface.
        far: f32,
    },
}

/// Draws the transparent surfaces of a 3D camera in any order, with learned weights.
///
/// Works with every [`Msaa`]: statistics and sums are kept by sample, and the passes shade by sample. Works with or without a depth prepass.
#[derive(Clone, Component, Copy, Debug, Default, ExtractComponent, PartialEq, Reflect)]
#[extract_app(RenderApp)]
#[reflect(Component, Default)]
pub struct LearnedTransparency {
    /// Where the range of depths comes from.
    pub depth_range: DepthRange,
}

/// Adds [`LearnedTransparency`]. Must come after `DefaultPlugins`.
pub struct PeelnetPlugin {
    model: Result<PeelnetModel, PeelnetError>,
}

impl Default for PeelnetPlugin {
    /// With [`PeelnetModel::medium`].
    fn default() -> Self {
        PeelnetModel::medium().into()
    }
}

impl From<PeelnetModel> for PeelnetPlugin {
    fn from(model: PeelnetModel) -> Self {
        Self { model: Ok(model) }
    }
}

impl From<Result<PeelnetModel, PeelnetError>> for PeelnetPlugin {
    /// With a network that may be refused. Then the plugin reports why, and Bevy draws the scene.
    fn from(model: Result<PeelnetModel, PeelnetError>) -> Self {
        Self { model }
    }
}

impl Plugin for PeelnetPlugin {
    fn build(&self, app: &mut App) {
        let messages = PeelnetMessages::default();
        app.insert_resource(messages.clone())
            .register_type::<LearnedTransparency>();
        if app.get_sub_app(RenderApp).is_none() {
            // An application without a renderer may share code with one that has it.
            let text =
                "nothing is rendered: PeelnetPlugin found no renderer; add it after DefaultPlugins";
            messages.report(Gravity::Warning, text.into());
            return;
        }
        app.add_plugins((
            ExtractComponentPlugin::<LearnedTransparency>::default(),
            SortedRenderPhasePlugin::<phase::Learned3d, MeshPipeline>::new(
                RenderDebugFlags::default(),
            ),
        ));
        let setup = match &self.model {
            Ok(model) => Some(setup_of(app, model)),
            Err(error) => {
                let text =
                    format!("no learned transparency: {error}. Bevy draws transparent surfaces");
                messages.report(Gravity::Error, text);
                None
            }
        };
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        if let Some(setup) = setup {
            render_app.insert_resource(setup);
        }
        render_app
            .insert_resource(messages)
            .init_resource::<depths::Boxes>()
            .init_resource::<HookedShaders>()
            .init_gpu_resource::<device::Refusals>()
            .init_gpu_resource::<LearnedPipelines>()
            .init_gpu_resource::<SpecializedRenderPipelines<Setup>>()
            .init_gpu_resource::<view::LearnedViews>()
            .init_resource::<DrawFunctions<phase::Learned3d>>()
            .add_render_command::<phase::Learned3d, pass::DrawLearned>()
            .add_systems(RenderStartup, report_new_device)
            .add_systems(
                ExtractSchedule,
                (extract_hooked_shaders, depths::extract_boxes),
            )
            .add_systems(
                Render,
                (
                    phase::lend_items
                        .after(RenderSystems::Queue)
                        .before(RenderSystems::PhaseSort),
                    view::prepare_views.in_set(RenderSystems::PrepareResources),
                    phase::return_items.in_set(RenderSystems::Cleanup),
                ),
            )
            .add_systems(
                Core3d,
                pass::learned_transparent_pass
                    .after(main_opaque_pass_3d)
                    .after(main_transmissive_pass_3d)
                    .before(main_transparent_pass_3d)
                    .in_set(Core3dSystems::MainPass),
            );
    }
}

/// Adds the shaders of a network. Their paths are what other shaders import them by.
fn setup_of(app: &mut App, model: &PeelnetModel) -> Setup {
    let render = app.sub_app(RenderApp).world();
    let fullscreen = render.resource::<FullscreenShader>().clone();
    let bevy_standard = app.world().resource::<AssetServer>().load(BEVY_STANDARD);
    let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
    let mut add = |name: &str, text: String| {
        let path = format!("embedded://bevy_peelnet/{name}.wesl");
        shaders.add(Shader::from_wesl(text, path))
    };
    Setup {
        bevy_standard,
        standard: add("standard", include_str!("standard.wesl").to_owned()),
        draw: add("draw", shader_text::draw_text(model)),
        resolve: add("resolve", shader_text::resolve_text(model)),
        fullscreen,
        model: model.clone(),
    }
}

/// Bevy makes another device where the application's `RenderErrorHandler` asks for it. Pipelines and targets are of the device, and made again.
fn report_new_device(messages: Res<PeelnetMessages>, mut had_one: Local<bool>) {
    if *had_one {
        let text = "Bevy replaced the graphics device, after an error or because it was lost: learned transparency uses the new one";
        messages.report(Gravity::Info, text.into());
    }
    *had_one = true;
}

fn extract_hooked_shaders(
    shaders: Extract<Res<Assets<Shader>>>,
    mut hooked: ResMut<HookedShaders>,
    pipelines: Option<ResMut<LearnedPipelines>>,
) {
    if !shaders.is_changed() {
        return;
    }
    let imports_hook = |shader: &Shader| {
        shader.imports.iter().any(|import| match import {
            ShaderImport::Custom(path) => path.starts_with(HOOK),
            ShaderImport::AssetPath(_) => false,
        })
    };
    let all = shaders.iter().filter(|(_, shader)| imports_hook(shader));
    let all: HashSet<_> = all.map(|(id, _)| id).collect();
    if all != hooked.0 {
        hooked.0 = all;
        if let Some(mut pipelines) = pipelines {
            pipelines.ask_again();
        }
    }
}
