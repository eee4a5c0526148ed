//! `mlab-K`: multi-layer alpha blending (Salvi & Vaidyanathan 2014), as its CPU twin `peelnet_core::methods::mlab` alone.

use super::prelude::*;
use peelnet_core::methods::mlab;

const NO_ORDER: &str = "it needs ordered access to pixels, which WebGPU lacks";

pub(super) const METHOD: Method = Method {
    numbered: Numbered::range(1, 64),
    cpu_only: Some(NO_ORDER),
    promises: |_| Promises {
        order_independent: false,
        sums: Precision::Full,
        statistics: Precision::Full,
        ..Promises::NORMALISED
    },
    curve: &["-4", "-2", "-8"],
    twin: Some(|s, p| {
        let nodes = s.number() as usize;
        Some(mlab::composite(p.fragments, p.background, nodes))
    }),
    ..Method::new(
        "mlab",
        "Salvi & Vaidyanathan 2014, K nodes merged in the order of drawing; bench computes its error on the CPU",
        |p| {
            let why = format!("cannot be drawn: {NO_ORDER}; bench measures its error");
            Err(RenderError::Refused(format!("{} {why}", p.b.spec)))
        },
    )
};
