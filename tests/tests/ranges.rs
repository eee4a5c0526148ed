//! Slabs over the range that boxes around transparent parts give a pixel.

use glam::{Mat4, Quat, Vec3};
use peelnet_core::{fragment::Fragment, methods::over};
use peelnet_render::Renderer;
use peelnet_scene::{Material, Object};
use peelnet_tests::{draw, gpu, object, prepare, rectangle, scene};

/// Where the layers of the middle pixel lie in its range of depth on a logarithmic scale. The slabs of `slabs` end at 0.3, 0.6 and 0.82: each
/// has two layers, which are its nearest and its farthest, so that all are known. The range is found to one of 42 levels.
const PLACES: [f32; 8] = [0.0, 0.25, 0.35, 0.55, 0.65, 0.77, 0.87, 1.0];

/// Nearest depth of the middle pixel; the farthest is twice as far.
const NEAREST: f32 = 4.0;

const SIZE: [u32; 2] = [9, 9];
const MIDDLE: usize = 40;

/// Every sum of eight layers is rounded to a half nine times, absorbances of 0.36 add up to 2.9, and colours are at most 1.
const KNOWN: f32 = 9.0 * 2.9 / 2048.0;

/// A square of side 1 around the origin in the plane of x and y, or one whose x runs the other way.
fn square(world_from_object: Mat4, material: Material) -> Object {
    let side = [-0.5, 0.5];
    Object {
        world_from_object,
        ..object(&rectangle(side, side, 0.0), material)
    }
}

/// A square across the view axis, turned by 60 degrees: a box along the world's axes would be 3.5 deep.
fn placed(number: usize) -> Mat4 {
    let z = NEAREST * 2.0f32.powf(PLACES[number]);
    let mirror = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
    Mat4::from_scale_rotation_translation(
        Vec3::new(4.0 * mirror, 4.0, 1.0),
        Quat::from_rotation_y(60f32.to_radians()),
        Vec3::new(0.0, 0.0, -z),
    )
}

fn fragments() -> Vec<Fragment> {
    let of = |(number, place): (usize, &f32)| {
        let mut color = [0.1; 3];
        color[number % 3] = 1.0;
        Fragment::new(NEAREST * 2.0f32.powf(*place), 0.3, color)
    };
    PLACES.iter().enumerate().map(of).collect()
}

fn error(found: [f32; 4]) -> f32 {
    let exact = over::composite_f64(&fragments(), [0.0; 3]);
    let differences = exact.iter().zip(found);
    differences.fold(0.0, |worst, (e, f)| worst.max((*e as f32 - f).abs()))
}

/// Where boxes are as tight as surfaces, all layers are known, and with the frame's range they are not. Boxes follow objects that move.
#[test]
fn boxes_of_flat_objects_are_as_good_as_their_surfaces() {
    let gpu = gpu();
    let squares = (0..).zip(fragments());
    let squares = squares.map(|(i, f)| square(placed(i), Material::unlit(f.color, f.alpha)));
    // Beside them, from the nearest of them to far behind, which makes the frame's range six times as long and leaves it no gap.
    let aside = Mat4::from_scale_rotation_translation(
        Vec3::new(246.0, 1.0, 1.0),
        Quat::from_rotation_y(90f32.to_radians()),
        Vec3::new(200.0, 0.0, -127.0),
    );
    let far = square(aside, Material::unlit([1.0; 3], 0.5));
    let all = scene("squares", [0.0; 3], squares.chain([far]).collect());
    let of = |method: &str| error(draw(&gpu, &all, method, SIZE).pixels[MIDDLE]);
    let [boxes, frame] = ["slabs:range=boxes", "slabs:range=frame"].map(of);
    assert!(boxes < KNOWN, "{boxes}");
    assert!(frame > 2.0 * KNOWN, "{frame}");

    let mut scattered = all.clone();
    for object in &mut scattered.objects[..4] {
        object.world_from_object = Mat4::from_translation(Vec3::new(0.0, 0.0, -100.0));
    }
    let mut renderer = Renderer::new(&gpu, &scattered).unwrap();
    let mut prepared = prepare(&renderer, "slabs:range=boxes", SIZE);
    let drawn = |renderer: &Renderer, prepared: &mut _| {
        let image = renderer.image(prepared, &all.views[0]).unwrap().image;
        error(image.pixels[MIDDLE])
    };
    assert!(drawn(&renderer, &mut prepared) > 2.0 * KNOWN);
    for number in 0..4 {
        renderer.set_transform(number, placed(number)).unwrap();
    }
    let moved = drawn(&renderer, &mut prepared);
    assert!(moved < KNOWN, "{moved}");
}
