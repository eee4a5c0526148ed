//! `deep-one`, `deep-one-wide`: how much is seen of each sum of a pixel that was drawn in one pass. Whole pixels are examples.

use super::{feature::*, network_inputs::*, surroundings::*};
use peelnet_core::{
    absorbance::DepthWarp,
    fragment::Fragment,
    methods::{
        one::{self, Ahead, Around, Design, Kept, Rest, formula},
        quantiles::depth_of,
        slabs::points,
    },
};

const OF_TOTAL: &str = "of the absorbance of all sums";

/// How much absorbance the formula puts in front of a sum and how much there is, how it is spread over the sums around it, and what is known of
/// the nearest fragment.
pub static NINE_OF_SUMS: [&Feature<Ahead>; 9] = [
    &Feature::new(
        "root_absorbance",
        "root of twice the absorbance in front, by the formula",
        "sqrt(2.0 * ahead.absorbance)",
        |ahead| (2.0 * ahead.absorbance).sqrt(),
    ),
    &Feature::new(
        "root_total",
        "root of the absorbance of all sums",
        "sqrt(ahead.total)",
        |ahead| ahead.total.sqrt(),
    ),
    &Feature::new("share_before", OF_TOTAL, "ahead.before", |a| a.before),
    &Feature::new("share_own", OF_TOTAL, "ahead.own", |a| a.own),
    &Feature::new("share_previous", OF_TOTAL, "ahead.previous", |a| a.previous),
    &Feature::new("share_next", OF_TOTAL, "ahead.next", |a| a.next),
    &Feature::new("nearest_alpha", "1", "ahead.alpha", |a| a.alpha),
    &Feature::new("nearest_place", "among the quantiles", "ahead.place", |a| {
        a.place
    }),
    &Feature::new(
        "number",
        "0 for the first, 1 for the last sum",
        "ahead.number",
        |a| a.number,
    ),
];

/// The sums of a pixel.
#[derive(Debug)]
pub struct OneInputs {
    /// The sums.
    pub design: Design,
}

impl OneInputs {
    fn rest(&self, pixel: &PeeledPixel<'_>) -> Rest {
        let (observed, colors) = (&pixel.observed, pixel.colors.iter().copied());
        let points = points(observed.fragments, &observed.warp);
        let (around, precision) = (observed.around, observed.precision);
        Kept::gather(&points, colors, self.design, around, precision).rest()
    }
}

impl NetworkInputs for OneInputs {
    fn features(&self) -> Vec<&'static About> {
        about(&NINE_OF_SUMS)
    }

    fn surroundings(&self) -> &'static Surroundings {
        one_surroundings(self.design)
    }

    fn transmittances(&self, pixel: &Observed<'_>, network: Forward<'_>) -> Vec<f64> {
        let answer = |ahead: &Ahead| network(&values(&NINE_OF_SUMS, ahead));
        let (warp, around) = (&pixel.warp, pixel.around);
        one::transmittances(
            pixel.fragments,
            warp,
            self.design,
            around,
            pixel.precision,
            answer,
        )
    }

    fn examples(&self, pixel: &PeeledPixel<'_>) -> Examples {
        let rest = self.rest(pixel);
        if rest.left <= 0.0 {
            return Examples::Rows(Vec::new());
        }
        // What is seen of each sum, of all fragments but the nearest.
        let mut exact = [0.0; one::MAX_SUMS];
        let mut color = [0.0; 3];
        let observed = &pixel.observed;
        for (i, seen) in pixel.contributions().enumerate() {
            for (sum, &c) in color.iter_mut().zip(&pixel.colors[i]) {
                *sum += seen * f64::from(c);
            }
            if i > 0 {
                let depth = depth_of(observed.warp.cut(observed.fragments[i].0.into()));
                let shares = self.design.shares(observed.around.quantiles.place(depth));
                exact
                    .iter_mut()
                    .zip(shares)
                    .for_each(|(sum, share)| *sum += seen * share);
            }
        }
        let known = rest.nearest.color.map(|c| rest.alpha * c);
        let sums = rest.sums.iter().zip(&rest.ahead).zip(exact);
        let sums = sums.filter(|((sum, _), _)| sum[3] > 0.0);
        let sums = sums.map(|((sum, ahead), exact)| GuessedSum {
            inputs: values(&NINE_OF_SUMS, ahead),
            absorbance: 2.0 * ahead.absorbance,
            weight: sum[3],
            color: [0, 1, 2].map(|c| sum[c] / sum[3]),
            exact,
        });
        Examples::Sums(PixelSums {
            sums: sums.collect(),
            left: rest.left,
            color: std::array::from_fn(|c| color[c] - known[c]),
        })
    }

    fn reads_around(&self) -> bool {
        true
    }

    fn color(
        &self,
        fragments: &[Fragment],
        background: [f32; 3],
        warp: &DepthWarp,
        network: Forward<'_>,
    ) -> Option<[f32; 3]> {
        let (design, answer) = (self.design, |a: &Ahead| network(&values(&NINE_OF_SUMS, a)));
        let around = Around::NONE;
        Some(one::composite(
            fragments, background, warp, design, around, answer,
        ))
    }

    /// By the formula.
    fn baseline(&self, pixel: &PeeledPixel<'_>) -> [f64; 3] {
        self.rest(pixel).color(formula)
    }
}

/// What surrounds a network, or the formula, of a design.
pub fn one_surroundings(design: Design) -> &'static Surroundings {
    if design == Design::WIDE { &WIDE } else { &ONE }
}

const BEFORE: &str = concat!(
    zeta_among_quantiles!(),
    " noise is any number in 0 .. 1 that is the same for all of a pixel, such as peelnet_noise(pixel): it hides the steps of what is kept \
    of the nearest fragment; 0.5 where that does not matter."
);

static AROUND_ONE: SmallTexture = SmallTexture {
    last: Some("peelnet_last_seen(sum_a, sum_b, sum_c, absorbances, quantiles, noise)"),
    ..QUANTILES
};

static AROUND_WIDE: SmallTexture = SmallTexture {
    last: Some(
        "peelnet_last_seen(sum_a, sum_b, sum_c, sum_d, sum_e, sum_f, absorbances, absorbances_back, quantiles, noise)",
    ),
    ..QUANTILES
};

const fn surroundings(
    modules: &'static [&'static str],
    around: &'static SmallTexture,
    passes: &'static [Pass],
    resolve: &'static str,
) -> Surroundings {
    Surroundings {
        parameters: "ahead: PeelnetAhead",
        modules,
        before: BEFORE,
        around: Some(around),
        passes,
        resolve,
    }
}

const fn kept(name: &'static str, write: &'static str) -> Target {
    let blend = ([0.0, 0.0, 0.0, LEAST], Blend::Add, Blend::Max);
    target(name, HALF, blend, write)
}

static ONE: Surroundings = surroundings(
    &[
        "learned::zeta",
        "learned::absorbance",
        "learned::levels",
        "learned::bins",
        "learned::quantiles",
        "learned::one",
        "learned::one_narrow",
    ],
    &AROUND_ONE,
    &[pass(
        "gather",
        &["quantiles"],
        statistics("peelnet_statistics(alpha, rgb, zeta, quantiles, noise)"),
        &[
            kept("sum_a", "s.sum_a"),
            kept("sum_b", "s.sum_b"),
            kept("sum_c", "s.sum_c"),
            kept("absorbances", "s.absorbances"),
        ],
    )],
    "peelnet_resolve(sum_a, sum_b, sum_c, absorbances, quantiles, noise, background)",
);

static WIDE: Surroundings = surroundings(
    &[
        "learned::zeta",
        "learned::absorbance",
        "learned::levels",
        "learned::bins",
        "learned::quantiles",
        "learned::one",
        "learned::one_wide",
    ],
    &AROUND_WIDE,
    &[pass(
        "gather",
        &["quantiles"],
        statistics("peelnet_statistics(alpha, rgb, zeta, quantiles, noise)"),
        &[
            kept("sum_a", "s.sum_a"),
            kept("sum_b", "s.sum_b"),
            kept("sum_c", "s.sum_c"),
            kept("sum_d", "s.sum_d"),
            kept("sum_e", "s.sum_e"),
            kept("sum_f", "s.sum_f"),
            kept("absorbances", "s.absorbances"),
            kept("absorbances_back", "s.absorbances_back"),
        ],
    )],
    "peelnet_resolve(sum_a, sum_b, sum_c, sum_d, sum_e, sum_f, absorbances, absorbances_back, quantiles, noise, background)",
);
