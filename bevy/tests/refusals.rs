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
        settings::{WgpuLimits, WgpuSettings},
    },
};
use bevy_peelnet::{Gravity, LearnedTransparency, PeelnetMessages, PeelnetModel, PeelnetPlugin};
use support::{cards, headless::Headless};

const SIZE: UVec2 = UVec2::new(128, 96);

fn messages(headless: &Headless) -> Vec<(Gravity, String)> {
    headless.app.world().resource::<PeelnetMessages>().all()
}

/// The picture without learned transparency, and with it, of one application; and what was said.
fn pictures(
    plugin: PeelnetPlugin,
    settings: WgpuSettings,
) -> (Vec<u8>, Vec<u8>, Vec<(Gravity, String)>) {
    let mut headless = Headless::with_settings(SIZE, Msaa::Off, plugin, settings);
    cards::spawn(&mut headless.app, &cards::crossing());
    let bevys = headless.picture();
    headless.camera().insert(LearnedTransparency::default());
    let with = headless.picture();
    (bevys, with, messages(&headless))
}

#[test]
fn a_network_of_another_version() {
    let shipped = peelnet_models::find("medium").expect("ships");
    let json = shipped
        .json
        .replace("\"format_version\": 1", "\"format_version\": 7");
    let model = PeelnetModel::new(shipped.wgsl, &json);
    let (bevys, with, said) = pictures(model.into(), WgpuSettings::default());
    assert!(bevys == with);
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(
        said[0].1.contains("peelnet-export 7") && said[0].1.contains("export the network again"),
        "{said:?}"
    );
}

#[test]
fn a_network_of_another_recipe() {
    let shipped = peelnet_models::find("thesis").expect("ships");
    let model = PeelnetModel::new(shipped.wgsl, shipped.json);
    let (bevys, with, said) = pictures(model.into(), WgpuSettings::default());
    assert!(bevys == with);
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].1.contains("\"thesis\""), "{said:?}");
}

#[test]
fn a_device_with_few_bind_groups() {
    let settings = WgpuSettings {
        constrained_limits: Some(WgpuLimits {
            max_bind_groups: 4,
            // All else as the adapter has it.
            ..unlimited()
        }),
        ..default()
    };
    let (bevys, with, said) = pictures(PeelnetPlugin::default(), settings);
    assert!(bevys == with);
    assert_eq!(said.len(), 1, "{said:?}");
    assert_eq!(said[0].0, Gravity::Error);
    assert!(said[0].1.contains("5 bind groups"), "{said:?}");
}

/// Bounds that no adapter reaches.
fn unlimited() -> WgpuLimits {
    let mut headless = Headless::new(SIZE, Msaa::Off, PeelnetPlugin::default());
    headless.run(1);
    let render = headless.app.sub_app(RenderApp).world();
    render.resource::<RenderAdapter>().limits()
}

#[test]
fn a_camera_with_both_techniques() {
    let mut headless = Headless::new(SIZE, Msaa::Off, PeelnetPlugin::default());
    cards::spawn(&mut headless.app, &cards::crossing());
    headless
        .camera()
        .insert(OrderIndependentTransparencySettings::default());
    let bevys = headless.picture();
    headless.camera().insert(LearnedTransparency::default());
    let with = headless.picture();
    assert!(bevys == with);
    let said = messages(&headless);
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(
        said[0].1.contains("OrderIndependentTransparencySettings"),
        "{said:?}"
    );
}

#[test]
fn a_scene_without_transparent_surfaces() {
    let mut headless = Headless::new(SIZE, Msaa::Off, PeelnetPlugin::default());
    // Only the opaque card.
    cards::spawn(&mut headless.app, &cards::many(0));
    let bevys = headless.picture();
    headless.camera().insert(LearnedTransparency::default());
    headless.run(70);
    let with = headless.picture();
    assert!(bevys == with);
    let said = messages(&headless);
    assert_eq!(said.len(), 1, "{said:?}");
    assert_eq!(said[0].0, Gravity::Info);
    assert!(said[0].1.contains("no transparent surface"), "{said:?}");
}

#[test]
fn a_lost_device_is_replaced_where_the_application_asks_for_it() {
    let mut headless = Headless::new(SIZE, Msaa::Off, PeelnetPlugin::default());
    cards::spawn(&mut headless.app, &cards::crossing());
    headless.camera().insert(LearnedTransparency::default());
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
    let said = messages(&headless);
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(
        said[0].1.contains("replaced the graphics device"),
        "{said:?}"
    );
}

#[test]
fn files_that_are_not_there_are_named() {
    let error = PeelnetModel::load("no/such/folder").expect_err("is refused");
    assert!(error.to_string().contains("model.wgsl"), "{error}");
}

#[test]
fn the_shipped_folders_can_be_loaded() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/");
    for recipe in [
        "small",
        "medium",
        "large",
        "anchored-small",
        "anchored-medium",
        "nmt",
    ] {
        let model = PeelnetModel::load(format!("{folder}{recipe}")).expect("loads");
        assert_eq!(model.recipe(), recipe);
    }
}
