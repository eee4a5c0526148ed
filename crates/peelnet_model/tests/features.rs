//! Features of the rest of a pixel in closed form: every constant of theirs, a tenth larger, moves a value here by more than a rounding.

use peelnet_core::{methods::anchored::Residual, statistics::Statistics};
use peelnet_model::inputs::{ANCHORED, values};

const TOLERANCE: f64 = 1e-9;

fn near(found: f64, want: f64) {
    assert!((found - want).abs() < TOLERANCE, "{found} for {want}");
}

fn moments(layers: &[(f64, f64)]) -> [f64; 5] {
    std::array::from_fn(|k| layers.iter().map(|&(b, z)| b * z.powi(k as i32)).sum())
}

/// A rest seen from `zeta`, in a pixel of this much absorbance and this range.
fn residual(layers: &[(f64, f64)], zeta: f64, absorbance: f64, range: [f64; 2]) -> Residual {
    let s = Statistics {
        moments: [absorbance, 0.0, 0.0, 0.0, 0.0],
        nearest: range[0],
        farthest: range[1],
    };
    Residual::new(&s, &moments(layers), zeta)
}

/// Two layers of a range one wide, in the middle of the frame's and beside it: 1 at −½ and 3 at ½ of the pixel's range.
#[test]
fn two_layers() {
    for shift in [0.0, 0.25, -0.4] {
        let layers = [(1.0, shift - 0.25), (3.0, shift + 0.25)];
        let rest = residual(&layers, shift + 0.1, 9.0, [shift - 0.5, shift + 0.5]);
        let found = values(&ANCHORED[..3], &rest).into_iter().chain(rest.means);
        // Mean powers of −½ once and ½ three times.
        let wanted = [2.0, 0.6, 0.625, 0.25, 0.25, 0.0625, 0.0625];
        for (found, want) in found.zip(wanted) {
            near(found, want);
        }
    }
}

/// Less than a 1,024th of the pixel's absorbance, or than 1e-6, counts as that much.
#[test]
fn little_is_noise() {
    for (b, absorbance, mean) in [(5e-4, 1.024, 0.6), (5e-7, 1e-5, 0.6), (2e-3, 1.024, 0.7)] {
        let rest = residual(&[(b, 0.4)], 0.0, absorbance, [-1.0, 1.0]);
        near(values(&ANCHORED, &rest)[2], mean);
    }
}

/// What the bound's measure has at `x` where all lies at 0: the Christoffel function of `(1 − ε) δ_0 + ε` times moments 0, ⅜, 0, ⅜, by hand.
fn own(x: f64, bias: f64) -> f64 {
    let (v, w) = (0.375 * bias, 0.375 * bias);
    1.0 / (1.0 + x * x / v + (x * x - v).powi(2) / (w - v * v))
}

/// The bias of the bounds: 2^-10, 2^-16 for the fourth power of how much narrower than the frame's a pixel's range is, a quarter at most.
#[test]
fn narrow_pixels_have_more_bias() {
    for (half_range, bias) in [
        (1.0, 1.0 / 1024.0 + 1.0 / 65_536.0),
        (0.25, 1.0 / 1024.0 + 256.0 / 65_536.0),
        (0.0625, 0.25),
    ] {
        let (x, range) = (0.02, [-half_range, half_range]);
        let rest = residual(&[(1.0, 0.0)], x * half_range, 2.0, range);
        let [low, high] = rest.moment_bounds();
        near(high - low, own(x, bias));
    }
}

/// Mean powers of a pixel whose fragments are a rounding apart end at 65,536, and places at its ends.
#[test]
fn powers_are_finite() {
    let rest = residual(&[(1.0, 0.9)], 1.0, 2.0, [0.0, 1e-9]);
    assert_eq!(rest.means, [1.0, 65_536.0, 65_536.0, 65_536.0]);
    assert_eq!(rest.place, 1.0);
}
