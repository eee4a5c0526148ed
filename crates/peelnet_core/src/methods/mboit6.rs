//! `mboit6`: moment-based order-independent transparency with six power moments (Münstermann, Krumpen, Klein & Peters,
//! 2018). As [`mboit4`](super::mboit4), with bounds that measures of four points meet. The shader twin is `methods/mboit6/`.

use super::{
    moments::{MomentSums, PowerMoments, Settings},
    roots,
};

/// The paper's settings for 32-bit moments.
pub const PAPER: Settings = Settings {
    overestimation: 0.25,
    bias: 5e-6,
    own_share_out: false,
};

/// `b_0 … b_6` of a pixel.
pub type Moments = PowerMoments<7>;

impl MomentSums for Moments {
    fn add(&mut self, b: f64, zeta: f64) {
        self.add_powers(b, zeta);
    }

    fn transmittance(&self, zeta: f64, settings: &Settings) -> f64 {
        self.estimate(settings, |m| share_bounds(m, settings.bias, zeta))
    }
}

/// The least and the most of a measure on −1 … 1 that can lie in front of `zeta`, from its first six moments over its
/// zeroth.
fn share_bounds(moments: [f64; 6], bias: f64, zeta: f64) -> (f64, f64) {
    // Moments of a measure with more than three points, so that the matrix below is never singular.
    let neutral = [0.0, 0.48, 0.0, 0.451, 0.0, 0.45];
    let m: [f64; 6] = std::array::from_fn(|k| moments[k] * (1.0 - bias) + neutral[k] * bias);
    // L D Lᵀ of the Hankel matrix of 1, m1 … m6.
    let d2 = m[1] - m[0] * m[0];
    let l32 = (m[2] - m[0] * m[1]) / d2;
    let l42 = (m[3] - m[0] * m[2]) / d2;
    let d3 = m[3] - m[1] * m[1] - l32 * l32 * d2;
    let l43 = (m[4] - m[1] * m[2] - l32 * l42 * d2) / d3;
    let d4 = m[5] - m[2] * m[2] - l42 * l42 * d2 - l43 * l43 * d3;
    // (1, t, t², t³) through L.
    let residuals = |t: f64| {
        let y2 = t - m[0];
        let y3 = t * t - m[1] - l32 * y2;
        [y2, y3, t * t * t - m[2] - l42 * y2 - l43 * y3]
    };
    // What the extreme measure has at one of its points: one over the kernel there (the Christoffel function).
    let mass = |t: f64| {
        let y = residuals(t);
        (1.0 + y[0] * y[0] / d2 + y[1] * y[1] / d3 + y[2] * y[2] / d4).recip()
    };
    // Coefficients of the kernel polynomial of ζ, whose roots are the other three points.
    let y = residuals(zeta);
    let c3 = y[2] / d4;
    let c2 = y[1] / d3 - l43 * c3;
    let c1 = y[0] / d2 - l32 * c2 - l42 * c3;
    let c0 = 1.0 - m[0] * c1 - m[1] * c2 - m[2] * c3;
    let low = roots::cubic([c0, c1, c2, c3])
        .into_iter()
        .filter(|&t| t < zeta)
        .map(mass)
        .sum();
    (low, low + mass(zeta))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three layers: a measure of three points, which six moments determine.
    #[test]
    fn three_layers_are_told_apart() {
        let mut m = Moments::default();
        for (b, zeta) in [(0.7, -0.6), (1.1, 0.1), (0.4, 0.7)] {
            m.add(b, zeta);
        }
        for (zeta, front) in [(-0.95, 0.0), (-0.25, 0.7), (0.45, 1.8), (0.95, 2.2)] {
            let t = m.transmittance(zeta, &PAPER);
            assert!((t - f64::exp(-front)).abs() < 2e-2, "{zeta}: {t}");
        }
    }

    /// A lone layer counts the overestimated part of itself, nothing with its own share out.
    #[test]
    fn a_lone_layer_counts_a_quarter_of_itself() {
        let mut m = Moments::default();
        m.add(0.8, 0.1);
        let t = m.transmittance(0.1, &PAPER);
        assert!((t - f64::exp(-0.25 * 0.8)).abs() < 2e-3, "{t}");
        m.add(-0.8, 0.1);
        assert_eq!(m.transmittance(0.1, &PAPER), 1.0);
    }

    /// The estimate is a transmittance, and no farther from the truth than that of four moments, over random stacks.
    #[test]
    fn more_moments_are_nearer() {
        let mut errors = [0.0; 2];
        for seed in 0..50 {
            let mut stream = crate::random::Random::new(seed, &[]);
            let mut random = move || f64::from(stream.unit());
            let layers: Vec<_> = (0..8)
                .map(|_| (0.1 + 0.5 * random(), 1.8 * random() - 0.9))
                .collect();
            let (mut six, mut four) =
                (Moments::default(), super::super::mboit4::Moments::default());
            for &(b, zeta) in &layers {
                six.add(b, zeta);
                four.add(b, zeta);
            }
            for i in 0..100 {
                let zeta = f64::from(i) / 50.0 - 1.0;
                let front: f64 = layers.iter().filter(|l| l.1 < zeta).map(|l| l.0).sum();
                let settings = Settings {
                    overestimation: 0.5,
                    ..PAPER
                };
                let t = six.transmittance(zeta, &settings);
                assert!((0.0..=1.0).contains(&t), "{t}");
                let of_four = four.transmittance(zeta, &settings);
                errors[0] += (t - (-front).exp()).abs();
                errors[1] += (of_four - (-front).exp()).abs();
            }
        }
        assert!(errors[0] < errors[1], "{errors:?}");
    }
}
