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

/// An application with a scene and learned transparency.
fn learned(scene: &[Card], msaa: Msaa, model: PeelnetModel) -> Headless {
    let mut headless = Headless::new(SIZE, msaa, model.into());
    cards::spawn(&mut headless.app, scene);
    headless.camera().insert(LearnedTransparency::default());
    headless
}

fn sorted(scene: &[Card], msaa: Msaa) -> Vec<u8> {
    let mut headless = Headless::new(SIZE, msaa, PeelnetPlugin::default());
    cards::spawn(&mut headless.app, scene);
    headless.picture()
}

fn errors_of(scene: &[Card], samples: u32, picture: &[u8]) -> Errors {
    let errors = exact::picture(scene, SIZE, samples).errors_of(picture);
    // The rest is edges.
    assert!(errors.judged > 0.85, "{errors:?}");
    errors
}

#[test]
fn two_cards_are_the_closed_form() {
    let scene = cards::two();
    let picture = learned(&scene, Msaa::Off, PeelnetModel::medium()).picture();
    let errors = errors_of(&scene, 1, &picture);
    assert!(errors.max <= ROUNDED, "{errors:?}");
    // Red over green over the background, in the middle.
    let middle = 4 * (SIZE.x * SIZE.y / 2 + SIZE.x / 2) as usize;
    let expected = [0.5 + 0.25 * 0.25, 0.25 + 0.25 * 0.5, 0.25 * 0.75];
    for (byte, linear) in picture[middle..].iter().zip(expected) {
        let expected = 255.0 * exact::encoded(linear);
        assert!(
            (f64::from(*byte) - expected).abs() <= ROUNDED,
            "{byte}, not {expected}"
        );
    }
}

#[test]
fn cards_that_cut_each_other_are_exact_and_not_with_bevys_sorting() {
    let scene = cards::crossing();
    let picture = learned(&scene, Msaa::Off, PeelnetModel::medium()).picture();
    let errors = errors_of(&scene, 1, &picture);
    assert!(errors.max <= ROUNDED, "{errors:?}");
    // The scene would prove nothing if sorting got it right.
    let errors = errors_of(&scene, 1, &sorted(&scene, Msaa::Off));
    assert!(errors.max > 20.0, "{errors:?}");
}

#[test]
fn many_layers_err_far_less_than_bevys_sorting() {
    let scene = cards::many(40);
    let bevys = errors_of(&scene, 1, &sorted(&scene, Msaa::Off));
    for (model, share) in [
        (PeelnetModel::small(), 0.2),
        (PeelnetModel::medium(), 0.1),
        (PeelnetModel::large(), 0.1),
    ] {
        let recipe = model.recipe().to_owned();
        let errors = errors_of(&scene, 1, &learned(&scene, Msaa::Off, model).picture());
        println!("{recipe}: {errors:?}; sorted: {bevys:?}");
        assert!(
            errors.rmse < share * bevys.rmse,
            "{recipe}: {errors:?}, {bevys:?}"
        );
    }
}

#[test]
fn samples_are_composited_one_by_one() {
    let scene = cards::many(40);
    let picture = learned(&scene, Msaa::Sample4, PeelnetModel::medium()).picture();
    let errors = errors_of(&scene, 4, &picture);
    let bevys = errors_of(&scene, 4, &sorted(&scene, Msaa::Sample4));
    println!("{errors:?}; sorted: {bevys:?}");
    assert!(errors.rmse < 0.1 * bevys.rmse, "{errors:?}, {bevys:?}");
    // Pixels that are partly covered are part of it: a scene of edges.
    let picture = learned(&cards::crossing(), Msaa::Sample4, PeelnetModel::medium()).picture();
    let errors = errors_of(&cards::crossing(), 4, &picture);
    assert!(errors.max <= 1.5 * ROUNDED, "{errors:?}");
}

#[test]
fn a_depth_prepass_changes_nothing() {
    let scene = cards::many(20);
    let mut headless = learned(&scene, Msaa::Off, PeelnetModel::medium());
    let without = headless.picture();
    headless.camera().insert(DepthPrepass);
    let with = headless.picture();
    assert!(without == with);
}

#[test]
fn an_orthographic_camera_has_its_own_scale() {
    // Cards that face the camera, in another order than they are spawned in. Seen without perspective, every pixel of the middle is
    // composited alike.
    let facing = |z: f32, [red, green, blue, alpha]: [f32; 4]| Card {
        transform: Transform::from_xyz(0.0, 0.0, z).with_scale(Vec3::splat(9.0)),
        color: LinearRgba::new(red, green, blue, alpha),
    };
    // Two stand behind the camera's position and are seen, because the near plane is there, too.
    let scene = [
        facing(8.5, [1.0, 0.0, 0.0, 0.5]),
        facing(-3.0, [0.0, 1.0, 0.0, 0.5]),
        facing(7.0, [0.0, 0.0, 1.0, 0.5]),
    ];
    let mut headless = learned(&scene, Msaa::Off, PeelnetModel::medium());
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
    let picture = headless.picture();
    let expected = [0.5 + 0.125 * 0.25, 0.125 + 0.125 * 0.5, 0.25 + 0.125 * 0.75];
    for (byte, linear) in picture.iter().zip(expected) {
        let expected = 255.0 * exact::encoded(linear);
        assert!(
            (f64::from(*byte) - expected).abs() <= ROUNDED,
            "{byte}, not {expected}"
        );
    }
}

#[test]
fn a_camera_without_hdr_has_the_same_colours() {
    let scene = cards::crossing();
    let mut headless = learned(&scene, Msaa::Off, PeelnetModel::medium());
    headless.camera().remove::<Hdr>();
    let errors = errors_of(&scene, 1, &headless.picture());
    assert!(errors.max <= ROUNDED, "{errors:?}");
}

#[test]
fn a_viewport_shows_the_scene_in_its_part_of_the_image() {
    let scene = cards::crossing();
    let mut headless = learned(&scene, Msaa::Off, PeelnetModel::medium());
    let whole = headless.picture();
    let (corner, size) = (UVec2::new(48, 64), SIZE / 2);
    headless
        .app
        .world_mut()
        .get_mut::<Camera>(headless.camera)
        .expect("is a camera")
        .viewport = Some(Viewport {
        physical_position: corner,
        physical_size: size,
        ..default()
    });
    let picture = headless.picture();
    assert!(picture != whole);
    let rows = corner.y..corner.y + size.y;
    let part: Vec<u8> = rows
        .flat_map(|y| {
            let at = 4 * (y * SIZE.x + corner.x) as usize;
            picture[at..at + 4 * size.x as usize].to_vec()
        })
        .collect();
    let errors = exact::picture(&scene, size, 1).errors_of(&part);
    assert!(errors.max <= ROUNDED, "{errors:?}");
}

#[test]
fn the_range_of_depths_can_be_set_and_is_tight_by_itself() {
    let scene = cards::many(40);
    let mut headless = learned(&scene, Msaa::Off, PeelnetModel::medium());
    let boxes = errors_of(&scene, 1, &headless.picture());
    let fixed = |near, far| LearnedTransparency {
        depth_range: DepthRange::Fixed { near, far },
    };
    // Wide enough for all, and far too wide.
    headless.camera().insert(fixed(0.1, 1000.0));
    let wide = errors_of(&scene, 1, &headless.picture());
    println!("boxes: {boxes:?}; 0.1 .. 1000: {wide:?}");
    assert!(boxes.rmse < wide.rmse, "{boxes:?}, {wide:?}");
}

#[test]
fn techniques_can_be_switched_while_running() {
    let mut scene = cards::crossing();
    // Of cards at one distance Bevy may draw either first.
    scene[0].transform.translation.z = 0.1;
    let mut headless = Headless::new(SIZE, Msaa::Off, PeelnetPlugin::default());
    cards::spawn(&mut headless.app, &scene);
    let first = headless.picture();
    headless.camera().insert(LearnedTransparency::default());
    let second = headless.picture();
    headless.camera().remove::<LearnedTransparency>();
    headless
        .camera()
        .insert(OrderIndependentTransparencySettings::default());
    let third = headless.picture();
    headless
        .camera()
        .remove::<OrderIndependentTransparencySettings>();
    let fourth = headless.picture();
    assert!(first == fourth);
    assert!(errors_of(&scene, 1, &second).max <= ROUNDED);
    // Bevy keeps opacities in 8 bits.
    assert!(errors_of(&scene, 1, &third).max <= 3.0 * ROUNDED);
}

#[test]
fn cards_come_and_go() {
    let scene = cards::two();
    let mut headless = Headless::new(SIZE, Msaa::Off, PeelnetPlugin::default());
    let entities = cards::spawn(&mut headless.app, &scene);
    headless.camera().insert(LearnedTransparency::default());
    assert!(errors_of(&scene, 1, &headless.picture()).max <= ROUNDED);
    headless.app.world_mut().despawn(entities[0]);
    assert!(errors_of(&scene[1..], 1, &headless.picture()).max <= ROUNDED);
    headless
        .app
        .world_mut()
        .entity_mut(entities[1])
        .insert(Visibility::Hidden);
    assert!(errors_of(&[], 1, &headless.picture()).max <= ROUNDED);
    headless
        .app
        .world_mut()
        .entity_mut(entities[1])
        .insert((Visibility::Visible, Transform::from_xyz(0.0, 0.5, 0.0)));
    let moved = Card {
        transform: Transform::from_xyz(0.0, 0.5, 0.0),
        ..scene[1]
    };
    assert!(errors_of(&[moved], 1, &headless.picture()).max <= ROUNDED);
}
