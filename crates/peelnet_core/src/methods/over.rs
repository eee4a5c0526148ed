//! Ground truth: Porter & Duff's *over* (SIGGRAPH 1984), what `abuffer`, `depth-peel` and `dual-peel` compute.

use crate::fragment::{Fragment, sort_front_to_back};

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
    let back_to_front = sorted(fragments).into_iter().rev();
    back_to_front.fold(background.map(f64::from), |dst, f| {
        let a = f64::from(f.alpha);
        std::array::from_fn(|k| a * f64::from(f.color[k]) + (1.0 - a) * dst[k])
    })
}
