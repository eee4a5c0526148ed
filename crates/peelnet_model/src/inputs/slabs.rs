//! `deep-small`, `deep-medium`, `deep-large`: what lies between the known ends of a fragment's slab. Whole pixels are examples. All
//! features are free of scale and unit.

use super::{feature::*, network_inputs::*, surroundings::*};
use peelnet_core::{
    fragment::Fragment,
    methods::{
        known::KnownFragment,
        slabs::{self, Design, Extent, Interior, Layout, Slabs, points},
    },
};

/// Keeps a share of two absorbances that are both 0 finite.
const FLOOR: f64 = 1e-6;

const OF_DEPTH: &str = "of the way between the slab's ends";

const OF_ABSORBANCE: &str = "of the absorbance between the slab's ends";

const ROOT_OWN: &str = "root of the fragment's absorbance";

const IN_SLABS: &str = "half of the way between the slab's ends, in slabs";

/// How much lies between a slab's ends, where the fragment lies, what is known of the share in front, how far apart the ends are, and how
/// the absorbances compare.
pub static NINE: [&Feature<Interior>; 9] = [
    &Feature::new(
        "root_absorbance",
        "root of the absorbance between the slab's ends",
        "sqrt(between.absorbance)",
        |between| between.absorbance.sqrt(),
    ),
    &Feature::new("place_fraction", OF_DEPTH, "between.place", |b| b.place),
    &Feature::new("mean_fraction", OF_DEPTH, "between.mean", |b| b.mean),
    &Feature::new("share_low", OF_ABSORBANCE, "between.low", |b| b.bounds[0]),
    &Feature::new("share_high", OF_ABSORBANCE, "between.high", |b| b.bounds[1]),
    &Feature::new("root_own", ROOT_OWN, "sqrt(between.own)", |b| b.own.sqrt()),
    &Feature::new("half_extent", IN_SLABS, "between.extent", |b| b.extent),
    &Feature::new(
        "of_own",
        "absorbance between the ends, of that and the fragment's",
        "between.absorbance / (between.absorbance + between.own + 1e-6)",
        |between| between.absorbance / (between.absorbance + between.own + FLOOR),
    ),
    &Feature::new(
        "of_nearest",
        "absorbance between the ends, of that and the nearer end's",
        "between.absorbance / (between.absorbance + between.nearest + 1e-6)",
        |between| between.absorbance / (between.absorbance + between.nearest + FLOOR),
    ),
];

/// The first five of them.
pub static FIVE: [&Feature<Interior>; 5] = [NINE[0], NINE[1], NINE[2], NINE[3], NINE[4]];

/// What lies between the ends of a slab. The first feature must be the root of its absorbance, the fourth and fifth the bounds of the
/// share in front.
#[derive(Debug)]
pub struct SlabInputs {
    /// What is kept of a pixel.
    pub design: Design,
    /// The features, in order.
    pub features: &'static [&'static Feature<Interior>],
}

impl SlabInputs {
    /// # Panics
    /// For a design that has no shaders.
    fn layout(&self) -> Layout {
        let layout = self.design.layout();
        layout.expect("recipes that are exported keep what a layout holds")
    }

    /// The design, among the quantiles around a pixel.
    fn around(&self, pixel: &Observed<'_>) -> Design {
        match self.design.extent {
            Extent::Among(_) => Design {
                extent: Extent::Among(pixel.around.quantiles),
                ..self.design
            },
            _ => self.design,
        }
    }
}

impl NetworkInputs for SlabInputs {
    fn features(&self) -> Vec<&'static About> {
        about(self.features)
    }

    fn surroundings(&self) -> &'static Surroundings {
        slab_surroundings(self.layout())
    }

    fn known(&self, pixel: &Observed<'_>) -> Vec<KnownFragment<Vec<f64>>> {
        let (warp, design) = (&pixel.warp, self.around(pixel));
        let known = slabs::known_fragments(pixel.fragments, warp, design, pixel.precision);
        let read = |f: KnownFragment<_>| f.map(|interior| values(self.features, interior));
        known.into_iter().map(read).collect()
    }

    fn reads_around(&self) -> bool {
        matches!(self.design.extent, Extent::Among(_))
    }

    fn known_apart(&self) -> bool {
        self.design.apart
    }

    /// The same slabs with the middle of the bounds.
    fn baseline(&self, pixel: &PeeledPixel<'_>) -> [f64; 3] {
        let observed = &pixel.observed;
        let design = self.around(observed);
        let fragments = observed.fragments.iter().zip(pixel.colors);
        let fragments: Vec<_> = fragments
            .map(|(&(depth, alpha), &color)| Fragment::new(depth, alpha, color))
            .collect();
        slabs::composite(&fragments, [0.0; 3], &observed.warp, design, slabs::middle).map(f64::from)
    }

    fn target_values(&self, pixel: &Observed<'_>) -> Vec<(&'static str, Vec<f32>)> {
        let points = points(pixel.fragments, &pixel.warp);
        let slabs = Slabs::gather(&points, self.around(pixel), pixel.precision);
        let [mut a, mut firsts, mut near, mut far] = [const { Vec::new() }; 4];
        for slab in slabs.stored() {
            let all = [&mut a, &mut firsts, &mut near, &mut far].into_iter();
            all.zip(slab).for_each(|(all, x)| all.push(x as f32));
        }
        match self.layout() {
            Layout::Small => {
                a.push(firsts.remove(0));
                near.push(far[0]);
                vec![("absorbances", a), ("nearest", near), ("firsts", firsts)]
            }
            Layout::Medium => {
                let all = [&mut a, &mut near, &mut far].into_iter();
                all.zip(firsts).for_each(|(all, first)| all.push(first));
                vec![("absorbances", a), ("nearest", near), ("farthest", far)]
            }
            Layout::Large => vec![
                ("absorbances", a),
                ("nearest", near),
                ("farthest", far),
                ("firsts", firsts),
            ],
        }
    }
}

/// What surrounds a network, or any guess between the ends of slabs, in a layout.
pub const fn slab_surroundings(layout: Layout) -> &'static Surroundings {
    [&SMALL, &MEDIUM, &LARGE][layout as usize]
}

const fn modules(statistics: &'static str) -> [&'static str; 9] {
    [
        "learned::zeta",
        "learned::absorbance",
        "learned::levels",
        "learned::bins",
        "learned::quantiles",
        "learned::slabs",
        statistics,
        "learned::resolve",
        "learned::composite",
    ]
}

static SMALL: Surroundings = Surroundings {
    parameters: "between: PeelnetBetween",
    modules: &modules("learned::slabs_small"),
    before: ZETA_AMONG_QUANTILES,
    around: Some(&QUANTILES),
    passes: &passes(
        &[ABSORBANCES, NEAREST, sum("firsts", "rg16float", "s.firsts")],
        &["quantiles", "absorbances", "nearest", "firsts"],
        "peelnet_fragment(alpha, zeta, quantiles, absorbances, nearest, firsts).x",
    ),
    resolve: "peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z, background)",
};

static MEDIUM: Surroundings = Surroundings {
    modules: &modules("learned::slabs_medium"),
    passes: &passes(
        &[
            ABSORBANCES,
            most_and_sum("nearest", "s.nearest"),
            most_and_sum("farthest", "s.farthest"),
        ],
        &["quantiles", "absorbances", "nearest", "farthest"],
        "peelnet_fragment(alpha, zeta, quantiles, absorbances, nearest, farthest).x",
    ),
    ..SMALL
};

static LARGE: Surroundings = Surroundings {
    modules: &modules("learned::slabs_large"),
    passes: &passes(
        &[
            ABSORBANCES,
            NEAREST,
            most("farthest", HALF, LEAST, "s.farthest"),
            sum("firsts", HALF, "s.firsts"),
        ],
        &["quantiles", "absorbances", "nearest", "farthest", "firsts"],
        "peelnet_fragment(alpha, zeta, quantiles, absorbances, nearest, farthest, firsts).x",
    ),
    resolve: "peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z + absorbances.w, background)",
    ..SMALL
};

const fn passes(
    targets: &'static [Target],
    reads: &'static [&'static str],
    call: &'static str,
) -> [Pass; 2] {
    let kept = statistics("peelnet_statistics(alpha, zeta, quantiles)");
    [
        pass("statistics", &["quantiles"], kept, targets),
        pass("weights", reads, weight(call), SUMS),
    ]
}

const ABSORBANCES: Target = sum("absorbances", HALF, "s.absorbances");

const NEAREST: Target = most("nearest", HALF, LEAST, "s.nearest");
