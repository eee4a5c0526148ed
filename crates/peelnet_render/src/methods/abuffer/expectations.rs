use crate::methods::prelude::*;
use peelnet_core::methods::over;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees {
        tinted: true,
        ..Guarantees::EXACT
    },
    reference: Some(|_, p| Some(over::composite(p.fragments, p.background))),
    ..Expectations::DEFAULT
};
