//! Four samples a pixel: each is composited by itself, and the pixel is their mean in linear light.

use peelnet_core::fragment::Fragment;
use peelnet_render::gpu::{Gpu, wgpu};
use peelnet_render::{
    Image, MethodOptions, MethodSpec, Renderer, Target,
    methods::{Pixel, Precision},
};
use peelnet_scene::{Material, Object, Scene};
use peelnet_tests::{
    assert_near, assert_refused, frame, gpu, object, rectangle, scene, window_depth,
};
use std::fmt::Display;

/// Pixels of a side; at depth 2 a pixel is one unit wide.
const SIDE: u32 = 4;

/// The column of pixels that edges cut.
const CUT: u32 = 1;

/// Places of the four samples of a pixel from its left edge, in the order of the standard pattern, and from its upper edge.
const ACROSS: [f32; 4] = [0.375, 0.875, 0.125, 0.625];

const BACKGROUND: [f32; 3] = [0.1, 0.2, 0.4];

/// Sums of a few fragments in 16 bits: a rounding of 2⁻¹¹ for each of the sums and of the products behind them, of values below 2.
const HALF_SUMS: f32 = 8.0 / 2048.0;

/// The same in 32 bits, with the shader's own logarithms and roots.
const FULL_SUMS: f32 = 1e-4;

/// Roots of moments in 32 bits: see `MOMENTS` of the closed forms.
const ROOTS: f32 = 2e-2;

/// A wall at a depth that ends to the right at this share of the pixels of column [`CUT`].
fn half_plane(depth: f32, share: f32, material: Material) -> Object {
    let unit = depth / 2.0;
    let far = 9.0 * unit;
    let edge = (CUT as f32 + share - 2.0) * unit;
    object(&rectangle([-far, edge], [-far, far], depth), material)
}

fn image(gpu: &Gpu, scene: &Scene, method: impl Display) -> Image {
    let options = MethodOptions::sized([SIDE; 2]).sampled(4);
    frame(gpu, scene, method, options).image
}

/// A surface that covers k of a pixel's samples covers k quarters of it: the A-buffer's coverage of areas.
#[test]
fn coverage_comes_in_quarters() {
    let gpu = gpu();
    let white = Material {
        blend: true,
        ..Material::unlit([1.0; 3], 1.0)
    };
    // To both sides of each sample, by a thirty-second of a pixel.
    let shares = (0..4).flat_map(|k| {
        let sample = 0.125 + 0.25 * k as f32;
        [(sample - 0.03125, k), (sample + 0.03125, k + 1)]
    });
    for (share, covered) in shares {
        let wall = half_plane(2.0, share, white.clone());
        let scene = scene("edge", [0.0; 3], vec![wall]);
        for method in ["abuffer", "linked-list", "depth-peel", "dual-peel"] {
            let image = image(&gpu, &scene, method);
            for (i, pixel) in image.pixels.iter().enumerate() {
                let want = match i as u32 % SIDE {
                    0 => 1.0,
                    CUT => covered as f32 / 4.0,
                    _ => 0.0,
                };
                assert_eq!(*pixel, [want; 4], "{method}, edge at {share}, pixel {i}");
            }
        }
    }
}

/// A pixel cut by the edges of two surfaces is, for every method, the mean of what its CPU reference makes of the fragments of each sample: one
/// sample holds both, one the nearer, one the farther surface, and one none. Means of statistics would give another colour.
#[test]
fn a_pixel_is_the_mean_of_its_samples() {
    let gpu = gpu();
    // Depth, share of the pixel, colour and alpha.
    let surfaces = [
        (2.0, 0.5, [0.9, 0.2, 0.1], 0.5),
        (4.0, 0.75, [0.1, 0.8, 0.3], 0.7),
    ];
    let objects = surfaces.map(|(depth, share, color, alpha)| {
        half_plane(depth, share, Material::unlit(color, alpha))
    });
    let scene = scene("edges", BACKGROUND, objects.into());
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let warp = renderer.depth_warp(&scene.views[0]);
    let mut judged = 0;
    for spec in MethodSpec::all() {
        let mean = || -> Option<[f32; 3]> {
            let mut mean = [0.0; 3];
            for across in ACROSS {
                let inside = surfaces.iter().filter(|s| across < s.1);
                let fragment = |&(depth, _, color, alpha): &_| Fragment {
                    window_depth: window_depth(depth),
                    ..Fragment::new(depth, alpha, color)
                };
                let fragments: Vec<Fragment> = inside.map(fragment).collect();
                let color = spec.reference(&Pixel {
                    fragments: &fragments,
                    background: BACKGROUND,
                    warp,
                    position: [CUT, 0],
                    model: None,
                })?;
                for (m, c) in mean.iter_mut().zip(color) {
                    *m += c / 4.0;
                }
            }
            Some(mean)
        };
        // Random numbers of a pixel's position are other ones in every row, and references know nothing of the neighbours, which hold other surfaces.
        let guarantees = spec.guarantees();
        let alone = guarantees.per_pixel && !guarantees.noisy;
        let Some(want) = mean().filter(|_| alone) else {
            continue;
        };
        let tolerance = match (guarantees.root, guarantees.sums, guarantees.statistics) {
            (Some(_), _, Precision::Full) => ROOTS,
            // Errors of 16-bit statistics have no simple bound where roots are taken.
            (Some(_), ..) => continue,
            (None, Precision::Full, Precision::Full) => FULL_SUMS,
            _ => HALF_SUMS,
        };
        let image = image(&gpu, &scene, &spec);
        for y in 0..SIDE {
            let pixel = image.pixels[(y * SIDE + CUT) as usize];
            assert_near(pixel, want, tolerance, &spec);
        }
        judged += 1;
    }
    assert!(judged > 15, "{judged}");
}

/// What samples cost is reported: four times the passes, the pass that averages them in a timed frame, and the target of the mean.
#[test]
fn samples_have_their_cost() {
    let gpu = gpu();
    let wall = half_plane(2.0, 0.5, Material::unlit([0.9, 0.2, 0.1], 0.5));
    let scene = scene("edge", BACKGROUND, vec![wall]);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let spec: MethodSpec = "wboit-eq9".parse().unwrap();
    let profile = |samples| {
        let options = MethodOptions::sized([8, 8]).sampled(samples);
        let mut method = renderer.method(&spec, options).unwrap();
        renderer.profile(&mut method, &scene.views[0]).unwrap()
    };
    let (one, four) = (profile(1), profile(4));
    assert_eq!(four.stats.geometry_passes, 4 * one.stats.geometry_passes);
    let fullscreen = 4 * (one.stats.fullscreen_passes + 1);
    assert_eq!(four.stats.fullscreen_passes, fullscreen);
    assert_eq!(four.stats.bytes_per_pixel, one.stats.bytes_per_pixel + 8.0);
    let [one, four] = [one, four].map(|profile| {
        let labels = profile.times.into_iter().map(|t| t.label);
        labels.filter(|label| label == "background").count()
    });
    assert_eq!(one, four);
}

/// Numbers that WebGPU does not have are refused, and so is a target of the caller's, which cannot be drawn again.
#[test]
fn what_cannot_be_sampled_is_refused() {
    let gpu = gpu();
    let scene = scene("empty", BACKGROUND, Vec::new());
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let spec: MethodSpec = "abuffer".parse().unwrap();
    for samples in [0, 2, 3, 8] {
        let refused = renderer.method(&spec, MethodOptions::sized([4, 4]).sampled(samples));
        assert_refused(refused, &[&format!("1 or 4 samples, not {samples}")]);
    }
    let options = MethodOptions::sized([4, 4]).sampled(4);
    let mut method = renderer.method(&spec, options).unwrap();
    let format = wgpu::TextureFormat::Rgba16Float;
    let none = wgpu::TextureUsages::empty();
    let view = gpu.texture("target", format, [4, 4], 1, none).unwrap();
    let mut encoder = gpu.encoder();
    let target = Target::over(&view);
    let drawn = renderer.draw(&mut encoder, &mut method, &scene.views[0], &target);
    assert_refused(drawn, &["1 sample"]);
}
