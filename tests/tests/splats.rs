//! Gaussian splats against closed forms: what they cover, where in depth they lie, which colour they have, and in which space they blend.

use glam::{DMat3, DVec3, Mat4, Quat, Vec3};
use peelnet_core::srgb;
use peelnet_render::{PixelFragment, Renderer};
use peelnet_scene::{
    Blending, CONSTANT_HARMONIC, FAINTEST, Material, Mesh, Object, Part, Scene, Splats,
};
use peelnet_tests::{assert_alike, assert_near, draw, gpu, object, prepare, rectangle, scene};
use std::sync::Arc;

const SIZE: [u32; 2] = [48, 48];

/// Colours pass half floats, and the transfer function is at most 2.4 times as steep as its ends' line.
const COLOR: f32 = 2.4 * 1.8 * CONSTANT_HARMONIC / 2048.0;

/// Of an opacity: positions on the screen are rounded to about 1e-4 pixels, and a Gaussian of a pixel's width falls by at most 0.6 a pixel.
const OPACITY: f32 = 2e-4;

/// What a splat is made of; its colour is what a display shows.
#[derive(Clone, Copy)]
pub(crate) struct One {
    pub center: Vec3,
    pub scale: Vec3,
    pub turn: Quat,
    pub opacity: f32,
    pub color: [f32; 3],
}

pub(crate) const ONE: One = One {
    center: Vec3::new(0.0, 0.0, -3.0),
    scale: Vec3::splat(0.3),
    turn: Quat::IDENTITY,
    opacity: 0.8,
    color: [1.0; 3],
};

pub(crate) fn cloud(all: &[One]) -> Object {
    let splats = Splats {
        scales: all.iter().map(|s| s.scale).collect(),
        rotations: all.iter().map(|s| s.turn).collect(),
        opacities: all.iter().map(|s| s.opacity).collect(),
        harmonics: (all.iter())
            .map(|s| s.color.map(|c| (c - 0.5) / CONSTANT_HARMONIC))
            .collect(),
        ..Splats::default()
    };
    let material = Material::unlit([1.0; 3], 1.0);
    let mesh = Mesh {
        positions: all.iter().map(|s| s.center).collect(),
        normals: vec![Vec3::Z; all.len()],
        triangles: (0..all.len() as u32).map(|i| [i; 3]).collect(),
        parts: vec![Part {
            name: "splats".into(),
            triangles: 0..all.len(),
            material: material.clone(),
        }],
        splats: Some(splats),
        ..Mesh::default()
    };
    Object {
        name: "splats".into(),
        mesh: Arc::new(mesh),
        world_from_object: Mat4::IDENTITY,
        layer: None,
        materials: vec![material],
    }
}

fn splats(all: &[One]) -> Scene {
    scene("splats", [0.0; 3], vec![cloud(all)])
}

/// The fragments of a pixel.
fn fragments(scene: &Scene, pixel: [u32; 2]) -> Vec<PixelFragment> {
    let gpu = gpu();
    let renderer = Renderer::new(&gpu, scene).unwrap();
    let found = renderer.pixel_async(&scene.views[0], SIZE, pixel);
    gpu.block_on(found).unwrap()
}

/// A splat's covariance in the space of the camera, whose view axis is −z, and its centre there.
fn in_view(one: &One) -> (DMat3, DVec3) {
    let turn = DMat3::from_quat(one.turn.as_dquat());
    let axes = turn * DMat3::from_diagonal(one.scale.as_dvec3());
    (axes * axes.transpose(), one.center.as_dvec3())
}

/// The opacity of a splat in the middle of a pixel by the textbook: the Jacobian of the projection at the centre (Zwicker et al. 2001), and
/// 0.3 square pixels more.
fn opacity(one: &One, pixel: [u32; 2], antialiased: bool) -> f64 {
    let (covariance, center) = in_view(one);
    // 90 degrees across the frame.
    let focal = f64::from(SIZE[0]) / 2.0;
    let (x, y, z) = (center.x, center.y, -center.z);
    let right = DVec3::new(focal / z, 0.0, focal * x / (z * z));
    let up = DVec3::new(0.0, focal / z, focal * y / (z * z));
    let sharp = [
        right.dot(covariance * right),
        right.dot(covariance * up),
        up.dot(covariance * up),
    ];
    let [a, b, c] = [sharp[0] + 0.3, sharp[1], sharp[2] + 0.3];
    let area = a * c - b * b;
    let middle = [focal + focal * x / z, focal - focal * y / z];
    let [u, v] = [0, 1].map(|k| f64::from(pixel[k]) + 0.5 - middle[k]);
    let v = -v;
    let squared = (c * u * u - 2.0 * b * u * v + a * v * v) / area;
    let mut opacity = f64::from(one.opacity);
    if antialiased {
        opacity *= ((sharp[0] * sharp[2] - b * b).max(0.0) / area).sqrt();
    }
    (opacity * (-0.5 * squared).exp()).min(0.99)
}

/// Every pixel of turned, stretched splats beside the middle, far, near and smaller than a pixel.
#[test]
fn splats_cover_what_the_textbook_says() {
    let turned = Quat::from_euler(glam::EulerRot::XYZ, 0.4, 0.9, -0.3);
    let ones = [
        ONE,
        One {
            center: Vec3::new(0.8, -0.5, -3.0),
            scale: Vec3::new(0.5, 0.1, 0.02),
            turn: turned,
            ..ONE
        },
        One {
            scale: Vec3::new(0.3, 0.0, 0.0),
            turn: turned,
            opacity: 1.0,
            ..ONE
        },
        One {
            center: Vec3::new(-2.0, 1.0, -9.0),
            scale: Vec3::splat(0.05),
            opacity: 0.9,
            ..ONE
        },
    ];
    let gpu = gpu();
    for (k, one) in ones.iter().enumerate() {
        for antialiased in [false, true] {
            let mut scene = splats(&[*one]);
            scene.blending = Blending::Linear;
            let mesh = Arc::make_mut(&mut scene.objects[0].mesh);
            mesh.splats.as_mut().unwrap().antialiased = antialiased;
            let image = draw(&gpu, &scene, "abuffer", SIZE);
            let mut seen = 0;
            for (found, i) in image.pixels.iter().zip(0..) {
                let pixel = [i % SIZE[0], i / SIZE[0]];
                let mut want = opacity(one, pixel, antialiased) as f32;
                // On the edge either is right.
                if (want - FAINTEST).abs() < OPACITY {
                    continue;
                }
                if want < FAINTEST {
                    want = 0.0;
                }
                seen += u32::from(want > 0.0);
                let bound = OPACITY + want * COLOR;
                assert_near(
                    *found,
                    [want; 3],
                    bound,
                    format_args!("splat {k}, {pixel:?}"),
                );
            }
            // One without extent is as wide as the blur.
            assert!(
                seen >= 4 || antialiased,
                "splat {k} is seen in {seen} pixels"
            );
        }
    }
}

/// Where along a ray a Gaussian is largest.
fn peak(one: &One, ray: DVec3) -> f64 {
    let (covariance, center) = in_view(one);
    let inverse = covariance.inverse();
    ray.dot(inverse * center) / ray.dot(inverse * ray)
}

/// A splat lies where its Gaussian is largest along the ray, whatever its neighbours: it is no plane that faces the eye.
#[test]
fn depths_are_those_of_the_gaussians() {
    let one = One {
        scale: Vec3::new(0.4, 0.3, 0.02),
        turn: Quat::from_rotation_y(0.9),
        ..ONE
    };
    let scene = splats(&[one]);
    let mut nearest = f64::INFINITY;
    let mut farthest = 0.0f64;
    for x in [17, 21, 24, 27, 30] {
        let found = fragments(&scene, [x, 23]);
        let side = |k: u32| (f64::from(k) + 0.5 - 24.0) / 24.0;
        let want = peak(&one, DVec3::new(side(x), -side(23), -1.0));
        // The projection is linear around the centre: an error of the second order in the distance from it, in depths.
        let tolerance = 3.0 * (want / 3.0 - 1.0).powi(2) + 0.01;
        let depth = f64::from(found[0].depth);
        assert!(
            (depth - want).abs() < 3.0 * tolerance,
            "{x}: {depth} for {want}"
        );
        (nearest, farthest) = (nearest.min(depth), farthest.max(depth));
    }
    assert!(farthest - nearest > 0.4, "{nearest} to {farthest}");
}

/// Two flat splats that cross show one in front on the left and the other on the right; sorted by centre, one is in front everywhere.
#[test]
fn crossing_splats_cross() {
    let red = One {
        scale: Vec3::new(0.6, 0.6, 0.005),
        turn: Quat::from_rotation_y(0.7),
        opacity: 0.98,
        color: [1.0, 0.0, 0.0],
        center: Vec3::new(0.0, 0.0, -3.001),
    };
    let green = One {
        turn: Quat::from_rotation_y(-0.7),
        color: [0.0, 1.0, 0.0],
        center: ONE.center,
        ..red
    };
    let gpu = gpu();
    let scene = splats(&[red, green]);
    let redder = |method: &str, x: usize| {
        let [r, g, ..] = draw(&gpu, &scene, method, SIZE).pixels[24 * 48 + x];
        r > g
    };
    for method in ["abuffer", "depth-peel", "splat"] {
        assert_ne!(redder(method, 20), redder(method, 28), "{method}");
    }
    assert_eq!(
        redder("painter-triangle", 20),
        redder("painter-triangle", 28)
    );
}

/// Layers of splats and glass, in either space: colours of splats are what a display shows, those of glass are linear light.
#[test]
fn colors_are_mixed_in_the_space_that_the_scene_says() {
    let wide = |z: f32, opacity: f32, color| One {
        center: Vec3::new(0.0, 0.0, -z),
        scale: Vec3::splat(30.0),
        opacity,
        color,
        turn: Quat::IDENTITY,
    };
    let (near, far) = ([0.9, 0.3, 0.1], [0.2, 0.8, 0.5]);
    let glass = [0.5, 0.25, 0.05];
    let s = 10.0;
    let pane = object(
        &rectangle([-s, s], [-s, s], 4.0),
        Material::unlit(glass, 0.25),
    );
    let behind = [0.1, 0.2, 0.6];
    let mut scene = splats(&[wide(3.0, 0.5, near), wide(5.0, 0.75, far)]);
    scene.objects.push(pane);
    scene.background = behind;
    let gpu = gpu();
    let over = |layers: [([f32; 3], f32); 3], behind: [f32; 3]| {
        layers.into_iter().rev().fold(behind, |b, (color, alpha)| {
            std::array::from_fn(|k| alpha * color[k] + (1.0 - alpha) * b[k])
        })
    };
    let [encoded, behind_encoded] = [glass, behind].map(|c| c.map(srgb::encode));
    let shown = over([(near, 0.5), (encoded, 0.25), (far, 0.75)], behind_encoded);
    let linear = [near, far].map(|c| c.map(srgb::decode));
    let light = over([(linear[0], 0.5), (glass, 0.25), (linear[1], 0.75)], behind);
    // Of a splat as wide as this the middle of the frame is the middle.
    let middle = 24 * 48 + 24;
    for method in ["abuffer", "linked-list", "painter-triangle"] {
        assert_eq!(scene.blending, Blending::Display);
        let image = draw(&gpu, &scene, method, SIZE);
        let bound = 5.0 * (COLOR + 1.0 / 2048.0);
        assert_near(image.pixels[middle], shown.map(srgb::decode), bound, method);
        scene.blending = Blending::Linear;
        let image = draw(&gpu, &scene, method, SIZE);
        assert_near(image.pixels[middle], light, bound, method);
        scene.blending = Blending::Display;
    }
}

/// The harmonics, by values that are known: each of the first degree points along an axis, and turning the object turns them.
#[test]
fn harmonics_are_seen_along_the_ray() {
    let gpu = gpu();
    let color = |degree: u8, k: usize, turn: Quat| {
        let mut object = cloud(&[One {
            scale: Vec3::splat(30.0),
            opacity: 0.5,
            ..ONE
        }]);
        let all = Arc::make_mut(&mut object.mesh).splats.as_mut().unwrap();
        all.degree = degree;
        all.harmonics = vec![[0.0; 3]; peelnet_scene::harmonics_of(degree)];
        all.harmonics[k] = [0.4, -0.2, 0.1];
        // About the splat's own middle.
        let middle = Mat4::from_translation(ONE.center);
        object.world_from_object = middle * Mat4::from_quat(turn) * middle.inverse();
        let scene = scene("harmonics", [0.0; 3], vec![object]);
        let [r, g, b, _] = draw(&gpu, &scene, "abuffer", SIZE).pixels[24 * 48 + 24];
        [r, g, b].map(|x| srgb::encode(x) / 0.5)
    };
    // The eye looks along −z: harmonics 1, 2, 3 are −y, z and −x times sqrt(3 / 4π), 6 is sqrt(5 / 16π) (3 z² − 1) and 12 sqrt(7 / 16π) z (5 z² − 3).
    let (first, second, third) = (0.488_602_5, 0.630_783_1, 0.746_352_7);
    let quarter = std::f32::consts::FRAC_PI_2;
    for (degree, k, turn, value) in [
        (0, 0, Quat::IDENTITY, CONSTANT_HARMONIC),
        (1, 1, Quat::IDENTITY, 0.0),
        (1, 2, Quat::IDENTITY, -first),
        (1, 3, Quat::IDENTITY, 0.0),
        // What was +x looks along −z then.
        (1, 3, Quat::from_rotation_y(quarter), -first),
        (1, 1, Quat::from_rotation_x(quarter), first),
        (2, 6, Quat::IDENTITY, second),
        (2, 8, Quat::from_rotation_y(quarter), 0.546_274_2),
        (3, 12, Quat::IDENTITY, -third),
        (3, 15, Quat::from_rotation_y(quarter), -0.590_043_6),
    ] {
        let want = [0.4, -0.2, 0.1].map(|c: f32| (0.5 + c * value).max(0.0));
        let [r, g, b] = color(degree, k, turn);
        // Twice COLOR: what is read is half of the colour. The ray passes half a pixel beside the middle.
        let bound = 2.0 * COLOR + 0.03 * 0.4;
        assert_near([r, g, b, 1.0], want, bound, format_args!("{degree}, {k}"));
    }
}

/// Splats that cross one another in every way, with glass among them.
fn crowd() -> Scene {
    let mut random = peelnet_core::random::Random::new(11, &[]);
    let mut some = || {
        let mut between = |low, high| random.between(low, high);
        One {
            center: Vec3::new(between(-1.5, 1.5), between(-1.5, 1.5), -between(2.0, 4.0)),
            scale: Vec3::new(between(0.02, 0.3), between(0.02, 0.3), between(0.0, 0.05)),
            turn: Quat::from_euler(
                glam::EulerRot::XYZ,
                between(0.0, 6.0),
                between(0.0, 6.0),
                0.0,
            ),
            opacity: between(0.05, 0.95),
            color: [between(0.0, 1.0), between(0.0, 1.0), between(0.0, 1.0)],
        }
    };
    let all: Vec<One> = (0..1500).map(|_| some()).collect();
    let pane = rectangle([-1.0, 1.0], [-1.0, 1.0], 3.0);
    let pane = object(&pane, Material::unlit([0.4, 0.1, 0.05], 0.4));
    scene("crowd", [0.0; 3], vec![cloud(&all), pane])
}

/// Methods that are exact see the same; so does a scene whose splats are moved where others are loaded.
#[test]
fn exact_methods_agree_on_splats() {
    let gpu = gpu();
    let scene = crowd();
    let want = draw(&gpu, &scene, "abuffer", SIZE);
    for method in ["depth-peel", "linked-list", "dual-peel"] {
        let found = draw(&gpu, &scene, method, SIZE);
        // Layers behind the last that a peel of fixed depth reaches cover less than a step.
        let bound = 24.0 / 2048.0;
        assert_alike(&found.pixels, &want.pixels, bound, method);
    }
    let mut elsewhere = scene.clone();
    let place = elsewhere.objects[0].world_from_object;
    elsewhere.objects[0].world_from_object = Mat4::from_translation(Vec3::new(0.4, 9.0, -2.0));
    let mut renderer = Renderer::new(&gpu, &elsewhere).unwrap();
    renderer.set_transform(0, place).unwrap();
    let mut method = prepare(&renderer, "abuffer", SIZE);
    let found = renderer.image(&mut method, &scene.views[0]).unwrap();
    assert_alike(&found.image.pixels, &want.pixels, 1e-6, "moved");
}

/// What is asked: the mean squared error of what is shown, of 40 dB.
const ASKED: f64 = 1e-4;

/// Where many layers lie in front of others, a method that looks for what is seen in each pixel does far better than one that does not.
#[test]
fn knots_over_the_visible_range_show_splats() {
    let gpu = gpu();
    let scene = peelnet_scene::Scene::from_bytes("cloud.toml", |_| {
        Ok(b"
            [camera]
            position = [0.0, 0.5, 2.4]
            target = [0.0, 0.0, 0.0]
            near = 0.05
            far = 30.0
            [[object]]
            mesh = { shape = 'splats', count = 30000, size = 0.02, degree = 1 }
            [[object]]
            mesh = { shape = 'quad' }
            rotate = [0.0, 40.0, 0.0]
            material = { color = [0.8, 0.1, 0.05], alpha = 0.4 }"
            .to_vec())
    });
    let scene = scene.unwrap();
    let size = [96, 72];
    let exact = draw(&gpu, &scene, "abuffer", size);
    let error = |method: &str| {
        let found = draw(&gpu, &scene, method, size);
        let pixels = found.pixels.iter().zip(&exact.pixels);
        let squares = pixels.flat_map(|(a, b)| {
            [0, 1, 2].map(|k| f64::from(srgb::encode(a[k]) - srgb::encode(b[k])).powi(2))
        });
        squares.sum::<f64>() / (3.0 * f64::from(size[0] * size[1]))
    };
    let found = error("splat");
    assert!(found < ASKED, "{found:e}");
    assert!(error("mboit4") > 10.0 * found);
}
