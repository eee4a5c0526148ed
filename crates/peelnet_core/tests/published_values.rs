//! Named constants against values that do not come from this code: definitions of formats, published numbers, and estimates of moments
//! computed apart.
//!
//! The estimates are of canonical representations in 60 decimal digits: the Hankel system solved by elimination, roots by bisection
//! between extrema, masses by a Vandermonde system, none of which this crate does.

use num_complex::Complex64;
use peelnet_core::{
    guards,
    methods::moments::{Moments, Settings, trigonometric},
    weights::Weight,
};
use std::f64::consts::PI;

/// Rounding in 64 bits, magnified by pivots of 1e-7 and by the square root of a double root.
const TOLERANCE: f64 = 1e-7;

/// Of each number of moments: the transmittance at −0.6, 0.3 and 0.9 times √bias from a lone layer of absorbance 2 at 0, with the paper's
/// settings; and at −0.7, 0.2 and 0.6 among three layers, with a bias of 0.25.
const ESTIMATES: [(Settings, f64, [f64; 3], [f64; 3]); 3] = [
    (
        Settings::FOUR,
        5e-7,
        [0.774_837_428_914, 0.453_698_369_412, 0.217_552_192_093],
        [0.887_102_105_669, 0.394_346_278_839, 0.252_094_318_325],
    ),
    (
        Settings::SIX,
        5e-6,
        [0.964_561_001_239, 0.193_188_868_520, 0.142_290_881_193],
        [0.879_220_114_503, 0.349_375_184_288, 0.227_123_448_770],
    ),
    (
        Settings::EIGHT,
        5e-5,
        [0.970_132_189_824, 0.184_070_385_394, 0.141_115_613_550],
        [0.831_671_403_061, 0.352_406_416_644, 0.228_637_958_245],
    ),
];

const THREE: [(f64, f64); 3] = [(0.7, -0.5), (0.9, 0.1), (0.4, 0.75)];

fn transmittance(layers: &[(f64, f64)], zeta: f64, settings: &Settings) -> f64 {
    let mut moments = Moments::new(settings.basis);
    for &(b, z) in layers {
        moments.add(b, z);
    }
    moments.transmittance(zeta, settings)
}

#[test]
fn estimates_are_those_computed_apart() {
    for (settings, bias, lone, among) in ESTIMATES {
        let beside = [-0.6, 0.3, 0.9].map(|t| t * bias.sqrt());
        let blurred = Settings {
            bias: 0.25,
            ..settings
        };
        for (settings, layers, zetas, wanted) in [
            (settings, &[(2.0, 0.0)][..], beside, lone),
            (blurred, &THREE, [-0.7, 0.2, 0.6], among),
        ] {
            for (zeta, want) in zetas.into_iter().zip(wanted) {
                let found = transmittance(layers, zeta, &settings);
                let is_near = (found - want).abs() < TOLERANCE;
                assert!(is_near, "{settings:?} at {zeta}: {found}");
            }
        }
    }
}

/// Less absorbance than 1e-4 counts as none.
#[test]
fn faint_pixels_have_no_estimate() {
    for (settings, ..) in ESTIMATES {
        let behind = |b: f64| transmittance(&[(b, -0.5)], 0.5, &settings);
        assert_eq!(behind(0.99e-4), 1.0);
        assert!(behind(1.01e-4) < 1.0 - 0.9e-4);
    }
}

/// One layer under trigonometric moments: with the uniform measure mixed in by the bias, what the bound's measure has at a depth is
/// `1 / v* T⁻¹ v` of a Toeplitz matrix of rank one plus a multiple of the identity (Sherman & Morrison 1950).
#[test]
fn trigonometric_moments_have_their_closed_form() {
    let angle = |zeta: f64| (zeta + 1.0) * (PI - 0.5 * 0.1 * PI);
    for count in 2..=trigonometric::MOST {
        let size = count as f64 + 1.0;
        for bias in [trigonometric::BIAS, trigonometric::BIAS_HALF] {
            for zeta in [0.001, 0.004, 0.02] {
                let with = |overestimation: f64| {
                    let settings = Settings {
                        overestimation,
                        bias,
                        ..Settings::trigonometric(count)
                    };
                    transmittance(&[(2.0, 0.0)], zeta, &settings).ln()
                };
                let own = (with(0.0) - with(1.0)) / 2.0;
                let turn = angle(zeta) - angle(0.0);
                let each = (0..=count).map(|k| Complex64::cis(k as f64 * turn));
                let left = 1.0 - bias;
                let share = left * each.sum::<Complex64>().norm_sqr() / (bias + left * size);
                let want = bias / (size - share);
                let is_near = (own / want - 1.0).abs() < 1e-6;
                assert!(is_near, "{count} {zeta}: {own} for {want}");
            }
        }
    }
}

/// Published weights at α = 1, by their formulas in 64 bits: at either clamp, next to it, and where the last term just counts.
#[test]
fn weights_are_those_published() {
    let weights = [Weight::Eq7, Weight::Eq8, Weight::Eq9, Weight::Papakostas];
    for (z, wanted) in [
        (0.05, [3000.0, 3000.0, 3000.0, 1.0]),
        (0.3, [2770.0831, 3000.0, 2_999.998_48, 1.0]),
        (1.5, [111.098_767, 2_954.209_75, 2_999.051_08, 1.0]),
        (5.0, [9.9999, 79.993_600_4, 2_887.218_05, 1.0]),
        (20.0, [0.624_999_57, 1.249_998_28, 272.727_273, 1.0]),
        (60.0, [0.069_444_088_1, 0.046_296_137_9, 3.699_136_87, 1.0]),
        (160.0, [0.01, 0.01, 0.073_240_399_4, 0.751_003_339]),
        (300.0, [0.01, 0.01, 0.01, 0.060_055_891]),
    ] {
        for (weight, want) in weights.into_iter().zip(wanted) {
            let found = f64::from(weight.eval(z, 1.0, 0.0));
            // A dozen roundings in 32 bits.
            let is_near = (found / want - 1.0).abs() < 2e-6;
            assert!(is_near, "{weight:?} at {z}: {found}");
        }
    }
}

/// Guards are ends of half and single floats, and half a step of a display.
#[test]
fn guards_are_ends_of_formats() {
    use half::f16;
    assert_eq!(guards::WEIGHT_FLOOR, f16::MIN_POSITIVE.to_f32());
    assert_eq!(guards::SUM_FLOOR, f16::MIN_POSITIVE_SUBNORMAL.to_f32());
    assert_eq!(guards::HALF_MAX, f16::MAX.to_f32());
    // The distance of half floats above 1, less than half a step of an 8-bit display.
    assert_eq!(guards::EMISSIVE_ALPHA, f16::EPSILON.to_f32());
    const { assert!(guards::EMISSIVE_ALPHA < 0.5 / 255.0) };
}
