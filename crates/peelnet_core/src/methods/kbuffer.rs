//! `kbuffer-k` and `hybrid-k`: the k nearest fragments exactly, the tail blended (Bavoil et al. 2007; Maule et al. 2013).

use crate::{fragment::Fragment, weights::Weight};

use super::{blended, over, stored::Colors, wboit};

/// Composites a pixel whose nearest fragments are stored as `colors` says. The tail is blended by eq 5 (`None`), or by eq 6 with a weight.
pub fn composite(
    fragments: &[Fragment],
    background: [f32; 3],
    k: usize,
    tail: Option<Weight>,
    colors: Colors,
) -> [f32; 3] {
    let sorted = over::sorted(fragments);
    let (front, rest) = sorted.split_at(k.min(sorted.len()));
    let behind = match tail {
        None => blended::composite(rest, background),
        Some(weight) => wboit::composite(rest, background, weight),
    };
    let front: Vec<Fragment> = front.iter().map(|f| colors.kept(f)).collect();
    over::composite(&front, behind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragment::worked_example;

    /// As many places as fragments: exact. None: the tail alone.
    #[test]
    fn it_spans_from_blending_to_exact() {
        let f = worked_example();
        let c0 = [0.1, 0.2, 0.9];
        let close = |a: [f32; 3], b: [f32; 3]| {
            for k in 0..3 {
                // Ten roundings of values ≤ 1.
                assert!((a[k] - b[k]).abs() < 1e-6, "{a:?} {b:?}");
            }
        };
        for tail in [None, Some(Weight::Eq9)] {
            close(
                composite(&f, c0, 9, tail, Colors::Full),
                over::composite(&f, c0),
            );
            // A tail of one fragment is exact as well.
            close(
                composite(&f, c0, f.len() - 1, tail, Colors::Full),
                over::composite(&f, c0),
            );
        }
        close(
            composite(&f, c0, 0, None, Colors::Full),
            blended::composite(&f, c0),
        );
    }
}
