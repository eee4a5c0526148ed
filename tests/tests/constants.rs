//! Every number in the functions of published formulas matters: a tenth more or less of it fails the comparison with the CPU twin. Passes are
//! in `constants_of_passes.rs`.
//!
//! The texts are linked as they are and compared, then once more for every literal with that literal changed; see `altered`.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_core::{
    absorbance::{DepthWarp, absorbance},
    methods::{
        bins, mboit_trig, mboit4, mboit6, mboit8,
        moments::{MomentSums, Settings},
    },
    random::Random,
    weights::Weight,
};
use peelnet_tests::{
    altered::{Function, NEVER, Unseen, VALUES, check},
    gpu,
};

/// Why the least absorbance does not show.
const FAINT: &str = "a tenth of it is 1e-5 of light; a test of peelnet_core holds the twin to it";

/// Up to three layers of warped depth −0.9 … 0.9 and a depth that is asked, at random: (b, ζ) twice, and (b, ζ, asked).
fn stacks() -> Vec<[[f32; 4]; 2]> {
    let mut random = Random::new(21, &[]);
    let mut all: Vec<_> = (0..960)
        .map(|i| {
            let mut b = |some: bool| if some { random.between(0.1, 1.0) } else { 0.0 };
            let b = [b(true), b(i % 3 > 0), b(i % 3 > 1)];
            let mut z = || random.between(-0.9, 0.9);
            [[b[0], z(), b[1], z()], [b[2], z(), z(), 0.0]]
        })
        .collect();
    // Just more and just less than what counts as nothing.
    for b in [1.05e-4, 0.95e-4] {
        all.push([[b, -0.5, 0.0, 0.0], [0.0, 0.0, 0.8, 0.0]]);
    }
    all
}

/// One layer in the middle, where 32-bit moments are exact, asked at depths around it on the scale of what the bias blurs.
fn around_a_layer(bias: f32) -> Vec<[[f32; 4]; 2]> {
    (-12..=12)
        .map(|i| {
            [
                [2.0, 0.0, 0.0, 0.0],
                [0.0, 0.0, 0.25 * i as f32 * bias.sqrt(), 0.0],
            ]
        })
        .collect()
}

/// Layers of a sample.
fn layers(p: [f64; 4], q: [f64; 4]) -> [(f64, f64); 3] {
    [(p[0], p[1]), (p[2], p[3]), (q[0], q[1])]
}

const POWER_MOMENTS: &str = "
fn values(p: vec4f, q: vec4f) -> array<f32, 8> {
    let b = vec3f(p.x, p.z, q.x);
    let z = vec3f(p.y, p.w, q.y);
    var m: array<f32, 9>;
    for (var i = 0; i < 3; i++) {
        var power = b[i];
        for (var k = 0; k < 9; k++) {
            m[k] += power;
            power *= z[i];
        }
    }
    var y: array<f32, 8>;
    y[0] = CALL;
    return y;
}";

const CALLS: [(&str, &str); 3] = [
    (
        "mboit4",
        "transmittance_from_moments(m[0], vec4f(m[1], m[2], m[3], m[4]), q.z)",
    ),
    (
        "mboit6",
        "transmittance_from_moments(m[0], vec4f(m[1], m[2], m[3], m[4]), vec2f(m[5], m[6]), q.z)",
    ),
    (
        "mboit8",
        "transmittance_from_moments(m[0], vec4f(m[1], m[2], m[3], m[4]), vec4f(m[5], m[6], m[7], m[8]), q.z)",
    ),
];

fn power_moments(count: usize, settings: Settings) -> impl Fn([f64; 4], [f64; 4]) -> [f64; VALUES] {
    move |p, q| {
        let (mut four, mut six, mut eight) = (
            mboit4::Moments::default(),
            mboit6::Moments::default(),
            mboit8::Moments::default(),
        );
        for (b, z) in layers(p, q) {
            four.add(b, z);
            six.add(b, z);
            eight.add(b, z);
        }
        let mut y = [0.0; VALUES];
        y[0] = match count {
            4 => four.transmittance(q[2], &settings),
            6 => six.transmittance(q[2], &settings),
            _ => eight.transmittance(q[2], &settings),
        };
        y
    }
}

fn parameters(settings: &Settings) -> String {
    let (bias, overestimation) = (settings.bias as f32, settings.overestimation as f32);
    format!("const BIAS: f32 = {bias:?};\nconst OVERESTIMATION: f32 = {overestimation:?};\n")
}

/// Of moments with a bias of a quarter, under which the measure that is mixed in counts as much as the layers; and with the paper's, on the
/// scale of depth that it blurs.
#[test]
fn power_moments_have_no_number_that_does_not_matter() {
    let gpu = gpu();
    let papers = [Settings::PAPER, mboit6::PAPER, mboit8::PAPER];
    let mut problems = Vec::new();
    for ((method, call), paper) in CALLS.into_iter().zip(papers) {
        let reconstruct = format!("methods::{method}::reconstruct");
        let imports = format!("import package::{reconstruct}::transmittance_from_moments;");
        let driver = imports + &POWER_MOMENTS.replace("CALL", call);
        let count = method[5..].parse().unwrap();
        let blurred = Settings {
            bias: 0.25,
            ..paper
        };
        let unseen: &[_] = match count {
            4 => &[
                ("1.0", "let low = select(0.0, at_p, p < zeta)", "a sign"),
                ("1.0", "return select(1.0, min(t, 1.0), t >= 0.0);", NEVER),
            ],
            6 => &[
                ("1e-4", "if total < 1e-4 {", FAINT),
                ("1e-30", "let q = max(a * a / 9.0 - b / 3.0, 1e-30);", NEVER),
                ("1e4", "let t = clamp(root, -1e4, 1e4);", NEVER),
                ("1e4", "let t = clamp(root, -1e4, 1e4);", NEVER),
                ("1.0", "return select(1.0, min(t, 1.0), t >= 0.0);", NEVER),
            ],
            _ => &[
                ("1e-4", "if total < 1e-4 {", FAINT),
                ("1e3", "let points = clamp(select(zeros, ", NEVER),
                ("1e3", "let points = clamp(select(zeros, ", NEVER),
                ("1.0", "return select(1.0, min(t, 1.0), t >= 0.0);", NEVER),
            ],
        };
        problems.push(
            Function {
                name: method,
                modules: &[&reconstruct],
                parameters: &parameters(&blurred),
                driver: &driver,
                samples: stacks(),
                want: &power_moments(count, blurred),
                // Tens of roundings of values up to ten; of more than four moments roots are cosines, which llvmpipe has to 1e-5.
                tolerance: if count == 4 { 1e-5 } else { 2e-4 },
                least: 1.0,
                unseen,
            }
            .problem(&gpu),
        );
        problems.push(
            Function {
                name: &format!("{method} with the paper's bias"),
                modules: &[],
                parameters: &parameters(&paper),
                driver: &driver,
                samples: around_a_layer(paper.bias as f32),
                want: &power_moments(count, paper),
                // Roots of coefficients that span twelve decades.
                tolerance: 1e-4,
                least: 1.0,
                unseen: &[],
            }
            .problem(&gpu),
        );
    }
    check(problems);
}

#[test]
fn trigonometric_moments_have_no_number_that_does_not_matter() {
    let gpu = gpu();
    let driver = "
import package::methods::mboit_trig::circle::{angle, times, turn};
import package::methods::mboit_trig::reconstruct::transmittance_from_moments;
fn values(p: vec4f, q: vec4f) -> array<f32, 8> {
    let b = vec3f(p.x, p.z, q.x);
    let z = vec3f(p.y, p.w, q.y);
    var total = 0.0;
    var m: array<vec2f, 4>;
    for (var i = 0; i < 3; i++) {
        let first = turn(angle(z[i]));
        var power = b[i] * first;
        total += b[i];
        for (var k = 0; k < 4; k++) {
            m[k] += power;
            power = times(power, first);
        }
    }
    var y: array<f32, 8>;
    y[0] = transmittance_from_moments(total, m, angle(q.z));
    return y;
}";
    let mut problems = Vec::new();
    for count in [2, 3] {
        let settings = Settings {
            bias: 0.25,
            ..Settings::PAPER
        };
        let parameters = parameters(&settings) + &format!("const MOMENTS: i32 = {count};\n");
        let want = |p: [f64; 4], q: [f64; 4]| {
            let mut m = mboit_trig::Moments::new(count);
            for (b, z) in layers(p, q) {
                m.add(b, z);
            }
            let mut y = [0.0; VALUES];
            y[0] = m.transmittance(q[2], &settings);
            y
        };
        problems.push(
            Function {
                name: &format!("{count} trigonometric moments"),
                modules: &[
                    "methods::mboit_trig::circle",
                    "methods::mboit_trig::reconstruct",
                ],
                parameters: &parameters,
                driver,
                samples: stacks(),
                want: &want,
                // Tens of roundings, and sines and cosines, which llvmpipe has to 1e-5.
                tolerance: if count == 2 { 2e-5 } else { 6e-5 },
                least: 1.0,
                unseen: if count == 2 {
                    &[
                        ("3.0", "return vec4f(cubic(", "of three moments"),
                        ("3.0", "return vec4f(cubic(", "of three moments"),
                        ("1.0", "return select(1.0, min(t, 1.0), t >= 0.0);", NEVER),
                    ]
                } else {
                    &[
                        ("2.0", "return vec4f(quadratic(", "of two moments"),
                        ("4.0", "return vec4f(quadratic(", "of two moments"),
                        ("2.0", "return vec4f(quadratic(", "of two moments"),
                        ("1e-4", "if total < 1e-4 {", FAINT),
                        ("1.0", "return select(1.0, min(t, 1.0), t >= 0.0);", NEVER),
                    ]
                },
            }
            .problem(&gpu),
        );
    }
    check(problems);
}

#[test]
fn weights_have_no_number_that_does_not_matter() {
    let gpu = gpu();
    let imports = "import package::helpers::weights::{weight_eq7, weight_eq8, weight_eq9, weight_eq10, weight_inverse_power, weight_papakostas, weight_smoke};";
    let body = "
fn values(p: vec4f, q: vec4f) -> array<f32, 8> {
    return array<f32, 8>(
        weight_eq7(p.x, p.y), weight_eq8(p.x, p.y), weight_eq9(p.x, p.y), weight_eq10(p.z, p.y, 3e3),
        weight_inverse_power(p.x, 2u, 5.0), weight_papakostas(p.x, p.y),
        weight_smoke(p.x, 0.1), 0.0,
    );
}";
    let samples = (0..4000)
        .map(|i| {
            let t = i as f32 / 4000.0;
            [[10f32.powf(-2.0 + 7.0 * t), 0.5, t, 0.0], [0.0; 4]]
        })
        .collect();
    let want = |p: [f64; 4], _: [f64; 4]| {
        let all = [
            Weight::Eq7,
            Weight::Eq8,
            Weight::Eq9,
            Weight::Eq10 { factor: 3e3 },
            Weight::InversePower { k: 2, epsilon: 5.0 },
            Weight::Papakostas,
            Weight::Smoke { k: 0.1 },
        ];
        let mut y = [0.0; VALUES];
        for (y, w) in y.iter_mut().zip(all) {
            *y = f64::from(w.eval(p[0] as f32, p[1] as f32, p[2] as f32));
        }
        y
    };
    check([Function {
        name: "weights",
        modules: &["helpers::weights"],
        parameters: "",
        driver: &format!("{imports}{body}"),
        samples,
        want: &want,
        // 2.5 units for each division; the sixth power multiplies its error by six.
        tolerance: 32.0 * f64::from(f32::EPSILON),
        least: f64::MIN_POSITIVE,
        unseen: &[
            (
                "200.0",
                "let b = z / 200.0;",
                "of eq 8, whose least weight begins before that term counts",
            ),
            (
                "1e-5",
                "return alpha * clamp(min(0.3 / (1e-5",
                "the clamp to 1 begins where it is 3e-5 of the divisor",
            ),
            (
                "8.0",
                "return alpha * clamp(min(0.3 / (1e-5",
                "as printed; the clamp to 1 hides it",
            ),
        ],
    }
    .problem(&gpu)]);
}

#[test]
fn absorbance_has_no_number_that_does_not_matter() {
    let gpu = gpu();
    let driver = "
import package::helpers::absorbance::{absorbance, warped_depth};
import package::methods::bins::bin::{bin_of, capped_absorbance};
fn values(p: vec4f, q: vec4f) -> array<f32, 8> {
    let bin = bin_of(p.y);
    return array<f32, 8>(absorbance(p.x), capped_absorbance(p.x), bin.x, bin.y, warped_depth(p.z), 0.0, 0.0, 0.0);
}";
    let want = |p: [f64; 4], _: [f64; 4]| {
        let alpha = p[0] as f32;
        let position = p[1] * 8.0;
        let bin = position.floor().min(7.0);
        let of_bin = [bin, position - bin];
        let [b, capped] = [absorbance(alpha), bins::capped_absorbance(alpha)];
        let zeta = DepthWarp::new(0.5, 0.5 * f64::exp(4.0)).apply(p[2]);
        [b, capped, of_bin[0], of_bin[1], zeta, 0.0, 0.0, 0.0]
    };
    check([Function {
        name: "absorbance",
        modules: &["helpers::absorbance", "methods::bins::bin"],
        parameters: "const BINS: f32 = 8.0;\n",
        driver,
        samples: [0.0, 0.3, 0.9, 0.985, 0.989, 0.991, 0.999_999, 1.0]
            .into_iter()
            .zip(0..)
            .map(|(alpha, i)| [[alpha, i as f32 / 7.0, 0.25 * 2f32.powi(i), 0.0], [0.0; 4]])
            .collect(),
        want: &want,
        // A logarithm of llvmpipe's, and the rounding of 1 - alpha.
        tolerance: 1e-5,
        least: 1.0,
        unseen: &[],
    }
    .problem(&gpu)]);
}

/// The resolve: floors and ceilings of 16-bit sums.
#[test]
fn the_resolve_has_no_number_that_does_not_matter() {
    let gpu = gpu();
    let driver = "
import package::helpers::resolve::{normalised, normalised_by_channel};
fn values(p: vec4f, q: vec4f) -> array<f32, 8> {
    let a = normalised(p, q.x, q.yzw);
    let b = normalised_by_channel(p, q.xyz, q.www);
    return array<f32, 8>(a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w);
}";
    let want = |p: [f64; 4], q: [f64; 4]| {
        let most = f64::from(peelnet_core::guards::HALF_MAX);
        let least = f64::from(peelnet_core::guards::SUM_FLOOR);
        let mean = |k: usize| p[k].min(most) / p[3].min(most).max(least);
        let covered = 1.0 - (q[0] + q[1] + q[2]) / 3.0;
        let mut y = [0.0; VALUES];
        for k in 0..3 {
            y[k] = mean(k) * (1.0 - q[0]) + q[1 + k] * q[0];
            y[4 + k] = mean(k) * covered + q[3] * q[k];
        }
        if q[0] == 1.0 {
            y[..4].copy_from_slice(&[q[1], q[2], q[3], 0.0]);
        } else {
            y[3] = 1.0 - q[0];
        }
        if q[..3] == [1.0; 3] {
            y[4..].copy_from_slice(&[q[3], q[3], q[3], 0.0]);
        } else {
            y[7] = covered;
        }
        y
    };
    let behind = [0.25, 0.5, 0.75];
    let sample = |sums: [f32; 4], t: f32| [sums, [t, behind[0], behind[1], behind[2]]];
    check([Function {
        name: "resolve",
        modules: &["helpers::resolve", "helpers::guards"],
        parameters: "",
        driver,
        samples: vec![
            sample([0.5, 0.25, 0.125, 0.75], 0.4),
            sample([1e-8, 2e-8, 3e-8, 0.0], 0.4),
            sample([6e4, 3e4, 1e5, 1e5], 0.1),
            sample([0.0; 4], 1.0),
            [[0.3; 4], [1.0, 1.0, 1.0, 0.5]],
        ],
        want: &want,
        // Some roundings of values up to 1.
        tolerance: 1e-6,
        least: 1.0,
        unseen: &[
            (
                "1.17549435e-38",
                "return max(weights, 1.17549435e-38);",
                "the smallest normal number, of 32-bit sums: what is below it has lost its bits",
            ),
            (
                "1.0",
                "if transmittance == 1.0 {",
                "the formula beyond gives the same but for a rounding",
            ),
            (
                "1.0",
                "if all(transmittance == vec3f(1.0)) {",
                "as the one before",
            ),
            (
                "6.1035156e-5",
                "const WEIGHT_FLOOR: f32 = 6.1035156e-5;",
                "not of the resolve: shader_twins compares guards",
            ),
            ("16.0", "const FILL_MAX: f32 = 16.0;", "as the one before"),
            (
                "0.0009765625",
                "const EMISSIVE_ALPHA: f32 = 0.0009765625;",
                "as the one before",
            ),
        ],
    }
    .problem(&gpu)]);
}

/// Where Laguerre's iteration for the quartic begins, and terms of its step, in the order of the text.
const CONVERGES: &str = "the iteration comes to the same zero from there, or with that step";

/// See `CONVERGES`.
const ROOTS_UNSEEN: [Unseen<'_>; 16] = [
    ("1e-30", "let q = max(", NEVER),
    ("1e4", "return clamp(select(roots,", NEVER),
    ("1e4", "return clamp(select(roots,", NEVER),
    ("1.0", "let side =", CONVERGES),
    ("1.0", "let side =", CONVERGES),
    ("0.25", "var x = -0.25", CONVERGES),
    ("0.75", "var x = -0.25", CONVERGES),
    ("8.0", "var x = -0.25", CONVERGES),
    ("3.0", "var x = -0.25", CONVERGES),
    ("12.0", "let bend =", CONVERGES),
    ("6.0", "let bend =", CONVERGES),
    ("2.0", "let bend =", CONVERGES),
    ("9.0", "let root = sqrt(max(9.0", CONVERGES),
    ("12.0", "let root = sqrt(max(9.0", CONVERGES),
    ("4.0", "x -= 4.0", CONVERGES),
    (
        "1.0",
        "if abs(x) > 1.0 {",
        "both ways to divide hold near 1",
    ),
];

/// Zeros of polynomials are those that they were made of, also where the leading coefficient is the smallest of all.
#[test]
fn roots_have_no_number_that_does_not_matter() {
    let gpu = gpu();
    let driver = "
import package::methods::mboit_trig::roots::{cubic, quadratic, quartic};
fn ascending(x: vec4f) -> vec4f {
    var y = vec4f(min(x.xz, x.yw), max(x.xz, x.yw)).xzyw;
    y = vec4f(min(y.xy, y.zw), max(y.xy, y.zw));
    return vec4f(y.x, min(y.y, y.z), max(y.y, y.z), y.w);
}
fn values(p: vec4f, q: vec4f) -> array<f32, 8> {
    // Coefficients of (t - p.x) (t - p.y), then of one zero more each time.
    let two = vec3f(p.x * p.y, -p.x - p.y, 1.0);
    let three = vec4f(0.0, two) - p.z * vec4f(two, 0.0);
    let four = vec4f(0.0, three.xyz) - p.w * three;
    let a = quadratic(q.x * two);
    let b = cubic(q.x * three);
    let c = ascending(quartic(q.x * four, q.x));
    let d = ascending(vec4f(b, 1e5));
    return array<f32, 8>(min(a.x, a.y), d.x, d.y, d.z, c.x, c.y, c.z, c.w);
}";
    let mut random = Random::new(22, &[]);
    let samples = (0..400)
        .map(|_| {
            // Zeros of kernels are apart; some lie outside of the depths.
            let mut at = |from: f32| random.between(from, from + 0.3);
            let mut zeros = [at(-1.0), at(-0.5), at(0.0), at(0.5)];
            let far = [1.0, 2.0, 4.0][random.below(3)];
            zeros[random.below(4)] *= far;
            let zeros = random.permutation(4).into_iter().map(|i| zeros[i as usize]);
            let zeros: Vec<f32> = zeros.collect();
            [
                [zeros[0], zeros[1], zeros[2], zeros[3]],
                [random.between(0.5, 2.0), 0.0, 0.0, 0.0],
            ]
        })
        .collect();
    let want = |p: [f64; 4], _: [f64; 4]| {
        let ascending = |n: usize| {
            let mut zeros = p[..n].to_vec();
            zeros.sort_by(f64::total_cmp);
            zeros
        };
        let (three, four) = (ascending(3), ascending(4));
        [
            ascending(2)[0],
            three[0],
            three[1],
            three[2],
            four[0],
            four[1],
            four[2],
            four[3],
        ]
    };
    check([Function {
        name: "roots",
        modules: &["methods::mboit_trig::roots"],
        parameters: "",
        driver,
        samples,
        want: &want,
        // Cosines, which llvmpipe has to 1e-5, times the distance of the zeros.
        tolerance: 5e-4,
        least: 1.0,
        unseen: &ROOTS_UNSEEN,
    }
    .problem(&gpu)]);
}
