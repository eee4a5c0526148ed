//! Published weights of weighted blended transparency; the shader twin is `helpers/weights.wgsl`.
//!
//! Equation numbers are those of McGuire & Bavoil, "Weighted Blended Order-Independent Transparency", JCGT 2(2),
//! 2013. Powers are repeated products, as the shaders compute them.

/// A named weight `w(z, α)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weight {
    /// Eq 7.
    Eq7,
    /// Eq 8.
    Eq8,
    /// Eq 9.
    Eq9,
    /// Eq 10, on window depth; the factor is 3e3 in the paper and 3e4 in one translation of it.
    Eq10 {
        /// Largest weight.
        factor: f32,
    },
    /// `(z + ε)^−k`.
    InversePower {
        /// Exponent, a whole number so that it is a repeated product.
        k: u32,
        /// Offset in scene units.
        epsilon: f32,
    },
    /// The variant in the shader of Papakostas' thesis (Ioannina 2022).
    Papakostas,
}

impl Weight {
    /// Every named weight with its defaults, in the order in which reports list them.
    pub const ALL: [Self; 6] = [
        Self::Eq7,
        Self::Eq8,
        Self::Eq9,
        Self::Eq10 { factor: 3e3 },
        Self::InversePower { k: 2, epsilon: 5.0 },
        Self::Papakostas,
    ];

    /// The weight's name in method names: `wboit-<name>`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Eq7 => "eq7",
            Self::Eq8 => "eq8",
            Self::Eq9 => "eq9",
            Self::Eq10 { .. } => "eq10",
            Self::InversePower { .. } => "inverse-power",
            Self::Papakostas => "papakostas",
        }
    }

    /// The weight of a fragment.
    ///
    /// `z` is linear depth in scene units, `alpha` opacity, `window_depth` 0 … 1.
    ///
    /// ```
    /// # use peelnet_core::weights::Weight;
    /// // Near the camera eq 9 is capped at α · 3e3.
    /// assert_eq!(Weight::Eq9.eval(0.1, 0.5, 0.0), 1500.0);
    /// ```
    pub fn eval(self, z: f32, alpha: f32, window_depth: f32) -> f32 {
        match self {
            Self::Eq7 => {
                let (a, b) = (z / 5.0, z / 200.0);
                alpha * (10.0 / (1e-5 + a * a + b * b * b * b * b * b)).clamp(1e-2, 3e3)
            }
            Self::Eq8 => {
                let (a, b) = (z / 10.0, z / 200.0);
                alpha * (10.0 / (1e-5 + a * a * a + b * b * b * b * b * b)).clamp(1e-2, 3e3)
            }
            Self::Eq9 => {
                let a = z / 200.0;
                alpha * (0.03 / (1e-5 + a * a * a * a)).clamp(1e-2, 3e3)
            }
            Self::Eq10 { factor } => {
                let a = 1.0 - window_depth;
                alpha * (factor * a * a * a).max(1e-2)
            }
            Self::InversePower { k, epsilon } => {
                let mut w = 1.0;
                for _ in 0..k {
                    w /= z + epsilon;
                }
                w
            }
            Self::Papakostas => {
                let a = (1.0 - z) / 200.0;
                alpha * (0.3 / (1e-5 + a * a * a * a)).min(8.0).clamp(1e-2, 1.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values worked out by hand: at z = 200 eq 9 is 0.03/(1e−5 + 1), at z = 10 eq 8 is 10/(1e−5 + 1 + 1.5625e−8).
    #[test]
    fn closed_forms() {
        let close = |a: f32, b: f64| assert!((f64::from(a) / b - 1.0).abs() < 1e-6, "{a} {b}");
        close(Weight::Eq9.eval(200.0, 1.0, 0.0), 0.03 / 1.00001);
        close(
            Weight::Eq8.eval(10.0, 0.5, 0.0),
            0.5 * 10.0 / (1.00001 + 1.5625e-8),
        );
        close(
            Weight::Eq7.eval(5.0, 1.0, 0.0),
            10.0 / (1.00001 + 2.441_406_25e-10),
        );
        close(Weight::Eq10 { factor: 3e3 }.eval(0.0, 1.0, 0.5), 375.0);
        close(
            Weight::InversePower { k: 2, epsilon: 5.0 }.eval(5.0, 0.3, 0.0),
            0.01,
        );
        // (1 − z)/200 = −1 at z = 201: 0.3/1.00001, between its clamps.
        close(Weight::Papakostas.eval(201.0, 1.0, 0.0), 0.3 / 1.00001);
        close(Weight::Papakostas.eval(1.0, 0.5, 0.0), 0.5);
    }

    #[test]
    fn clamps_hold_at_the_ends() {
        for w in [Weight::Eq7, Weight::Eq8, Weight::Eq9] {
            assert_eq!(w.eval(0.0, 1.0, 0.0), 3e3);
            assert_eq!(w.eval(1e6, 1.0, 0.0), 1e-2);
        }
    }
}
