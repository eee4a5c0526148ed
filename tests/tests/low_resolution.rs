//! Transparency at a lower resolution: nothing changes where nothing varies, and opaque edges stay sharp.

use glam::Vec3;
use peelnet_core::fragment::worked_example;
use peelnet_render::{Image, MethodOptions, MethodSpec, Renderer};
use peelnet_scene::{Material, Object};
use peelnet_tests::{draw, gpu, scene, wall, walls};

fn furthest(a: &Image, b: &Image) -> f32 {
    let channels = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    channels.map(|(x, y)| (x - y).abs()).fold(0.0, f32::max)
}

/// Compositing over black and then over `C_0` rounds a few times more than compositing over `C_0`.
const ROUNDING: f32 = 1e-5;

/// A quarter of the pixels take a quarter of the bytes, and 36 for each of them: colour, the black behind it, and opaque depth.
#[test]
fn half_the_resolution_takes_a_quarter_of_the_bytes() {
    let gpu = gpu();
    let walls = walls(&worked_example(), [0.0; 3]);
    let renderer = Renderer::new(&gpu, &walls).unwrap();
    let bytes = |spec: &MethodSpec| {
        // Blocks of 8 pixels fit into half of it.
        let options = MethodOptions::sized([64, 48]);
        let mut method = renderer.method(spec, options).unwrap();
        let drawn = renderer.image(&mut method, &walls.views[0]).unwrap();
        drawn.stats.bytes_per_pixel
    };
    for spec in MethodSpec::all() {
        let (full, low) = (bytes(&spec), bytes(&spec.with("scale", "0.5").unwrap()));
        let want = 0.25 * (full + 36.0);
        // Sorted triangles keep their indices at any resolution: 12 bytes for each of eight.
        let indices = 0.75 * 96.0 / (64.0 * 48.0);
        let apart = low - want;
        assert!(
            apart.abs() < 1e-9 || (apart - indices).abs() < 1e-9,
            "{spec}: {low}, not {want}"
        );
    }
}

/// Where every pixel holds the same fragments, any scale gives the image of the full resolution, for frames of odd sizes too.
#[test]
fn what_does_not_vary_is_unchanged() {
    let gpu = gpu();
    let walls = walls(&worked_example(), [0.25, 0.5, 0.75]);
    for spec in MethodSpec::all() {
        // Samples differ from pixel to pixel by design.
        if spec.promises().noisy {
            continue;
        }
        let full = draw(&gpu, &walls, &spec.to_string(), [7, 5]);
        for scale in ["0.5", "0.3", "1"] {
            let scaled = spec.with("scale", scale).unwrap().to_string();
            let low = draw(&gpu, &walls, &scaled, [7, 5]);
            let apart = furthest(&full, &low);
            assert!(apart <= ROUNDING, "{spec} at {scale}: {apart}");
            if scale == "1" {
                assert_eq!(full, low, "{spec}");
            }
        }
    }
}

/// An opaque post before a transparent wall: no transparency leaks onto the post, and none is missing beside it.
#[test]
fn opaque_edges_stay_sharp() {
    let gpu = gpu();
    let quad = |x: [f32; 2], z: f32| {
        let v = |x: f32, y: f32| Vec3::new(x * z, y * z, -z);
        let (a, b, c, d) = (v(x[0], -2.0), v(x[1], -2.0), v(x[1], 2.0), v(x[0], 2.0));
        [[a, b, c], [a, c, d]]
    };
    let post = Object::of_triangles(
        "post",
        &quad([-0.35, 0.4], 2.0),
        Material::unlit([0.0; 3], 1.0),
    );
    let scene = scene(
        "post",
        [0.0; 3],
        vec![post, wall(6.0, Material::unlit([1.0, 1.0, 1.0], 0.5))],
    );
    let size = [33, 29];
    let full = draw(&gpu, &scene, "abuffer", size);
    let low = draw(&gpu, &scene, "abuffer:scale=0.5", size);
    // Depths of 2 and 6, or of 6 and the far plane, differ by 2 relative to the nearer: a wrong sample weighs at most
    // (1 + 2^-10) / 4 against 2^-10 / 0.02^2 of one that is right.
    let right = 2f32.powi(-10) / 4e-4;
    let leak = 3.0 * 0.25 / right;
    assert!(furthest(&full, &low) <= leak, "{}", furthest(&full, &low));
    // Both are seen.
    let row = |x: usize| full.pixels[14 * 33 + x][0];
    assert_eq!((row(1), row(16)), (0.5, 0.0));
}

/// Where there is detail, half the resolution costs accuracy, and a quarter more.
#[test]
fn detail_is_lost_by_degrees() {
    let gpu = gpu();
    let quads: Vec<_> = (0..6)
        .map(|i| {
            let x = -1.0 + 0.3 * i as f32;
            let v = |x: f32, y: f32| Vec3::new(x * 3.0, y * 3.0, -3.0);
            let t = [v(x, -0.7), v(x + 0.4, -0.5), v(x + 0.1, 0.8)];
            Object::of_triangles(
                "leaf",
                &[t],
                Material::unlit([1.0, 0.5, 0.1 * i as f32], 0.6),
            )
        })
        .collect();
    let scene = scene("leaves", [0.0, 0.1, 0.2], quads);
    let full = draw(&gpu, &scene, "abuffer", [64, 48]);
    let mean = |method: &str| {
        let low = draw(&gpu, &scene, method, [64, 48]);
        let channels = full
            .pixels
            .iter()
            .flatten()
            .zip(low.pixels.iter().flatten());
        channels.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>()
    };
    let (half, quarter) = (mean("abuffer:scale=0.5"), mean("abuffer:scale=0.25"));
    assert!(0.0 < half && half < quarter, "{half} {quarter}");
}

/// Every method refuses them when its name is parsed.
#[test]
fn other_scales_are_refused() {
    for spec in MethodSpec::curve() {
        for scale in ["0", "-1", "1.5", "nan", "half"] {
            let e = spec.with("scale", scale).unwrap_err();
            assert!(e.to_string().contains("scale"), "{e}");
        }
    }
}
