//! What single methods do in scenes whose answer is known: opaque walls, capped peels, storage that grows, painters, few layers
//! of learned methods, and transparency at a lower resolution.

use peelnet_core::{
    fragment::{Fragment, worked_example},
    methods::over,
    tolerance,
};
use peelnet_render::{
    Image, MethodOptions, MethodSpec, Renderer,
    geometry::{depth_peel::DepthPeel, frame::Output, needs::compare_needs},
};
use peelnet_scene::Material;
use peelnet_tests::{
    HALF, assert_all, assert_near, assert_refused, draw, frame, gpu, half_sums, network_of, object,
    opaque, prepare, rectangle, representatives, scene, wall, walls,
};

/// An opaque silhouette inside smoke: all layers have one colour, so every normalised method, whatever its weights, shows
/// `c (1 − (1−α)^k) + S (1−α)^k` behind k layers, and nothing of what lies behind the silhouette.
#[test]
fn a_silhouette_in_smoke_is_exact() {
    const LAYERS: i32 = 30;
    const ALPHA: f32 = 0.06;
    const SILHOUETTE: [f32; 3] = [0.1, 0.02, 0.3];
    let (gpu, smoke) = (gpu(), [0.7, 0.75, 0.8]);
    for inside in [7, 30] {
        let mut fragments: Vec<_> = (0..LAYERS)
            .map(|i| Fragment::new(2.0 + 0.2 * i as f32, ALPHA, smoke))
            .collect();
        fragments.push(Fragment::new(1.9 + 0.2 * inside as f32, 1.0, SILHOUETTE));
        let mut scene = walls(&fragments, [1.0, 0.5, 0.0]);
        scene.objects.last_mut().unwrap().materials[0].blend = false;
        let t = (1.0 - ALPHA).powi(inside);
        let want = [0, 1, 2].map(|k| smoke[k] * (1.0 - t) + SILHOUETTE[k] * t);
        // Random samples hit their mean only in the mean.
        let is_checked = |s: &MethodSpec| s.guarantees().normalised && !s.guarantees().noisy;
        for spec in representatives().into_iter().filter(is_checked) {
            let image = draw(&gpu, &scene, &spec, [4, 4]);
            // Of one colour, half floats round sums of absorbance and of colour only: no root is magnified.
            let bound = half_sums(LAYERS as usize, 3.0);
            assert_near(image.pixels[5], want, bound, &spec);
        }
    }
}

/// What every geometry pass says that it reads of a surface is what naga finds in its shader, of every method in every setting, of the
/// passes that show surfaces, and of those that peel for datasets.
#[test]
fn passes_say_what_they_read() {
    let gpu = gpu();
    let scene = walls(&worked_example(), [0.1, 0.2, 0.3]);
    let (faults, passes) = compare_needs(|| {
        let renderer = Renderer::new(&gpu, &scene).unwrap();
        for spec in MethodSpec::curve() {
            let learned = network_of(&spec).map(|(learned, _)| learned);
            let options = MethodOptions {
                learned,
                ..MethodOptions::sized([4, 4])
            };
            frame(&gpu, &scene, &spec, options);
        }
        let mut surfaces = renderer.surfaces([4, 4], 1).unwrap();
        renderer.image(&mut surfaces, &scene.views[0]).unwrap();
        let frame = renderer.targets([4, 4], Output::Image, None).unwrap();
        DepthPeel::single(&renderer, &frame, &["dataset"]).unwrap();
        DepthPeel::dual(&renderer, &frame, &["dataset"], None).unwrap();
    });
    assert!(faults.is_empty(), "{faults:#?}");
    assert!(passes > 100, "{passes}");
}

/// A method without passes says why it cannot be drawn.
#[test]
fn a_method_on_the_cpu_is_not_drawn() {
    let renderer = Renderer::new(&gpu(), &walls(&[], [0.0; 3])).unwrap();
    let refused = renderer.method(&"mlab-1".parse().unwrap(), MethodOptions::sized([4, 4]));
    assert_refused(refused, &["mlab-1", "ordered access"]);
}

/// A capped run leaves out what it did not reach, and counts it.
#[test]
fn a_capped_peel_counts_what_it_left_out() {
    let fragments: Vec<_> = (1..=9)
        .map(|i| Fragment::new(i as f32, 0.25, [0.5; 3]))
        .collect();
    let scene = walls(&fragments, [0.0; 3]);
    for (name, left) in [("depth-peel:passes=4", 5), ("dual-peel:passes=3", 3)] {
        let frame = frame(&gpu(), &scene, name, MethodOptions::sized([2, 2]));
        assert_eq!(frame.stats.lost, left * 4, "{name}");
    }
}

/// A pool that is too small is made larger: every fragment is there, the second frame needs no second pass, and enough places
/// make the k-buffers exact. Of coincident walls all are kept, in the order of their triangles.
#[test]
fn bounded_storage_loses_nothing() {
    let gpu = gpu();
    let c0 = [0.3, 0.6, 0.9];
    // In pairs at one depth, of which one is drawn long before the other.
    let layer = |i: u16| {
        let t = f32::from(i * 17 % 40);
        let color = [t / 40.0, 0.5, 1.0 - t / 40.0];
        let mut layer = Fragment::new(1.0 + (t / 2.0).floor(), 0.1, color);
        layer.triangle = i.into();
        layer
    };
    let fragments: Vec<_> = (0..40).map(layer).collect();
    let scene = walls(&fragments, c0);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let want = over::composite(&over::sorted(&fragments), c0);
    for (name, passes) in [
        ("linked-list:nodes=1", [2, 1]),
        ("linked-list:nodes=500", [2, 1]),
        ("kbuffer-40", [2, 2]),
        ("hybrid-64", [2, 2]),
    ] {
        let mut prepared = prepare(&renderer, name, [5, 4]);
        for passes in passes {
            let frame = renderer.image(&mut prepared, &scene.views[0]).unwrap();
            assert_eq!(frame.stats.geometry_passes, passes, "{name}");
            assert_all(&frame.image, want, tolerance::EXACT as f32, name);
        }
    }
}

/// One and two layers are exact whatever a network of ours says, and with separate ends three; `dfaoit` up to two.
///
/// Three sums of n terms, each with a weight e^−b whose b ≤ 4 rounded, in half floats.
#[test]
fn few_layers_of_learned_methods_are_exact() {
    let gpu = gpu();
    let c0 = [0.2, 0.6, 0.4];
    let stack = |layers: &[(f32, f32)]| -> Vec<Fragment> {
        let colors = [[0.0, 0.0, 1.0], [0.37, 0.85, 0.63], [0.74, 0.7, 0.26]];
        let layers = layers.iter().zip(colors);
        layers.map(|(&(z, a), c)| Fragment::new(z, a, c)).collect()
    };
    let few = [
        stack(&[(3.0, 0.5)]),
        stack(&[(3.0, 0.999)]),
        stack(&[(3.0, 1.0)]),
        stack(&[(0.05, 0.4), (900.0, 0.8)]),
        stack(&[(1.1, 0.3), (1.0, 0.97)]),
    ];
    let three = [
        stack(&[(1.0, 0.3), (4.0, 0.6), (9.0, 0.8)]),
        stack(&[(0.1, 0.9), (0.2, 0.05), (5000.0, 0.99)]),
    ];
    for (method, exact_at_three) in [
        ("deep-small", true),
        ("deep-medium", true),
        ("deep-large", true),
        ("deep-anchored-small", false),
        ("deep-anchored-medium", true),
        ("dfaoit", false),
    ] {
        let three = three.iter().filter(|_| exact_at_three);
        for fragments in few.iter().chain(three) {
            let want = over::composite(&over::sorted(fragments), c0);
            let bound = (3 * fragments.len() + 4) as f32 * HALF;
            let image = draw(&gpu, &walls(fragments, c0), method, [3, 2]);
            assert_all(&image, want, bound, method);
        }
    }
}

fn furthest(a: &Image, b: &Image) -> f32 {
    let channels = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    channels.map(|(x, y)| (x - y).abs()).fold(0.0, f32::max)
}

/// Where every pixel holds the same fragments, any scale gives the image of the full resolution, for frames of odd sizes too. Compositing over
/// black and then over `C_0` rounds a few times more than compositing over `C_0`.
#[test]
fn a_lower_resolution_keeps_what_does_not_vary() {
    const ROUNDING: f32 = 1e-5;
    // The fifth pixel of each eight is looked at first, both ways: at every scale all tiles have one.
    const SIZE: [u32; 2] = [15, 15];
    let gpu = gpu();
    let walls = walls(&worked_example(), [0.25, 0.5, 0.75]);
    // Samples differ from pixel to pixel by design.
    let is_even = |s: &MethodSpec| !s.guarantees().noisy;
    for spec in representatives().into_iter().filter(is_even) {
        let full = draw(&gpu, &walls, &spec, SIZE);
        for scale in ["0.5", "0.3", "1"] {
            let low = spec.with("scale", scale).unwrap();
            let low = draw(&gpu, &walls, &low, SIZE);
            let apart = furthest(&full, &low);
            assert!(apart <= ROUNDING, "{spec} at {scale}: {apart}");
            assert!(scale != "1" || full == low, "{spec}");
        }
        for scale in ["0", "-1", "1.5", "nan", "half"] {
            assert_refused(spec.with("scale", scale), &["scale"]);
        }
    }
}

/// An opaque post before a transparent wall: no transparency leaks onto the post, and none is missing beside it.
#[test]
fn a_lower_resolution_keeps_opaque_edges() {
    let gpu = gpu();
    let post = rectangle([-0.7, 0.8], [-4.0, 4.0], 2.0);
    let post = object(&post, opaque([0.0; 3]));
    let glass = wall(6.0, Material::unlit([1.0; 3], 0.5));
    let scene = scene("post", [0.0; 3], vec![post, glass]);
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
