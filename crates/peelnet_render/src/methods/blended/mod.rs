//! `blended`: the mean colour with the exact coverage (McGuire & Bavoil 2013, eq 5). One geometry pass.

mod expectations;
pub mod reference;

use super::{prelude::*, wboit::sums};

pub(super) const METHOD: Method = Method {
    parameters: &[TARGETS],
    expectations: expectations::METHOD,
    ..Method::new("blended", "McGuire & Bavoil 2013, eq 5", |p| {
        sums(p, "methods::blended::gather", &[], []);
    })
};
