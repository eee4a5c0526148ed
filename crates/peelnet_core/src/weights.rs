//! Published weights of weighted blended transparency; the shader is `helpers/weights.wgsl`.
//!
//! Equation numbers are those of McGuire & Bavoil, "Weighted Blended Order-Independent Transparency", JCGT 2(2),
//! 2013. Powers are repeated products, as the shaders compute them.

/// A named weight `w(z, α)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weight {
    Eq7,
    Eq8,
    Eq9,
    /// Eq 10, on window depth; the factor is 3e3 in the paper and 3e4 in one translation of it.
    Eq10 {
        factor: f32,
    },
    /// `(z + ε)^−k`.
    InversePower {
        /// Exponent, a whole number so that it is a repeated product.
        k: u32,
        /// Offset in scene units.
        epsilon: f32,
    },
    /// `10 / (1 + 10 (z k)⁵)`, which the paper uses for smoke.
    Smoke {
        /// The inverse of the depth, in scene units, around which the weight falls.
        k: f32,
    },
    /// The variant in the shader of Papakostas' thesis (Ioannina 2022).
    Papakostas,
}

impl Weight {
    /// Every named weight with its defaults, in the order in which reports list them.
    pub const ALL: [Self; 7] = [
        Self::Eq7,
        Self::Eq8,
        Self::Eq9,
        Self::Eq10 { factor: 3e3 },
        Self::InversePower { k: 2, epsilon: 5.0 },
        Self::Smoke { k: 0.1 },
        Self::Papakostas,
    ];

    /// `z` is linear depth in scene units, `alpha` opacity, `window_depth` 0 … 1.
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
            Self::Smoke { k } => {
                let a = z * k;
                10.0 / (1.0 + 10.0 * (a * a * a * a * a))
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

    /// Values worked out by hand, where published_values.rs has none.
    #[test]
    fn closed_forms() {
        let power = |k, epsilon| Weight::InversePower { k, epsilon };
        for (weight, z, alpha, window, want) in [
            (Weight::Eq10 { factor: 3e3 }, 0.0, 1.0, 0.5, 375.0),
            (Weight::Eq10 { factor: 3e4 }, 0.0, 0.5, 0.5, 1875.0),
            // At their ends, times α.
            (Weight::Eq7, 160.0, 0.5, 0.0, 0.005),
            (Weight::Eq8, 160.0, 0.5, 0.0, 0.005),
            (Weight::Eq9, 0.05, 0.5, 0.0, 1500.0),
            // Exactly α up to 200·(0.3 − 1e−5)^¼ + 1 = 149.01, then less: 0.3 / (1e−5 + (148.1 / 200)⁴).
            (Weight::Papakostas, 149.0, 0.5, 0.0, 0.5),
            (Weight::Papakostas, 149.1, 0.5, 0.0, 0.498_857_57),
            (power(2, 5.0), 5.0, 0.3, 0.0, 0.01),
            (power(4, 0.0), 2.0, 0.3, 0.0, 1.0 / 16.0),
            // z k = 1/2: 10 / (1 + 10/32).
            (Weight::Smoke { k: 0.1 }, 5.0, 0.3, 0.0, 320.0 / 42.0),
        ] {
            let found = f64::from(weight.eval(z, alpha, window));
            let is_near = (found / want - 1.0).abs() < 1e-6;
            assert!(is_near, "{weight:?}: {found} {want}");
        }
    }
}
