//! Cards of glass in a browser's canvas, and how far they are from their exact image: `web/index.html` shows them, `web/page.test.mjs` tests them.

#![cfg(target_arch = "wasm32")]
#![allow(missing_docs, reason = "not a library")]

#[path = "../examples/support/cards.rs"]
#[allow(dead_code, reason = "the page takes a part")]
mod cards;
#[path = "../examples/support/exact.rs"]
#[allow(dead_code, reason = "the page takes a part")]
mod exact;

use bevy::{
    camera::Hdr,
    core_pipeline::tonemapping::{DebandDither, Tonemapping},
    log::{Level, LogPlugin},
    prelude::*,
    window::WindowResolution,
    winit::{UpdateMode, WinitSettings},
};
use bevy_peelnet::{LearnedTransparency, PeelnetModel, PeelnetPlugin};
use std::time::Duration;
use wasm_bindgen::prelude::wasm_bindgen;

const SIZE: UVec2 = UVec2::new(256, 192);
const CARDS: usize = 40;
/// From one frame to the next.
const FRAME: Duration = Duration::from_millis(500);

/// Draws into the page's canvas from now on, with one of the shipped networks, or sorted by Bevy where it has no name.
#[wasm_bindgen]
pub fn start(network: &str, samples: u32) {
    let model = match network {
        "small" => PeelnetModel::small(),
        "large" => PeelnetModel::large(),
        "one" => PeelnetModel::one(),
        _ => PeelnetModel::medium(),
    };
    let window = Window {
        canvas: Some("canvas".into()),
        // A pixel of the picture is one of the canvas, whatever the screen has.
        resolution: WindowResolution::new(SIZE.x, SIZE.y).with_scale_factor_override(1.0),
        ..default()
    };
    let window = WindowPlugin {
        primary_window: Some(window),
        ..default()
    };
    let log = LogPlugin {
        level: Level::WARN,
        filter: String::new(),
        ..default()
    };
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins.set(window).set(log),
        PeelnetPlugin::from(model),
    ))
    // Nothing moves. A browser without a screen asks for frames faster than a software rasteriser draws them, and would queue them.
    .insert_resource(WinitSettings {
        focused_mode: UpdateMode::reactive(FRAME),
        unfocused_mode: UpdateMode::reactive(FRAME),
    })
    .insert_resource(ClearColor(cards::BACKGROUND.into()));
    let camera = (
        Camera3d::default(),
        Hdr,
        Tonemapping::None,
        DebandDither::Disabled,
        Msaa::from_samples(samples),
        Transform::from_translation(cards::EYE).looking_at(Vec3::ZERO, Vec3::Y),
    );
    let mut camera = app.world_mut().spawn(camera);
    if !network.is_empty() {
        camera.insert(LearnedTransparency::default());
    }
    cards::spawn(&mut app, &cards::many(CARDS));
    app.run();
}

/// The root of the mean square error of a picture of four bytes a pixel, of 255, where no edge passes a sample.
#[wasm_bindgen]
pub fn rmse(picture: &[u8], samples: u32) -> f64 {
    let exact = exact::picture(&cards::many(CARDS), SIZE, samples);
    exact::errors_of(&exact, picture).rmse
}
