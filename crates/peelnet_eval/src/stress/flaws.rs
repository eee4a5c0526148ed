//! What is known to fail, with its reason and source. One that stops failing fails the run, so that the list stays true.

use super::properties::Property;

/// A flaw of some methods in some cases.
#[derive(Clone, Copy, Debug)]
pub struct Flaw {
    /// Methods with their knobs; one that ends in `*` stands for all that begin so.
    pub methods: &'static [&'static str],
    /// Names of the cases.
    pub cases: &'static [&'static str],
    /// The property that does not hold.
    pub property: Property,
    /// Why, and who says so.
    pub reason: &'static str,
}

/// All of them.
pub const FLAWS: &[Flaw] = &[
    Flaw {
        methods: &["weighted-sum:*"],
        cases: &[
            "alpha-zero",
            "alpha-tiny",
            "alpha-one",
            "alpha-near-one",
            "high-alpha",
            "deep",
            "near-overflow",
            "far",
            "wide-range",
            "coplanar",
            "thin-slab",
            "two-layers",
            "intersecting",
            "grazing",
            "emissive",
            "opaque-mix",
            "moving-camera",
            "passing",
        ],
        property: Property::Background,
        reason: "covers by the sum of opacities, which may exceed 1 (Meshkin 2007)",
    },
    Flaw {
        methods: &["weighted-sum:*"],
        cases: &[
            "alpha-one",
            "alpha-near-one",
            "high-alpha",
            "coplanar",
            "intersecting",
        ],
        property: Property::Dark,
        reason: "takes more of C_0 than there is where opacities add up to more than 1 (Meshkin 2007)",
    },
    Flaw {
        methods: &["weighted-average:*"],
        cases: &[
            "alpha-zero",
            "alpha-one",
            "coplanar",
            "emissive",
            "far",
            "grazing",
            "intersecting",
            "moving-camera",
            "passing",
        ],
        property: Property::Background,
        reason: "covers as layers of the mean opacity would, not as those that are there (Bavoil & Myers 2008)",
    },
    Flaw {
        methods: &["dual-peel"],
        cases: &["coplanar"],
        property: Property::Background,
        reason: "keeps one coincident fragment at either end and counts the rest as lost (Bavoil & Myers 2008)",
    },
    Flaw {
        methods: &["dual-peel"],
        cases: &["coplanar"],
        property: Property::Exact,
        reason: "keeps one coincident fragment at either end and counts the rest as lost (Bavoil & Myers 2008)",
    },
    Flaw {
        methods: &["dual-peel"],
        cases: &["coplanar"],
        property: Property::Hull,
        reason: "keeps one coincident fragment at either end and counts the rest as lost (Bavoil & Myers 2008)",
    },
    Flaw {
        methods: &["depth-peel", "dfaoit:*"],
        cases: &["coplanar"],
        property: Property::Order,
        reason: "coincident fragments are told apart by a depth test that keeps the first drawn, so that they must be drawn in the order of their numbers",
    },
    Flaw {
        methods: &["kbuffer-4:*", "hybrid-4:*"],
        cases: &["coplanar"],
        property: Property::Order,
        reason: "of more coincident fragments than places, those drawn first are kept",
    },
    Flaw {
        methods: &[
            "painter-object:targets=f16",
            "painter-triangle:targets=f16",
            "weighted-average:targets=f16",
            "blended:targets=f16",
            "wboit-eq7:targets=f16",
            "wboit-eq10:targets=f16",
            "kbuffer-4:targets=f16",
            "deep-thesis:targets=f16",
            "deep-medium:targets=f16",
            "deep-large",
            "deep-large:targets=f16",
        ],
        cases: &["alpha-tiny"],
        property: Property::Hull,
        reason: "half floats: a sum of hundreds of terms swallows what is small beside it",
    },
    Flaw {
        methods: &[
            "painter-object:targets=f16",
            "painter-triangle:targets=f16",
            "weighted-average:targets=f16",
            "blended:targets=f16",
            "wboit-eq7:targets=f16",
            "wboit-eq8:targets=f16",
            "wboit-eq10:targets=f16",
            "wboit-papakostas:targets=f16",
            "wboit-inverse-power:targets=f16",
            "mboit4",
            "mboit4:targets=f16",
            "mboit6:targets=f16",
            "wavelet-3",
            "kbuffer-4:targets=f16",
            "hybrid-4:targets=f16",
            "stochastic-16:targets=f16",
            "deep-thesis:targets=f16",
            "deep-small:targets=f16",
            "deep-medium:targets=f16",
            "deep-large",
            "deep-large:targets=f16",
        ],
        cases: &["deep"],
        property: Property::Hull,
        reason: "half floats: a sum of hundreds of terms swallows what is small beside it",
    },
    Flaw {
        methods: &[
            "painter-object:targets=f16",
            "painter-triangle:targets=f16",
            "weighted-average:targets=f16",
            "blended:targets=f16",
            "wboit-papakostas:targets=f16",
            "wboit-inverse-power:targets=f16",
            "mboit4",
            "mboit4:targets=f16",
            "stochastic-16:targets=f16",
            "deep-thesis:targets=f16",
            "deep-medium:targets=f16",
        ],
        cases: &["near-overflow"],
        property: Property::Hull,
        reason: "half floats: a sum of hundreds of terms swallows what is small beside it",
    },
    Flaw {
        methods: &["wboit-eq9:targets=f16"],
        cases: &["deep"],
        property: Property::Hull,
        reason: "half floats end at 65,504: after 22 layers of weight 3e3 nothing is left but the coverage (McGuire & Bavoil 2013)",
    },
    Flaw {
        methods: &[
            "wboit-eq7:targets=f16",
            "wboit-eq8:targets=f16",
            "wboit-eq9:targets=f16",
            "wboit-eq10:targets=f16",
            "hybrid-4:targets=f16",
        ],
        cases: &["near-overflow"],
        property: Property::Hull,
        reason: "half floats end at 65,504: after 22 layers of weight 3e3 nothing is left but the coverage (McGuire & Bavoil 2013)",
    },
    Flaw {
        methods: &["wboit-inverse-power:targets=f16"],
        cases: &["far"],
        property: Property::Hull,
        reason: "half floats end at 6e-8: weights of (z + 5)^-2 vanish from depth 4,000 on",
    },
    Flaw {
        methods: &["wboit-inverse-power:targets=f16"],
        cases: &["far"],
        property: Property::Dark,
        reason: "half floats end at 6e-8: weights of (z + 5)^-2 vanish from depth 4,000 on",
    },
    Flaw {
        methods: &["wboit-inverse-power:targets=f16"],
        cases: &["far"],
        property: Property::Single,
        reason: "half floats end at 6e-8: weights of (z + 5)^-2 vanish from depth 4,000 on",
    },
    Flaw {
        methods: &[
            "weighted-sum:*",
            "weighted-average:*",
            "blended:*",
            "wboit-eq7:*",
            "wboit-eq8:*",
            "wboit-eq9:*",
            "wboit-eq10:*",
            "wboit-papakostas:*",
            "wboit-inverse-power:*",
            "deep-thesis:*",
        ],
        cases: &["alpha-near-one"],
        property: Property::Opaque,
        reason: "a weight of depth alone, or of depth and sums, does not know what lies in front (McGuire & Bavoil 2013, section 5)",
    },
    Flaw {
        methods: &["mboit4*", "mboit6:targets=f16"],
        cases: &["alpha-near-one"],
        property: Property::Opaque,
        reason: "moments blur what lies close together (Münstermann et al. 2018)",
    },
    Flaw {
        methods: &["nmt*"],
        cases: &["alpha-near-one"],
        property: Property::Opaque,
        reason: "the network's own error; it reads the same moments (Tsopouridis et al. 2024)",
    },
    Flaw {
        methods: &["stochastic-16:*"],
        cases: &["alpha-near-one"],
        property: Property::Opaque,
        reason: "noise: one sample of sixteen weighs 0.06 (Enderton et al. 2010)",
    },
    Flaw {
        methods: &["deep-thesis:*"],
        cases: &[
            "alpha-near-one",
            "alpha-one",
            "coplanar",
            "far",
            "high-alpha",
            "intersecting",
            "moving-camera",
            "opaque-mix",
            "passing",
            "thin-slab",
            "two-layers",
            "wide-range",
        ],
        property: Property::Scale,
        reason: "reads depth in scene units (Papakostas 2022)",
    },
    Flaw {
        methods: &["deep-thesis:targets=f16"],
        cases: &["alpha-tiny", "deep"],
        property: Property::Scale,
        reason: "reads depth in scene units (Papakostas 2022)",
    },
    Flaw {
        methods: &["deep-small:targets=f16"],
        cases: &["high-alpha"],
        property: Property::Scale,
        reason: "depths are rounded otherwise, and a sum in half floats falls on the other side of a rounding (docs/learned-weights.md)",
    },
    Flaw {
        methods: &["painter-object:*"],
        cases: &["passing"],
        property: Property::Steady,
        reason: "objects swap whole (popping)",
    },
    Flaw {
        methods: &["mboit4:targets=f16", "mboit6:targets=f16"],
        cases: &["passing"],
        property: Property::Steady,
        reason: "16-bit moments without the paper's quantisation: roots jump where they come close",
    },
    Flaw {
        methods: &["mboit6:targets=f16"],
        cases: &["moving-camera"],
        property: Property::Steady,
        reason: "16-bit moments without the paper's quantisation: roots jump where they come close",
    },
    Flaw {
        methods: &["mboit4*", "mboit6*"],
        cases: &["isolated", "two-layers", "coplanar"],
        property: Property::Transmittance,
        reason: "a fragment's own absorbance counts for a quarter, as published (Münstermann et al. 2018); own=out leaves it out",
    },
    Flaw {
        methods: &["wavelet-3"],
        cases: &["two-layers"],
        property: Property::Transmittance,
        reason: "rank 3 tells apart eight depths (Aizenshtein et al. 2022)",
    },
    Flaw {
        methods: &["nmt*"],
        cases: &["isolated", "two-layers", "coplanar"],
        property: Property::Transmittance,
        reason: "the network's own error (Tsopouridis et al. 2024)",
    },
    Flaw {
        methods: &["deep-thesis:*"],
        cases: &["isolated", "two-layers", "coplanar"],
        property: Property::Transmittance,
        reason: "its output is a weight among others, not a transmittance that stands alone",
    },
    Flaw {
        methods: &["deep-small:*", "deep-large*"],
        cases: &["coplanar"],
        property: Property::Transmittance,
        reason: "the network's own error at a layer between sixteen coincident ones and the end: 0.010 and 0.007; where the sixteen stand before one, it is exact",
    },
    Flaw {
        methods: &["deep-thesis:*", "nmt*"],
        cases: &["half-float"],
        property: Property::Half,
        reason: "wide layers and inputs of scene units: roundings of the first layers add up to more than the last layer's own",
    },
];

/// The flaw that is declared of a method in a case.
pub fn declared(method: &str, case: &str, property: Property) -> Option<&'static Flaw> {
    FLAWS.iter().find(|flaw| {
        flaw.property == property
            && flaw.cases.contains(&case)
            && flaw.methods.iter().any(|m| {
                m.strip_suffix('*')
                    .map_or(*m == method, |start| method.starts_with(start))
            })
    })
}
