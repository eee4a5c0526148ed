//! `kbuffer-k` and `hybrid-k`: the k nearest fragments exactly, the tail blended (Bavoil et al. 2007; Maule et al. 2013).

use peelnet_core::{fragment::Fragment, weights::Weight};

use crate::methods::{blended::reference as blended, stored_colors::Colors};
use peelnet_core::methods::{over, wboit};

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
    let front: Vec<Fragment> = front.iter().map(|f| colors.rounded(f)).collect();
    over::composite(&front, behind)
}
