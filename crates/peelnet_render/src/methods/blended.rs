//! `blended`: the mean colour with the exact coverage (McGuire & Bavoil 2013, eq 5).

use super::{
    compositor::{Build, Compositor},
    method::{Method, Promises},
    parameter::TARGETS,
    weighted::{build_sums, gather},
};
use crate::{error::RenderError, flaw::Flaw};
use peelnet_core::methods::blended;

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS],
    promises: |_| Promises {
        tinted: true,
        ..Promises::NORMALISED
    },
    twin: Some(|_, p| Some(blended::composite(p.fragments, p.background))),
    flaws: &[
        Flaw::swallowed(&["alpha-tiny", "deep", "near-overflow"]),
        Flaw::BLIND,
    ],
    ..Method::new("blended", "McGuire & Bavoil 2013, eq 5", build)
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    build_sums(b, gather("methods::blended::gather", &[]))
}
