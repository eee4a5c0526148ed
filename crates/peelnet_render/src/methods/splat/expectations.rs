use crate::methods::prelude::*;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |_| Guarantees::TINTED,
    ..Expectations::DEFAULT
};
