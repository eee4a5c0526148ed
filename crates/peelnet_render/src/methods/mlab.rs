//! `mlab-K`: multi-layer alpha blending (Salvi & Vaidyanathan 2014), as its CPU twin `peelnet_core::methods::mlab` alone.

use super::{
    compositor::{Build, Compositor},
    method::{Method, Numbered, Promises},
    parameter::Precision,
};
use crate::error::RenderError;
use peelnet_core::methods::mlab;

const NO_ORDER: &str = "it needs ordered access to pixels, which WebGPU lacks";

pub(super) const METHOD: Method = Method {
    numbered: Some(Numbered {
        least: 1,
        most: 64,
        power_of_two: false,
    }),
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
        refuse,
    )
};

fn refuse(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    Err(RenderError::CpuOnly {
        method: b.spec.to_string(),
        why: NO_ORDER,
    })
}
