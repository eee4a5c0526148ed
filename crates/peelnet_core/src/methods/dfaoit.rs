//! `dfaoit`: the two nearest fragments exactly, the colour of the rest from a network (Tsopouridis, Vasilakos & Fudos 2024).

use super::over;
use crate::{absorbance::absorbance, fragment::Fragment};

/// Fragments that are composited exactly.
pub const FRONT: usize = 2;

/// Composites a pixel. The network reads premultiplied colour and transmittance of the two nearest, mean colour, mean opacity and
/// transmittance of the rest, and their number; it predicts the colour of the rest.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    network: impl FnOnce([f32; 10]) -> [f32; 3],
) -> [f32; 3] {
    let sorted = over::sorted(fragments);
    let (front, tail) = sorted.split_at(sorted.len().min(FRONT));
    if tail.is_empty() {
        return over::composite(front, background);
    }
    let near = over::composite(front, [0.0; 3]);
    let near_transmittance: f32 = front.iter().map(|f| 1.0 - f.alpha).product();
    let n = tail.len() as f32;
    let alpha: f32 = tail.iter().map(|f| f.alpha).sum();
    let total: f64 = tail.iter().map(|f| absorbance(f.alpha)).sum();
    let transmittance = (-total).exp() as f32;
    let mean: [f32; 3] = std::array::from_fn(|k| {
        let sum: f32 = tail.iter().map(|f| f.premultiplied()[k]).sum();
        sum / alpha.max(1e-6)
    });
    // A tail of one fragment is its colour.
    let color = if tail.len() == 1 {
        mean
    } else {
        let [r, g, b] = near;
        let [mr, mg, mb] = mean;
        let (t, mean_alpha) = (near_transmittance, alpha / n);
        network([r, g, b, t, mr, mg, mb, mean_alpha, transmittance, n])
    };
    std::array::from_fn(|k| {
        let behind = color[k] * (1.0 - transmittance) + background[k] * transmittance;
        near[k] + near_transmittance * behind
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragment::worked_example;

    /// Up to three layers are exact whatever the network predicts, and what it predicts is what lies behind two.
    #[test]
    fn few_layers_are_exact() {
        let f = worked_example();
        let c0 = [0.1, 0.2, 0.9];
        for n in 0..=3 {
            let (got, want) = (
                composite(&f[..n], c0, |_| [9.0; 3]),
                over::composite(&f[..n], c0),
            );
            for k in 0..3 {
                assert!((got[k] - want[k]).abs() < 1e-6, "{n}: {got:?} {want:?}");
            }
        }
        let mut seen = 0.0;
        composite(&f, c0, |inputs| {
            seen = inputs[9];
            [0.0; 3]
        });
        assert_eq!(seen, 2.0);
    }
}
