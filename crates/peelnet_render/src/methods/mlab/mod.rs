//! `mlab-K`: multi-layer alpha blending (Salvi & Vaidyanathan 2014), as its CPU reference alone.

mod expectations;
pub mod reference;

use crate::methods::prelude::*;

pub(super) const METHOD: Method = Method {
    numbered: Numbered::range(1, 64),
    cpu_only: Some("it needs ordered access to pixels, which WebGPU lacks"),
    curve: &["-4", "-2", "-8"],
    expectations: expectations::METHOD,
    ..Method::new(
        "mlab",
        "Salvi & Vaidyanathan 2014, K nodes merged in the order of drawing; bench computes its error on the CPU",
        |_| {},
    )
};
