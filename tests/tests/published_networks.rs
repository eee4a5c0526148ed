//! `nmt` and `dfaoit` as published: what their shaders make of known fragments, and what they cost.

use peelnet_core::{
    absorbance::{DepthWarp, absorbance},
    fragment::{Fragment, worked_example},
    methods::{dfaoit::Layers, nmt, over},
    random::Random,
};
use peelnet_model::Recipe;
use peelnet_render::{Frame, MethodOptions, MethodSpec, Renderer};
use peelnet_tests::{evaluate_text, gpu, network_of, shipped, walls};

/// Draws walls of these fragments with the shipped network.
fn draw(method: &str, fragments: &[Fragment], background: [f32; 3]) -> Frame {
    let gpu = gpu();
    let spec: MethodSpec = method.parse().unwrap();
    let scene = walls(fragments, background);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let (text, _) = network_of(&spec).unwrap();
    let options = MethodOptions::sized([4, 3]).with(Some(&text));
    let mut prepared = renderer.method(&spec, options).unwrap();
    renderer.image(&mut prepared, &scene.views[0]).unwrap()
}

/// Four 32-bit targets: b_0 with the count, four moments, colour, and two depths. Two passes of geometry.
#[test]
fn nmt_takes_56_bytes_a_pixel() {
    let stats = draw("nmt", &worked_example(), [0.0; 3]).stats;
    assert_eq!(stats.bytes_per_pixel, 56.0);
    assert_eq!(stats.geometry_passes, 2);
}

/// The text's moments and depth are those of the twin. WGSL's logarithm errs by 2⁻²¹ near 1 and its exponential by 2⁻²¹; a
/// depth is a quotient of differences of 1, of which [`nmt::EXTENT_FLOOR`] is the least.
#[test]
fn the_inputs_of_nmt_are_those_of_the_twin() {
    let text = peelnet_export::wgsl(&shipped(Recipe::NMT)).unwrap();
    let gpu = gpu();
    let mut random = Random::new(51, &[]);
    let inputs: Vec<[[f32; 4]; 2]> = (0..2000)
        .map(|i| {
            let alpha = [0.0, 1e-3, 0.5, 0.99996, 1.0, random.unit()][i % 6];
            let near = random.between(-1.0, 0.9);
            let width = [0.0, 1e-6, 1e-3, 0.1, 1.0][i % 5] * (1.0 - near);
            let zeta = near + width * random.unit();
            [[zeta, near, near + width, alpha], [0.0; 4]]
        })
        .collect();
    let body = |y: &str| format!("let s = peelnet_statistics(a.w, a.x); y = {y};");
    let functions = "peelnet_statistics, peelnet_depth";
    let got = |y: &str| evaluate_text(&gpu, &text, functions, &body(y), &inputs);
    let moments = got("s.moments");
    let rest = got("vec4f(s.totals.xy, s.extent)");
    let depths = got("vec4f(peelnet_depth(a.x, vec2f(-a.y, a.z)))");
    for (i, [[zeta, near, far, alpha], _]) in inputs.iter().enumerate() {
        let z = f64::from(*zeta);
        let b = absorbance(*alpha).min(nmt::ABSORBANCE_MAX);
        let bound = 2f64.powi(-20) * (1.0 + b);
        for (k, m) in (1..).zip(moments[i]) {
            let want = b * z.powi(k);
            assert!((f64::from(m) - want).abs() <= bound, "{m} for {want}");
        }
        let [b_0, one, behind, front] = rest[i];
        assert!((f64::from(b_0) - b).abs() <= bound, "{b_0} for {b}");
        assert_eq!([one, behind, front], [1.0, -zeta, *zeta]);
        let seen = nmt::Seen {
            zeta: z,
            extent: [(*near).into(), (*far).into()],
            count: 1,
            moments: [0.0; 5],
        };
        let extent = ((far - near) / 2.0).exp_m1();
        let bound = 2f64.powi(-20) / f64::from(extent).max(nmt::EXTENT_FLOOR);
        let error = (f64::from(depths[i][0]) - seen.depth()).abs();
        assert!(error <= bound.min(0.1), "{error} of {seen:?}");
    }
}

/// The ends of two fragments are 0 and 1: the network is asked with these depths whatever lies between the planes of the camera.
#[test]
fn two_fragments_are_the_ends_of_nmt() {
    let warp = DepthWarp::new(0.5, 4000.0);
    for far in [1.01f32, 2.0, 900.0] {
        let seen = nmt::Seen::all(&[(far, 0.5), (1.0, 0.25)], &warp);
        assert_eq!([seen[0].depth(), seen[1].depth()], [1.0, 0.0]);
        assert_eq!(seen[0].moments, seen[1].moments);
    }
}

/// Up to two fragments are exact whatever the network predicts, in the order of depth: sixteen roundings of 32 bits.
#[test]
fn dfaoit_is_exact_up_to_two_fragments() {
    let all = worked_example();
    let c0 = [0.9, 0.1, 0.4];
    for fragments in [&all[..0], &all[..1], &all[..2], &[all[3], all[0]]] {
        let want = over::composite(fragments, c0);
        for p in draw("dfaoit", fragments, c0).image.pixels {
            for k in 0..3 {
                assert!((p[k] - want[k]).abs() < 1e-6, "{p:?} for {want:?}");
            }
        }
    }
}

/// From three fragments on the network's colour stands in front of the background: what it answers for the known inputs of the
/// worked example. 16-bit sums of four colours round by 2⁻¹¹ each, and a colour may move by a few times what its inputs move by.
#[test]
fn dfaoit_shows_the_answer_of_the_network() {
    let all = worked_example();
    let layers = Layers::of(all.iter().map(|f| (f.alpha, f.color)));
    let model = shipped(Recipe::DFAOIT);
    let peelnet_model::Inputs::Layers(inputs) = Recipe::DFAOIT.inputs else {
        panic!("other inputs");
    };
    let color = model.answers(inputs, &layers);
    let c0 = [0.9, 0.1, 0.4];
    for (method, bound) in [("dfaoit", 16.0 / 2048.0), ("dfaoit:targets=f32", 1e-4)] {
        // Drawn farthest first.
        let reversed: Vec<Fragment> = all.iter().rev().copied().collect();
        let frame = draw(method, &reversed, c0);
        for p in frame.image.pixels {
            for k in 0..3 {
                let want = color[k] + 0.0125 * f64::from(c0[k]);
                assert!((f64::from(p[k]) - want).abs() < bound, "{method}: {p:?}");
            }
        }
    }
}
