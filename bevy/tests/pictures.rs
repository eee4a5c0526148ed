//! Pictures of cards against their exact image, drawn without a window.

#[path = "../examples/support/mod.rs"]
mod support;

use bevy::{
    camera::{Hdr, ScalingMode, Viewport},
    core_pipeline::{oit::OrderIndependentTransparencySettings, prepass::DepthPrepass},
    prelude::*,
};
use bevy_peelnet::{DepthRange, LearnedTransparency, PeelnetModel, PeelnetPlugin};
use support::{
    cards::{self, Card},
    exact::{self, Errors},
    headless::Headless,
};

const SIZE: UVec2 = UVec2::new(256, 192);
/// What 8 bits, and the 16 bits of Bevy's texture before them, may round.
const ROUNDED: f64 = 1.0;

fn learned(scene: &[Card], msaa: Msaa, model: PeelnetModel) -> Headless {
    Headless::new(SIZE, msaa, model, scene).learned()
}

fn medium(scene: &[Card]) -> Headless {
    learned(scene, Msaa::Off, PeelnetModel::medium())
}

/// Of Bevy's sorting.
fn sorted(scene: &[Card], msaa: Msaa) -> Errors {
    Headless::new(SIZE, msaa, PeelnetPlugin::default(), scene).errors(scene)
}

/// A pixel has a linear colour, encoded and rounded.
fn assert_pixel(pixel: &[u8], linear: [f64; 3]) {
    for (byte, linear) in pixel.iter().zip(linear) {
        let expected = 255.0 * exact::encoded(linear);
        let error = (f64::from(*byte) - expected).abs();
        assert!(error <= ROUNDED, "{byte}, not {expected}");
    }
}

#[test]
fn two_cards_are_the_closed_form() {
    let scene = cards::two();
    let mut headless = medium(&scene);
    headless.assert_exact(&scene, ROUNDED);
    // Red over green over the background, in the middle.
    let middle = 4 * (SIZE.x * SIZE.y / 2 + SIZE.x / 2) as usize;
    let expected = [0.5 + 0.25 * 0.25, 0.25 + 0.25 * 0.5, 0.25 * 0.75];
    assert_pixel(&headless.picture()[middle..], expected);
}

#[test]
fn cards_that_cut_each_other_are_exact_and_not_with_bevys_sorting() {
    let scene = cards::crossing();
    let mut headless = medium(&scene);
    headless.assert_exact(&scene, ROUNDED);
    // A camera without HDR has the same colours.
    headless.camera().remove::<Hdr>();
    headless.assert_exact(&scene, ROUNDED);
    // The scene would prove nothing if sorting got it right.
    let errors = sorted(&scene, Msaa::Off);
    assert!(errors.max > 20.0, "{errors:?}");
}

#[test]
fn many_layers_err_far_less_than_bevys_sorting() {
    let scene = cards::many(40);
    let bevys = sorted(&scene, Msaa::Off);
    // With four samples, each is composited by itself.
    let bevys_of_four = sorted(&scene, Msaa::Sample4);
    for (model, msaa, share, bevys) in [
        (PeelnetModel::small(), Msaa::Off, 0.1, bevys),
        (PeelnetModel::medium(), Msaa::Off, 0.1, bevys),
        (PeelnetModel::large(), Msaa::Off, 0.1, bevys),
        (PeelnetModel::one(), Msaa::Off, 0.3, bevys),
        (PeelnetModel::one(), Msaa::Sample4, 0.3, bevys_of_four),
        (PeelnetModel::medium(), Msaa::Sample4, 0.1, bevys_of_four),
    ] {
        let recipe = model.recipe().to_owned();
        let errors = learned(&scene, msaa, model).errors(&scene);
        println!("{recipe}: {errors:?}; sorted: {bevys:?}");
        let limit = share * bevys.rmse;
        assert!(errors.rmse < limit, "{recipe}: {errors:?}, {bevys:?}");
    }
    // Pixels that are partly covered are part of it: a scene of edges.
    let edges = cards::crossing();
    let mut headless = learned(&edges, Msaa::Sample4, PeelnetModel::medium());
    headless.assert_exact(&edges, 1.5 * ROUNDED);
}

#[test]
fn a_depth_prepass_changes_nothing() {
    let mut headless = medium(&cards::many(20));
    let without = headless.picture();
    headless.camera().insert(DepthPrepass);
    assert!(headless.picture() == without);
}

/// One pixel in 64 looks for surfaces around it, and only for what is seen of them.
#[test]
fn surfaces_behind_an_opaque_wall_change_nothing() {
    let wall = cards::card([0.0; 3], [20.0, 20.0], [0.2, 0.3, 0.4, 1.0]);
    let seen: Vec<Card> = cards::many(20).into_iter().chain([wall]).collect();
    let behind = (0..6).map(|k| {
        let z = -1.0 - k as f32;
        cards::card([0.0, 0.0, z], [20.0, 20.0], [1.0, 0.5, 0.2, 0.8])
    });
    let all: Vec<Card> = seen.iter().copied().chain(behind).collect();
    for msaa in [Msaa::Off, Msaa::Sample4] {
        let [without, with] = [&seen, &all].map(|scene| {
            let mut headless = learned(scene, msaa, PeelnetModel::one());
            let (near, far) = (1.0, 20.0);
            headless.camera().insert(LearnedTransparency {
                depth_range: DepthRange::Fixed { near, far },
                ..default()
            });
            headless.picture()
        });
        assert!(with == without, "{msaa:?}");
    }
}

#[test]
fn an_orthographic_camera_has_its_own_scale() {
    // Cards that face the camera, in another order than they are spawned in. Seen without perspective, every pixel of the middle is
    // composited alike.
    let facing = |z, color| cards::card([0.0, 0.0, z], [9.0, 9.0], color);
    // Two stand behind the camera's position and are seen, because the near plane is there, too.
    let scene = [
        facing(8.5, [1.0, 0.0, 0.0, 0.5]),
        facing(-3.0, [0.0, 1.0, 0.0, 0.5]),
        facing(7.0, [0.0, 0.0, 1.0, 0.5]),
    ];
    let mut headless = medium(&scene);
    headless
        .camera()
        .insert(Projection::Orthographic(OrthographicProjection {
            near: -10.0,
            far: 100.0,
            scaling_mode: ScalingMode::FixedVertical {
                viewport_height: 4.0,
            },
            ..OrthographicProjection::default_3d()
        }));
    let expected = [0.5 + 0.125 * 0.25, 0.125 + 0.125 * 0.5, 0.25 + 0.125 * 0.75];
    assert_pixel(&headless.picture(), expected);
}

#[test]
fn a_viewport_shows_the_scene_in_its_part_of_the_image() {
    let scene = cards::crossing();
    let mut headless = medium(&scene);
    let whole = headless.picture();
    let (corner, size) = (UVec2::new(48, 64), SIZE / 2);
    let mut camera = headless.camera();
    let mut camera = camera.get_mut::<Camera>().expect("is a camera");
    camera.viewport = Some(Viewport {
        physical_position: corner,
        physical_size: size,
        ..default()
    });
    let picture = headless.picture();
    assert!(picture != whole);
    let part = (corner.y..corner.y + size.y).flat_map(|y| {
        let at = 4 * (y * SIZE.x + corner.x) as usize;
        &picture[at..at + 4 * size.x as usize]
    });
    let part: Vec<u8> = part.copied().collect();
    let errors = exact::errors_of(&exact::picture(&scene, size, 1), &part);
    assert!(errors.max <= ROUNDED, "{errors:?}");
}

#[test]
fn the_range_of_depths_can_be_set_and_is_tight_by_itself() {
    let scene = cards::many(40);
    let mut headless = medium(&scene);
    let boxes = headless.errors(&scene);
    // Wide enough for all, and far too wide.
    let (near, far) = (0.1, 1000.0);
    headless.camera().insert(LearnedTransparency {
        depth_range: DepthRange::Fixed { near, far },
        ..default()
    });
    let wide = headless.errors(&scene);
    println!("boxes: {boxes:?}; 0.1 .. 1000: {wide:?}");
    assert!(boxes.rmse < wide.rmse, "{boxes:?}, {wide:?}");
}

#[test]
fn techniques_can_be_switched_while_running() {
    let mut scene = cards::crossing();
    // Of cards at one distance Bevy may draw either first.
    scene[0].transform.translation.z = 0.1;
    let mut headless = Headless::new(SIZE, Msaa::Off, PeelnetPlugin::default(), &scene);
    let first = headless.picture();
    let mut headless = headless.learned();
    headless.assert_exact(&scene, ROUNDED);
    headless.sort();
    let bevys = OrderIndependentTransparencySettings::default();
    headless.camera().insert(bevys);
    // Bevy keeps opacities in 8 bits.
    headless.assert_exact(&scene, 3.0 * ROUNDED);
    let mut camera = headless.camera();
    camera.remove::<OrderIndependentTransparencySettings>();
    assert!(headless.picture() == first);
}

#[test]
fn cards_come_and_go() {
    let scene = cards::two();
    let mut headless = medium(&[]);
    let entities = cards::spawn(&mut headless.app, &scene);
    headless.assert_exact(&scene, ROUNDED);
    headless.app.world_mut().despawn(entities[0]);
    headless.assert_exact(&scene[1..], ROUNDED);
    let second = |headless: &mut Headless, visibility, transform| {
        let mut second = headless.app.world_mut().entity_mut(entities[1]);
        second.insert((visibility, transform));
    };
    let transform = Transform::from_xyz(0.0, 0.5, 0.0);
    second(&mut headless, Visibility::Hidden, transform);
    headless.assert_exact(&[], ROUNDED);
    second(&mut headless, Visibility::Visible, transform);
    let moved = Card {
        transform,
        ..scene[1]
    };
    headless.assert_exact(&[moved], ROUNDED);
}
