use crate::methods::{prelude::*, stored_colors};
use peelnet_core::methods::over;

pub(super) const METHOD: Expectations = Expectations {
    guarantees: |s| Guarantees {
        tinted: true,
        ..stored_colors::guarantees(s, Guarantees::EXACT)
    },
    known_failures: &[
        stored_colors::in_bytes(
            Property::Background,
            "alpha-tiny alpha-zero coplanar emissive far grazing intersecting isolated lines moving-camera opaque-mix \
             thin-slab two-layers wide-range",
        ),
        stored_colors::in_bytes(
            Property::Hull,
            "alpha-tiny coplanar deep emissive grazing intersecting moving-camera near-overflow",
        ),
        stored_colors::in_bytes(Property::Single, "emissive grazing"),
    ],
    reference: Some(|s, p| {
        let colors = stored_colors::colors(s);
        let stored: Vec<_> = p.fragments.iter().map(|f| colors.rounded(f)).collect();
        Some(over::composite(&stored, p.background))
    }),
    ..Expectations::DEFAULT
};
