//! `mboit4`: moment-based order-independent transparency with four power moments (Münstermann, Krumpen, Klein & Peters,
//! "Moment-Based Order-Independent Transparency", PACMCGIT 1(1), 2018). The shader twin is `methods/mboit4/`.
//!
//! Pass 1 sums absorbance `b_i` and its moments `b_k = Σ b_i ζ_i^k` over warped depth ζ. The moments do not determine where the
//! absorbance lies, but they bound how much of it can lie in front of a depth; the bound's ends are met by measures
//! of three points (the depth itself and two others), and the estimate lies between them.

use super::moments::{MomentSums, PowerMoments, Settings};
use num_traits::Float;

/// `b_0 … b_4` of a pixel.
pub type Moments = PowerMoments<5>;

impl MomentSums for Moments {
    fn add(&mut self, b: f64, zeta: f64) {
        self.add_powers(b, zeta);
    }

    fn transmittance(&self, zeta: f64, settings: &Settings) -> f64 {
        self.estimate(settings, |m| share_bounds(m, settings.bias, zeta))
    }
}

/// The least and the most of a measure on −1 … 1 that can lie in front of `zeta`, from its first four moments over its
/// zeroth: the share without and with all that the bound's measure has at `zeta` itself.
///
/// NaN where the points of that measure coincide.
pub fn share_bounds<F: Float>(moments: [F; 4], bias: F, zeta: F) -> (F, F) {
    let (zero, one) = (F::zero(), F::one());
    let half = one / (one + one);
    // A measure with these moments (0, ⅜, 0, ⅜) has more than two points, so that the matrix below is never singular.
    let neutral = F::from(0.375).unwrap_or(half);
    let m = [
        moments[0] * (one - bias),
        moments[1] * (one - bias) + neutral * bias,
        moments[2] * (one - bias),
        moments[3] * (one - bias) + neutral * bias,
    ];
    // Factors L D of the Hankel matrix [1 m1 m2; m1 m2 m3; m2 m3 m4], times their denominators.
    let variance = m[1] - m[0] * m[0];
    let l21 = m[2] - m[0] * m[1];
    let d = variance * (m[3] - m[1] * m[1]) - l21 * l21;
    let determinant = variance * d;
    // Coefficients of the kernel polynomial, times the determinant: H c = (1, ζ, ζ²). Its value at ζ is one over what the
    // measure has there (the Christoffel function), a sum of squares.
    let y1 = zeta - m[0];
    let y2 = (zeta * zeta - m[1]) * variance - l21 * y1;
    let c2 = y2 * variance;
    let c1 = y1 * d - l21 * y2;
    let c0 = determinant - m[0] * c1 - m[1] * c2;
    let own = determinant / (determinant + y1 * y1 * d + y2 * y2);
    // Its roots are the other two points of the measure: the smaller one, p, and one over the larger, q, so that a point at
    // infinity is none in particular, and neither is a difference of large numbers.
    let root = ((half * c1).powi(2) - c0 * c2).max(zero).sqrt();
    let inverse = -(half * c1 + if c1 >= zero { root } else { -root }).recip();
    let (p, q) = (c0 * inverse, c2 * inverse);
    // What lies at either, from the measure's zeroth and first moment.
    let at_p = (one - own - q * (m[0] - own * zeta)) / (one - p * q);
    let at_q = one - own - at_p;
    let in_front = |yes: bool, mass: F| if yes { mass } else { zero };
    let low = in_front(p < zeta, at_p) + in_front((one - zeta * q) * q < zero, at_q);
    (low, low + own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{absorbance::DepthWarp, fragment::Fragment, methods::moments::composite};

    /// Two layers: a measure of two points, which four moments determine, so the estimate is sharp away from them.
    #[test]
    fn two_layers_are_told_apart() {
        let mut m = Moments::default();
        m.add(0.7, -0.5);
        m.add(1.1, 0.6);
        for (zeta, front) in [(-0.9, 0.0), (0.0, 0.7), (0.9, 1.8)] {
            let t = m.transmittance(zeta, &Settings::PAPER);
            assert!((t - f64::exp(-front)).abs() < 2e-3, "{zeta}: {t}");
        }
    }

    /// At a layer itself the estimate counts the overestimated part of it: e^−0.25·b of a lone one; nothing with its own share out.
    #[test]
    fn a_lone_layer_counts_a_quarter_of_itself() {
        let mut m = Moments::default();
        m.add(0.8, 0.1);
        let t = m.transmittance(0.1, &Settings::PAPER);
        assert!((t - f64::exp(-0.25 * 0.8)).abs() < 1e-3, "{t}");
        m.add(-0.8, 0.1);
        assert_eq!(m.transmittance(0.1, &Settings::PAPER), 1.0);
    }

    /// A single surface comes out exact at 801 depths across the range, whatever its opacity, in both forms.
    #[test]
    fn a_single_surface_is_exact() {
        let warp = DepthWarp::new(0.1, 100.0);
        for own_share_out in [false, true] {
            let settings = Settings {
                own_share_out,
                ..Settings::PAPER
            };
            for i in 0..801 {
                let z = 0.1 * 1000f32.powf(i as f32 / 800.0);
                for alpha in [0.01, 0.5, 0.99] {
                    let f = [Fragment::new(z, alpha, [0.9, 0.1, 0.4])];
                    let got = composite(&f, [0.2; 3], &warp, Moments::default(), &settings);
                    let want = crate::methods::over::composite(&f, [0.2; 3]);
                    for k in 0..3 {
                        assert!(
                            (got[k] - want[k]).abs() < 1e-6,
                            "{z} {alpha}: {got:?} {want:?}"
                        );
                    }
                }
            }
        }
    }

    /// The estimate never leaves 0 … 1, and falls from the front to the back of a stack.
    #[test]
    fn it_stays_a_transmittance() {
        let mut m = Moments::default();
        for i in 0..40 {
            m.add(0.3, (f64::from(i) * 0.37).sin() * 0.8);
        }
        for i in 0..400 {
            let t = m.transmittance(-1.0 + f64::from(i) / 200.0, &Settings::PAPER);
            assert!((0.0..=1.0).contains(&t), "{t}");
        }
        // In front of, amid and behind all 40 layers, whose transmittance is e⁻¹².
        let [front, amid, behind] = [-1.0, 0.0, 1.0].map(|z| m.transmittance(z, &Settings::PAPER));
        assert!(front > amid && amid > behind, "{front} {amid} {behind}");
        assert!(behind >= f64::exp(-12.0) * 0.999 && behind < f64::exp(-12.0 * 0.75));
    }
}
