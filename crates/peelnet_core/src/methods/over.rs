//! Ground truth: Porter & Duff's *over* (SIGGRAPH 1984), what `abuffer`, `depth-peel` and `dual-peel` compute.

use crate::fragment::{Fragment, sort_front_to_back};

/// The fragments, nearest first.
pub fn sorted(fragments: &[Fragment]) -> Vec<Fragment> {
    let mut sorted = fragments.to_vec();
    sort_front_to_back(&mut sorted);
    sorted
}

/// Sorts a copy and composites front to back (under-blending): `C += T·α·c; T *= 1 − α`.
pub fn composite(fragments: &[Fragment], background: [f32; 3]) -> [f32; 3] {
    let (mut color, mut t) = ([0.0f32; 3], 1.0f32);
    for f in &sorted(fragments) {
        for (acc, c) in color.iter_mut().zip(f.premultiplied()) {
            *acc += t * c;
        }
        t *= 1.0 - f.alpha;
    }
    std::array::from_fn(|k| color[k] + t * background[k])
}

/// The same in 64 bits, back to front (over-blending): independent of [`composite`] in order and precision.
pub fn composite_f64(fragments: &[Fragment], background: [f32; 3]) -> [f64; 3] {
    sorted(fragments)
        .iter()
        .rev()
        .fold(background.map(f64::from), |dst, f| {
            let a = f64::from(f.alpha);
            std::array::from_fn(|k| a * f64::from(f.color[k]) + (1.0 - a) * dst[k])
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tolerance;
    use proptest::prelude::*;

    fn any_fragment() -> impl Strategy<Value = Fragment> {
        (
            0.01f32..100.0,
            0.0f32..=1.0,
            prop::array::uniform3(0.0f32..=1.0),
        )
            .prop_map(|(z, a, c)| Fragment::new(z, a, c))
    }

    /// What opacity means as coverage of a pixel (McGuire & Bavoil 2013, figure 2): two layers that each cover half of it, at random with
    /// respect to one another, let a quarter of the light through, as compositing says. Layers whose holes coincide let half of it
    /// through, layers whose holes are covered by one another none: the correlation is lost in α, for every method alike.
    #[test]
    fn compositing_is_right_for_layers_without_correlation() {
        const SIDE: u32 = 16;
        let seen = |covers: [fn(u32, u32) -> bool; 2]| {
            let samples = (0..SIDE * SIDE).map(|k| {
                let fragments = [0, 1].map(|i| {
                    let alpha = f32::from(u8::from(covers[i](k % SIDE, k / SIDE)));
                    Fragment::new(1.0 + i as f32, alpha, [0.0; 3])
                });
                composite(&fragments, [1.0; 3])[0]
            });
            samples.sum::<f32>() / (SIDE * SIDE) as f32
        };
        let half = [1.0, 2.0].map(|z| Fragment::new(z, 0.5, [0.0; 3]));
        assert_eq!(composite(&half, [1.0; 3]), [0.25; 3]);
        assert_eq!(seen([|x, _| x % 2 == 0, |_, y| y % 2 == 0]), 0.25);
        assert_eq!(seen([|x, _| x % 2 == 0, |x, _| x % 2 == 0]), 0.5);
        assert_eq!(seen([|x, _| x % 2 == 0, |x, _| x % 2 == 1]), 0.0);
    }

    proptest! {
        #[test]
        fn under_and_over_agree(f in prop::collection::vec(any_fragment(), 0..512), c0 in prop::array::uniform3(0.0f32..=1.0)) {
            let (under, over) = (composite(&f, c0), composite_f64(&f, c0));
            for k in 0..3 {
                prop_assert!((f64::from(under[k]) - over[k]).abs() <= tolerance::composite(f.len(), 1.0));
            }
        }

        #[test]
        fn the_result_lies_in_the_hull(f in prop::collection::vec(any_fragment(), 1..64)) {
            let c = composite_f64(&f, [0.5; 3]);
            for (k, c) in c.into_iter().enumerate() {
                let lo = f.iter().map(|f| f.color[k]).fold(0.5, f32::min);
                let hi = f.iter().map(|f| f.color[k]).fold(0.5, f32::max);
                prop_assert!(c >= f64::from(lo) - 1e-12 && c <= f64::from(hi) + 1e-12);
            }
        }
    }
}
