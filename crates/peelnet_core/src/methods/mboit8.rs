//! `mboit8`: moment-based order-independent transparency with eight power moments (Münstermann, Krumpen, Klein & Peters,
//! 2018). As [`mboit6`](super::mboit6), with bounds that measures of five points meet. The shader twin is `methods/mboit8/`.

use super::{
    moments::{MomentSums, PowerMoments, Settings},
    roots,
};

/// The paper's settings for 32-bit moments.
pub const PAPER: Settings = Settings {
    overestimation: 0.25,
    bias: 5e-5,
    own_share_out: false,
};

/// The paper's bias for 16-bit moments.
pub const BIAS_HALF: f64 = 2.5e-3;

/// `b_0 … b_8` of a pixel.
pub type Moments = PowerMoments<9>;

/// Moments of a measure with more than four points, as in the paper's code.
const NEUTRAL: [f64; 8] = [0.0, 0.75, 0.0, 0.676_666_67, 0.0, 0.63, 0.0, 0.600_303_03];

impl MomentSums for Moments {
    fn add(&mut self, b: f64, zeta: f64) {
        self.add_powers(b, zeta);
    }

    fn transmittance(&self, zeta: f64, settings: &Settings) -> f64 {
        self.estimate(settings, |m| share_bounds(m, settings.bias, zeta))
    }
}

/// Factors L D of the Hankel matrix of a measure's moments.
struct Factors {
    lower: [[f64; 5]; 5],
    pivots: [f64; 5],
}

impl Factors {
    /// Of the moments `m_0 … m_8`.
    fn of(m: [f64; 9]) -> Self {
        let (mut lower, mut pivots) = ([[0.0; 5]; 5], [0.0; 5]);
        for j in 0..5 {
            let done: f64 = (0..j).map(|k| lower[j][k] * lower[j][k] * pivots[k]).sum();
            pivots[j] = m[2 * j] - done;
            for i in j + 1..5 {
                let done: f64 = (0..j).map(|k| lower[i][k] * lower[j][k] * pivots[k]).sum();
                lower[i][j] = (m[i + j] - done) / pivots[j];
            }
        }
        Self { lower, pivots }
    }

    /// The orthogonal polynomials of the measure at `t`.
    fn polynomials(&self, t: f64) -> [f64; 5] {
        let mut y = [1.0; 5];
        let mut power = 1.0;
        for i in 1..5 {
            power *= t;
            y[i] = power - (0..i).map(|k| self.lower[i][k] * y[k]).sum::<f64>();
        }
        y
    }

    /// What the extreme measure has at one of its points.
    fn mass(&self, t: f64) -> f64 {
        let squares = self.polynomials(t).into_iter().zip(self.pivots);
        squares.map(|(y, d)| y * y / d).sum::<f64>().recip()
    }
}

/// The least and the most of a measure on −1 … 1 that can lie in front of `zeta`, from its first eight moments over its zeroth.
pub fn share_bounds(moments: [f64; 8], bias: f64, zeta: f64) -> (f64, f64) {
    let mut m = [1.0; 9];
    for ((m, moment), neutral) in m[1..].iter_mut().zip(moments).zip(NEUTRAL) {
        *m = moment * (1.0 - bias) + neutral * bias;
    }
    let factors = Factors::of(m);
    // Coefficients of the kernel at ζ, whose zeros are the other four points.
    let mut c = factors.polynomials(zeta);
    for i in (0..5).rev() {
        let known: f64 = (i + 1..5).map(|k| factors.lower[k][i] * c[k]).sum();
        c[i] = c[i] / factors.pivots[i] - known;
    }
    // The polynomial of 1/t, where that keeps the zeros finite.
    let reversed = c[0].abs() > c[4].abs();
    if reversed {
        c.reverse();
    }
    let points = roots::quartic(c).map(|t| if reversed { t.recip() } else { t });
    let points = points.map(|t| t.clamp(-1e3, 1e3));
    let in_front = points.into_iter().filter(|&t| t < zeta);
    let low = in_front.map(|t| factors.mass(t)).sum();
    (low, low + factors.mass(zeta))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four layers: a measure of four points, which eight moments determine.
    #[test]
    fn four_layers_are_told_apart() {
        let mut m = Moments::default();
        for (b, zeta) in [(0.7, -0.8), (1.1, -0.1), (0.4, 0.3), (0.6, 0.8)] {
            m.add(b, zeta);
        }
        for (zeta, front) in [
            (-0.95, 0.0),
            (-0.45, 0.7),
            (0.1, 1.8),
            (0.55, 2.2),
            (0.95, 2.8),
        ] {
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
        assert!((t - f64::exp(-0.25 * 0.8)).abs() < 5e-3, "{t}");
        m.add(-0.8, 0.1);
        assert_eq!(m.transmittance(0.1, &PAPER), 1.0);
    }

    /// The share that lies in front is between the bounds.
    #[test]
    fn the_bounds_hold_the_truth() {
        for seed in 0..50 {
            let mut stream = crate::random::Random::new(seed, &[]);
            let mut random = move || f64::from(stream.unit());
            let mut m = Moments::default();
            let layers: Vec<_> = (0..12)
                .map(|_| (0.1 + 0.5 * random(), 1.8 * random() - 0.9))
                .collect();
            for &(b, zeta) in &layers {
                m.add(b, zeta);
            }
            let total = m.0[0];
            for i in 0..100 {
                let zeta = f64::from(i) / 50.0 - 1.0;
                let front: f64 = layers.iter().filter(|l| l.1 < zeta).map(|l| l.0).sum();
                let means = std::array::from_fn(|k| m.0[k + 1] / total);
                let (low, high) = share_bounds(means, PAPER.bias, zeta);
                let share = front / total;
                let slack = PAPER.bias;
                assert!(
                    low - slack < share && share < high + slack,
                    "{low} {share} {high}"
                );
            }
        }
    }
}
