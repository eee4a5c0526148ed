//! `deep-thesis`: columns of a dataset. Every row is an example.

use super::{feature::*, network_inputs::*, surroundings::*};
use peelnet_core::methods::deep;

/// The inputs of the thesis's network, `(z_i, Σα, n)`.
pub static THESIS: [&Feature<deep::Row>; 3] = [
    &Feature::new("linear_depth", "scene units", "linear_depth", |row| {
        row.linear_depth.into()
    }),
    &Feature::new("alpha_sum", "1", "statistics.x", |row| row.alpha_sum.into()),
    &Feature::new("fragment_count", "1", "statistics.y", |row| {
        row.fragment_count.into()
    }),
];

/// Columns of a dataset.
#[derive(Debug)]
pub struct ThesisInputs;

impl NetworkInputs for ThesisInputs {
    fn features(&self) -> Vec<&'static About> {
        about(&THESIS)
    }

    fn surroundings(&self) -> &'static Surroundings {
        &SURROUNDINGS
    }

    fn transmittances(&self, pixel: &Observed<'_>, network: Forward<'_>) -> Vec<f64> {
        let fragments = pixel.fragments.iter();
        let alpha_sum = fragments.clone().map(|(_, alpha)| alpha).sum();
        let row = |&(linear_depth, _): &(f32, f32)| deep::Row {
            linear_depth,
            alpha_sum,
            fragment_count: pixel.fragments.len() as f32,
        };
        let inputs = fragments.map(|f| values(&THESIS, &row(f)));
        inputs.map(|inputs| network(&inputs)).collect()
    }

    fn examples(&self, pixel: &PeeledPixel<'_>) -> Examples {
        let row = |(i, &(linear_depth, _)): (usize, &(f32, f32))| deep::Row {
            linear_depth,
            alpha_sum: pixel.alpha_sum[i],
            // Counts are far below 2²⁴, up to which 32-bit floats hold every integer.
            fragment_count: pixel.fragment_count[i] as f32,
        };
        let rows = pixel.observed.fragments.iter().enumerate().map(row);
        let rows = rows.zip(pixel.transmittance).map(|(row, &t)| RowExample {
            inputs: values(&THESIS, &row),
            targets: vec![t.into()],
        });
        Examples::Rows(rows.collect())
    }

    fn are_columns(&self) -> bool {
        true
    }
}

const LIGHT_LEFT: ([f32; 4], Blend, Blend) = ([1.0; 4], Blend::Transmit, Blend::Transmit);

static SURROUNDINGS: Surroundings = Surroundings {
    parameters: "linear_depth: f32, statistics: vec2f",
    modules: &["learned::thesis", "learned::composite"],
    before: "z is the distance along the view axis, in the unit of the scenes that the network was trained on.",
    around: None,
    passes: PASSES,
    resolve: "peelnet_resolve(sums, transmittance, background)",
};

const PASSES: &[Pass] = &[
    pass(
        "statistics",
        &[],
        None,
        &[sum("statistics", "rg16float", "peelnet_statistics(alpha)")],
    ),
    pass(
        "weights",
        &["statistics"],
        weight("peelnet_fragment(z, statistics)"),
        &[
            sum("sums", HALF, WEIGHTED),
            target("transmittance", "r16float", LIGHT_LEFT, "alpha"),
        ],
    ),
];
