//! What cannot be used is said once, and the scene is drawn as Bevy draws it.

#[path = "../examples/support/mod.rs"]
mod support;

use bevy::{
    core_pipeline::oit::OrderIndependentTransparencySettings,
    light::cluster::GlobalClusterSettings,
    prelude::*,
    render::{
        RenderApp,
        error_handler::{RenderErrorHandler, RenderErrorPolicy},
        render_resource::PollType,
        renderer::{RenderAdapter, RenderDevice},
        settings::WgpuSettings,
    },
};
use bevy_peelnet::{Gravity, PeelnetModel, PeelnetPlugin};
use support::{cards, headless::Headless};

const SIZE: UVec2 = UVec2::new(128, 96);

fn crossing(plugin: impl Into<PeelnetPlugin>, settings: WgpuSettings) -> Headless {
    Headless::with_settings(SIZE, Msaa::Off, plugin, &cards::crossing(), settings)
}

/// The picture stays as it is without learned transparency, and one message says all of this.
fn assert_refused(mut headless: Headless, frames: u32, gravity: Gravity, says: &[&str]) {
    let bevys = headless.picture();
    let mut headless = headless.learned();
    headless.run(frames);
    assert!(headless.picture() == bevys);
    headless.assert_said(gravity, says);
}

#[test]
fn networks_of_another_version_or_recipe() {
    let of_version = ["peelnet-export 7", "export the network again"];
    for (name, version, says) in [
        ("medium", 7, &of_version[..]),
        ("thesis", 1, &["\"thesis\""]),
    ] {
        let shipped = peelnet_shipped_networks::find(name).expect("ships");
        let version = format!("\"format_version\": {version}");
        let json = shipped.json.replace("\"format_version\": 1", &version);
        let model = PeelnetModel::new(shipped.wgsl, &json);
        let headless = crossing(model, WgpuSettings::default());
        assert_refused(headless, 0, Gravity::Error, says);
    }
}

#[test]
fn a_device_of_low_limits() {
    let mut headless = usual();
    headless.run(1);
    let render = headless.app.sub_app(RenderApp).world();
    // All else as the adapter has it.
    let usual = render.resource::<RenderAdapter>().limits();
    let (mut bytes, mut targets, mut textures) = (usual.clone(), usual.clone(), usual);
    bytes.max_color_attachment_bytes_per_sample = 16;
    targets.max_color_attachments = 2;
    textures.max_sampled_textures_per_shader_stage = 8;
    for (limits, gravity, says) in [
        (bytes, Gravity::Error, "30 bytes a sample"),
        (targets, Gravity::Error, "6 targets"),
        (textures, Gravity::Warning, "textures, the device allows 8"),
    ] {
        let settings = WgpuSettings {
            constrained_limits: Some(limits),
            ..default()
        };
        let headless = crossing(PeelnetPlugin::default(), settings);
        assert_refused(headless, 0, gravity, &[says]);
    }
}

fn usual() -> Headless {
    crossing(PeelnetPlugin::default(), WgpuSettings::default())
}

#[test]
fn a_camera_with_both_techniques() {
    let mut headless = usual();
    let bevys = OrderIndependentTransparencySettings::default();
    headless.camera().insert(bevys);
    let says = ["OrderIndependentTransparencySettings"];
    assert_refused(headless, 0, Gravity::Error, &says);
}

#[test]
fn a_scene_without_transparent_surfaces() {
    // Only the opaque card.
    let scene = cards::many(0);
    let headless = Headless::new(SIZE, Msaa::Off, PeelnetPlugin::default(), &scene);
    assert_refused(headless, 70, Gravity::Info, &["no transparent surface"]);
}

#[test]
fn a_lost_device_is_replaced_where_the_application_asks_for_it() {
    let mut headless = usual().learned();
    // With lights assigned on the GPU, Bevy itself unwraps a buffer of the lost device and panics.
    headless.run(1);
    let world = headless.app.world_mut();
    world.resource_mut::<GlobalClusterSettings>().gpu_clustering = None;
    let before = headless.picture();
    // The last read-back ends, for the same reason.
    headless.run(2);
    let recover = RenderErrorHandler(|_, _, _| RenderErrorPolicy::Recover(default()));
    headless.app.insert_resource(recover);
    let render = headless.app.sub_app(RenderApp).world();
    let device = render.resource::<RenderDevice>();
    device.wgpu_device().destroy();
    // The poll reports the loss. Bevy panics if it uses the device before it knows.
    device
        .poll(PollType::wait_indefinitely())
        .expect("reports the loss");
    let after = headless.picture();
    assert!(before == after);
    headless.assert_said(Gravity::Info, &["replaced the graphics device"]);
}

#[test]
fn folders_of_networks() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/");
    for recipe in "small medium large anchored-small anchored-medium nmt".split(' ') {
        let model = PeelnetModel::load(format!("{folder}{recipe}")).expect("loads");
        assert_eq!(model.recipe(), recipe);
    }
    let error = PeelnetModel::load("no/such/folder").expect_err("is refused");
    assert!(error.to_string().contains("model.wgsl"), "{error}");
}
