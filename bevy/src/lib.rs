#![doc = include_str!("../README.md")]

mod depths;
mod device;
mod error;
mod group;
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
        core_3d::{Transparent3d, main_opaque_pass_3d, main_transparent_pass_3d},
        schedule::{Core3d, Core3dSystems},
    },
    pbr::main_transmissive_pass_3d,
    prelude::*,
    render::{
        Extract, ExtractSchedule, GpuResourceAppExt, Render, RenderApp, RenderStartup,
        RenderSystems,
        extract_component::{ExtractComponent, ExtractComponentPlugin},
        render_phase::AddRenderCommand,
        render_resource::SpecializedRenderPipelines,
        texture::CachedTexture,
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
    /// Coverage at and above which transparent surfaces write the depth of their nearest fragment into the camera's depth texture: for depth of field
    /// and whatever else reads it after the main pass. Costs one more drawing of all of them, without light.
    pub depth_threshold: Option<f32>,
    /// Whether render systems get a [`CoverageMask`].
    pub mask: bool,
}

/// How much of each pixel the weighed surfaces cover, from 0 to 1, in the first channel: for render systems such as those of temporal anti-aliasing and
/// denoisers.
///
/// A component of the view's entity in the render world, from the preparation of bind groups to the end of the frame. The texture has the size of the camera's target
/// and one sample a pixel, and is drawn before Bevy's own transparent surfaces. Views that [ask for it](LearnedTransparency::mask) have it in each
/// frame in which a surface is weighed.
#[derive(Clone, Component)]
pub struct CoverageMask(pub CachedTexture);

/// Adds [`LearnedTransparency`]. Must come after `DefaultPlugins`.
pub struct PeelnetPlugin(Result<PeelnetModel, PeelnetError>);

impl Default for PeelnetPlugin {
    /// With [`PeelnetModel::medium`].
    fn default() -> Self {
        PeelnetModel::medium().into()
    }
}

impl From<PeelnetModel> for PeelnetPlugin {
    fn from(model: PeelnetModel) -> Self {
        Self(Ok(model))
    }
}

impl From<Result<PeelnetModel, PeelnetError>> for PeelnetPlugin {
    /// With a network that may be refused. Then the plugin reports why, and Bevy draws the scene.
    fn from(model: Result<PeelnetModel, PeelnetError>) -> Self {
        Self(model)
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
        let model = match &self.0 {
            Ok(model) => model,
            Err(error) => {
                let text =
                    format!("no learned transparency: {error}. Bevy draws transparent surfaces");
                messages.report(Gravity::Error, text);
                return;
            }
        };
        app.add_plugins(ExtractComponentPlugin::<LearnedTransparency>::default());
        let setup = setup_of(app, model);
        app.sub_app_mut(RenderApp)
            .insert_resource(setup)
            .insert_resource(messages)
            .init_resource::<depths::Boxes>()
            .init_resource::<HookedShaders>()
            .init_gpu_resource::<device::Refusals>()
            .init_gpu_resource::<LearnedPipelines>()
            .init_gpu_resource::<SpecializedRenderPipelines<Setup>>()
            .init_gpu_resource::<view::Bilinear>()
            .init_gpu_resource::<view::LearnedViews>()
            .add_render_command::<Transparent3d, phase::DrawWeighed>()
            .add_systems(RenderStartup, report_new_device)
            .add_systems(
                ExtractSchedule,
                (extract_hooked_shaders, depths::extract_boxes),
            )
            .add_systems(
                Render,
                (
                    phase::mark_items
                        .after(RenderSystems::PhaseSort)
                        .before(RenderSystems::Prepare),
                    view::prepare_views.in_set(RenderSystems::PrepareBindGroups),
                    phase::return_items.in_set(RenderSystems::Cleanup),
                ),
            )
            .add_systems(
                Core3d,
                (
                    pass::learned_transparent_pass
                        .after(main_opaque_pass_3d)
                        .after(main_transmissive_pass_3d)
                        .before(main_transparent_pass_3d)
                        .in_set(Core3dSystems::MainPass),
                    // Behind volumetric fog, which counts up to opaque surfaces and is drawn between these sets.
                    pass::learned_depth_pass.in_set(Core3dSystems::EarlyPostProcess),
                ),
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
        around: add("around", shader_text::around_text(model)),
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
) {
    if shaders.is_changed() {
        let is_hook = |import: &ShaderImport| match import {
            ShaderImport::Custom(path) => path.starts_with(HOOK),
            ShaderImport::AssetPath(_) => false,
        };
        let all = shaders.iter();
        let all = all.filter(|(_, shader)| shader.imports.iter().any(is_hook));
        hooked.0 = all.map(|(id, _)| id).collect();
    }
}
