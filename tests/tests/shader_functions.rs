//! Functions that exist once in Rust and once in WGSL: evaluated on the GPU and compared.

use peelnet_core::{
    absorbance::DepthWarp,
    fragment::{Fragment, points},
    guards,
    methods::{anchored, deep, dfaoit, nmt, one, slabs},
    random::Random,
    statistics::SumPrecision,
    weights::Weight,
};
use peelnet_model::{
    Recipe,
    inputs::{
        ANCHORED, AnchoredInputs, DFAOIT, DfaoitInputs, Feature, NINE_OF_SUMS, NMT, NmtInputs,
        OneInputs, SlabInputs, THESIS, ThesisInputs, values,
    },
};
use peelnet_render::gpu::Gpu;
use peelnet_tests::{HALF, gpu};
use std::{any::Any, collections::BTreeSet};

/// Runs `body` (WGSL statements that read `x = inputs[i]` and set `y`) for every input, with features of the shaders.
fn evaluate(
    gpu: &Gpu,
    features: &[&str],
    imports: &str,
    body: &str,
    inputs: &[[f32; 4]],
) -> Vec<[f32; 4]> {
    let root = format!(
        "{imports}
        @group(0) @binding(0) var<storage, read> inputs: array<vec4f>;
        @group(0) @binding(1) var<storage, read_write> outputs: array<vec4f>;
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x >= arrayLength(&inputs) {{ return; }}
            let x = inputs[id.x];
            var y = vec4f(0.0);
            {body}
            outputs[id.x] = y;
        }}"
    );
    let shader = peelnet_render::shaders::link("driver", features, &[("driver", &root)]).unwrap();
    let count = inputs.len();
    gpu.run(&shader.text, inputs, count, count as u32).unwrap()
}

#[test]
fn weights() {
    let gpu = gpu();
    let inputs: Vec<[f32; 4]> = (0..4000)
        .map(|i| {
            let z = 10f32.powf(-2.0 + 7.0 * (i as f32 / 4000.0));
            [z, (i % 97) as f32 / 96.0, (i % 89) as f32 / 88.0, 0.0]
        })
        .collect();
    let calls = [
        ("weight_eq7(x.x, x.y)", Weight::Eq7),
        ("weight_eq8(x.x, x.y)", Weight::Eq8),
        ("weight_eq9(x.x, x.y)", Weight::Eq9),
        ("weight_eq10(x.z, x.y, 3e3)", Weight::Eq10 { factor: 3e3 }),
        (
            "weight_inverse_power(x.x, 2u, 5.0)",
            Weight::InversePower { k: 2, epsilon: 5.0 },
        ),
        ("weight_papakostas(x.x, x.y)", Weight::Papakostas),
    ];
    for (call, weight) in calls {
        let name = call.split('(').next().unwrap();
        let imports = format!("import package::helpers::weights::{name};");
        let got = evaluate(&gpu, &[], &imports, &format!("y.x = {call};"), &inputs);
        for (x, y) in inputs.iter().zip(&got) {
            let want = weight.eval(x[0], x[1], x[2]);
            // WGSL allows 2.5 units for each division; the sixth power multiplies its error by six.
            let error = (y[0] - want).abs();
            let is_near = error <= 32.0 * f32::EPSILON * want.abs();
            assert!(is_near, "{call} at {x:?}: {y:?} for {want}");
        }
    }
}

#[test]
fn guards_are_the_same_numbers() {
    let gpu = gpu();
    let got = evaluate(
        &gpu,
        &[],
        "import package::helpers::guards::{SUM_FLOOR, HALF_MAX, WEIGHT_FLOOR, FILL_MAX, EMISSIVE_ALPHA};",
        "y = vec4f(SUM_FLOOR, HALF_MAX, WEIGHT_FLOOR, FILL_MAX);
        if x.x > 0.0 { y = vec4f(EMISSIVE_ALPHA); }",
        &[[0.0; 4], [1.0; 4]],
    );
    use guards::{EMISSIVE_ALPHA, FILL_MAX, HALF_MAX, SUM_FLOOR, WEIGHT_FLOOR};
    assert_eq!(got[0], [SUM_FLOOR, HALF_MAX, WEIGHT_FLOOR, FILL_MAX]);
    assert_eq!(got[1], [EMISSIVE_ALPHA; 4]);
}

/// Stored colours come back within half a step: of a half float, 2^-11 of the value, and of less than its normal numbers half of the least
/// step, 2^-25; of a byte, 1/510 of alpha and of the colour's square root, so that the colour errs by that times twice the root.
#[test]
fn stored_colors_come_back_within_half_a_step() {
    const LEAST: f32 = 1.0 / 33_554_432.0;
    const BYTE: f32 = 0.5 / 255.0;
    // Roots and squares in 32 bits.
    const ROUNDING: f32 = 8.0 * f32::EPSILON;
    let gpu = gpu();
    let mut random = Random::new(24, &[]);
    let mut inputs: Vec<[f32; 4]> = (0..2000)
        .map(|_| [(); 4].map(|()| random.unit() * random.unit()))
        .collect();
    inputs.extend([[0.0; 4], [1.0; 4], [1e-6, 1e-5, 1e-4, 1e-3]]);
    let beyond = inputs.len();
    inputs.push([1.5, 60_000.0, 1.25, 1.0]);
    let stored = |feature: &str| {
        evaluate(
            &gpu,
            &[feature],
            "import package::helpers::stored::{Stored, restored, stored};",
            "let kept: Stored = stored(x); y = restored(kept);",
            &inputs,
        )
    };
    assert_eq!(stored("full_colors"), inputs);
    for (x, y) in inputs.iter().zip(stored("half_colors")) {
        for (x, y) in x.iter().zip(y) {
            assert!((x - y).abs() <= HALF * x + LEAST, "{y} for {x}");
        }
    }
    let bytes = stored("byte_colors");
    for (x, y) in inputs[..beyond].iter().zip(&bytes) {
        for (x, y) in x[..3].iter().zip(y) {
            let (x_root, y_root) = (x.sqrt(), y.sqrt());
            assert!((x_root - y_root).abs() <= BYTE + ROUNDING, "{y} for {x}");
        }
        assert!((x[3] - y[3]).abs() <= BYTE + ROUNDING, "{y:?} for {x:?}");
    }
    // Light beyond 1 is cut off there, as `about` of the parameter says.
    assert_eq!(bytes[beyond], [1.0; 4]);
}

/// Roundings of the longest expression, the bounds of moments. Their system is conditioned by the bias, at least 2^-10.
const FEATURE_ROUNDINGS: f64 = 4096.0;

/// Compares features on what is known of random pixels. `parameters` are what the expressions in WGSL read, from the numbers `x0`, `x1` … that
/// `numbers` gives.
fn compare_features<C>(
    recipe: Recipe,
    features: &[&Feature<C>],
    known: impl Iterator<Item = C>,
    numbers: impl Fn(&C) -> Vec<f64>,
    parameters: &str,
) {
    let known: Vec<C> = known.collect();
    let inputs: Vec<f32> = known.iter().flat_map(numbers).map(|x| x as f32).collect();
    let (count, width) = (features.len(), inputs.len() / known.len());
    let mut body: String = (0..width)
        .map(|k| format!("let x{k} = inputs[id.x * {width}u + {k}u];"))
        .collect();
    body += parameters;
    for (k, feature) in features.iter().enumerate() {
        let shared = feature.about.shared;
        let shared = shared.map(|s| format!("let {} = {};", s.name, s.wgsl));
        let (shared, wgsl) = (shared.unwrap_or_default(), feature.about.wgsl);
        body += &format!("{{ {shared} outputs[id.x * {count}u + {k}u] = {wgsl}; }}");
    }
    let surroundings = recipe.inputs.surroundings();
    let mut modules: BTreeSet<&str> = surroundings.modules.iter().copied().collect();
    modules.extend(features.iter().filter_map(|f| f.about.shared?.module));
    let modules = modules.into_iter();
    let modules: String = modules
        .map(|module| peelnet_render::shaders::source(module).unwrap())
        .collect();
    let answer = if recipe.output.count() == 1 {
        "f32"
    } else {
        "vec3f"
    };
    let driver = format!(
        "{modules}
        fn peelnet_network({}) -> {answer} {{ return {answer}(); }}
        @group(0) @binding(0) var<storage, read> inputs: array<f32>;
        @group(0) @binding(1) var<storage, read_write> outputs: array<f32>;
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x < arrayLength(&outputs) / {count}u {{ {body} }}
        }}",
        surroundings.parameters
    );
    let threads = known.len() as u32;
    let found: Vec<f32> = gpu()
        .run(&driver, &inputs, known.len() * count, threads)
        .unwrap();
    for (known, found) in known.iter().zip(found.chunks_exact(count)) {
        for ((feature, want), &found) in features.iter().zip(values(features, known)).zip(found) {
            let error = (f64::from(found) - want).abs();
            let limit = FEATURE_ROUNDINGS * f64::from(f32::EPSILON) * want.abs().max(1.0);
            let name = feature.about.name;
            assert!(error <= limit, "{recipe}, {name}: {found} for {want}");
        }
    }
}

fn random_pixels() -> Vec<Vec<Fragment>> {
    let mut random = Random::new(35, &[]);
    let mut layer = |_| {
        let depth = random.log_between(1.0, 100.0);
        Fragment::new(depth, random.between(0.02, 0.98), random.color())
    };
    let pixel = |k| (0..3 + k % 12).map(&mut layer).collect();
    (0..200).map(pixel).collect()
}

fn compare_sums(recipe: Recipe, of: &OneInputs, pixels: &[Vec<Fragment>], warp: &DepthWarp) {
    let exact = SumPrecision::Exact;
    compare_features(
        recipe,
        &NINE_OF_SUMS,
        pixels.iter().flat_map(|pixel| {
            let (list, colors) = (points(pixel), pixel.iter().map(|f| f.color));
            let list = slabs::points(&list, warp);
            let kept = one::Kept::gather(&list, colors, of.design, one::Around::NONE, exact);
            kept.rest().ahead.into_iter().take(of.design.middles.len())
        }),
        |a| {
            let shares = [a.before, a.own, a.previous, a.next];
            [
                &[a.absorbance, a.total][..],
                &shares,
                &[a.alpha, a.place, a.number],
            ]
            .concat()
        },
        "let ahead = PeelnetAhead(x0, x1, x2, x3, x4, x5, x6, x7, x8);",
    );
}

#[test]
fn features_are_the_same_in_rust_and_wgsl() {
    let pixels = random_pixels();
    let warp = DepthWarp::new(1.0, 100.0);
    let lists: Vec<_> = pixels.iter().map(|pixel| points(pixel)).collect();
    let exact = SumPrecision::Exact;
    for recipe in Recipe::ALL {
        let inputs: &dyn Any = recipe.inputs;
        if inputs.is::<ThesisInputs>() {
            compare_features(
                recipe,
                &THESIS,
                pixels
                    .iter()
                    .flat_map(|pixel| pixel.iter().map(|f| deep::Row::new(f, pixel))),
                |row| {
                    let row = [row.linear_depth, row.alpha_sum, row.fragment_count];
                    row.map(f64::from).to_vec()
                },
                "let linear_depth = x0; let statistics = vec2f(x1, x2);",
            );
        } else if inputs.is::<NmtInputs>() {
            compare_features(
                recipe,
                &NMT,
                lists
                    .iter()
                    .flat_map(|list| nmt::FragmentMoments::all(list, &warp)),
                |seen| {
                    let ([near, far], [b0, b1, b2, b3, b4]) = (seen.extent, seen.moments);
                    vec![seen.zeta, -near, far, b0, seen.count as f64, b1, b2, b3, b4]
                },
                "let zeta = x0; let extent = vec2f(x1, x2); let totals = vec4f(x3, x4, 0.0, 0.0);
        let moments = vec4f(x5, x6, x7, x8);",
            );
        } else if inputs.is::<DfaoitInputs>() {
            compare_features(
        recipe,
        &DFAOIT,
        pixels
            .iter()
            .map(|pixel| dfaoit::Layers::from_fragments(pixel.iter().map(|f| (f.alpha, f.color)))),
        |l| {
            let numbers = l.average.iter().chain([&l.average_alpha]);
            numbers.chain(&l.sum).chain(&l.front).copied().collect()
        },
        "let count = 3.0; let behind = count * vec4f(x0, x1, x2, x3); let all = vec4f(x4, x5, x6, 0.0);
        let front = vec4f(x7, x8, x9, 0.0);",
    );
        } else if inputs.is::<AnchoredInputs>() {
            compare_features(
                recipe,
                &ANCHORED,
                lists
                    .iter()
                    .flat_map(|list| anchored::known_fragments(list, &warp, exact))
                    .filter_map(|f| f.unknown),
                |rest| {
                    let place = [rest.absorbance.sqrt(), rest.place];
                    [&place[..], &rest.means, &[rest.bias]].concat()
                },
                "let rest = PeelnetRest(x0, x1, vec4f(x2, x3, x4, x5), x6);",
            );
        } else if let Some(of) = inputs.downcast_ref::<SlabInputs>() {
            compare_features(
                recipe,
                of.features,
                lists
                    .iter()
                    .flat_map(|list| slabs::known_fragments(list, &warp, of.design, exact))
                    .filter_map(|f| f.unknown),
                |b| {
                    let sums = [b.absorbance, b.place, b.mean];
                    let rest = [b.extent, b.own, b.nearest];
                    [&sums[..], &b.bounds, &rest].concat()
                },
                "let between = PeelnetBetween(x0, x1, x2, x3, x4, x5, x6, x7);",
            );
        } else if let Some(of) = inputs.downcast_ref::<OneInputs>() {
            compare_sums(recipe, of, &pixels, &warp);
        } else {
            panic!("{recipe}: nothing is known for its inputs");
        }
    }
}
