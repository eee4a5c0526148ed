//! `bins-N`: cumulative absorbance in N intervals of depth (Osorio López's write-up, and as shipped in a block game). The CPU twin
//! is `peelnet_core::methods::bins`, which states the sources.

use super::{
    commutative::{self, Blend, Gather, Plan, Target},
    compositor::{Build, Compositor},
    method::{Method, Numbered},
    parameter::{Parameter, Precision},
    range::{BOUNDS_OF_PIXEL, PIXEL_BOUNDS, RANGE, RANGE_PASS, RANGE_TARGETS, bounds},
    spec::MethodSpec,
    weighted::{SUMS, TRANSMITTANCE},
};
use crate::{
    error::RenderError,
    flaw::{Flaw, Property},
};
use peelnet_core::methods::{bins, range::Bounds};

fn of_pixel(spec: &MethodSpec) -> bool {
    bounds(spec, BOUNDS_OF_PIXEL) == Bounds::Pixel
}

fn four_of_pixel(spec: &MethodSpec) -> bool {
    of_pixel(spec) && spec.number() == 4
}

const FEW_BINS: &str =
    "four bins between a pixel's ends: within one, absorbance counts as spread evenly";

pub(super) const METHOD: Method = Method {
    numbered: Some(Numbered {
        least: 4,
        most: 16,
        power_of_two: true,
    }),
    parameters: &[RANGE_TARGETS, Parameter::Word(BOUNDS_OF_PIXEL)],
    curve: &["-8", "-4", "-8:bounds=frame", "-16", "-8:targets=f16"],
    twin: Some(|s, p| {
        let (fragments, c0, n) = (p.fragments, p.background, s.number() as usize);
        let bounds = bounds(s, BOUNDS_OF_PIXEL);
        Some(bins::composite(fragments, c0, &p.warp, n, bounds))
    }),
    transmittances: Some(|s, fragments, warp, _| {
        let (n, bounds) = (s.number() as usize, bounds(s, BOUNDS_OF_PIXEL));
        Some(bins::transmittances(fragments, warp, n, bounds))
    }),
    flaws: &[
        Flaw::swallowed(&["deep"]),
        Flaw::new(
            Property::Opaque,
            &["alpha-near-one"],
            "absorbance ends at 4, as shipped: three layers of 0.99 let 1.8 % through each, not 1 %",
        )
        .when(of_pixel),
        Flaw::new(
            Property::Opaque,
            &["alpha-near-one"],
            "bins over the whole frame's depth blur what lies close together",
        )
        .when(|s| !of_pixel(s)),
        Flaw::new(
            Property::Transmittance,
            &["two-layers"],
            "bins over the whole frame's depth blur what lies close together",
        )
        .when(|s| !of_pixel(s)),
        Flaw::new(Property::Transmittance, &["coplanar"], FEW_BINS).when(four_of_pixel),
        Flaw::new(Property::Steady, &["moving-camera"], FEW_BINS).when(four_of_pixel),
    ],
    ..Method::new(
        "bins",
        "absorbance in N intervals between a pixel's nearest and farthest fragment",
        build,
    )
};

fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let number = b.spec.number();
    let of_pixel = of_pixel(b.spec);
    let mut targets = vec![SUMS, TRANSMITTANCE];
    let fours: Vec<usize> = (targets.len()..).take(number as usize / 4).collect();
    targets.extend(fours.iter().map(|_| Target {
        label: "bins",
        channels: 4,
        full: false,
        blend: Blend::Add,
    }));
    let range: Vec<usize> = of_pixel.then_some(targets.len()).into_iter().collect();
    targets.extend(range.iter().map(|_| RANGE));
    let with_range = |own: &[&'static str]| {
        let more: &[_] = if of_pixel { &[PIXEL_BOUNDS] } else { &[] };
        [own, more].concat()
    };
    let features_of = |targets: usize| -> &[&'static str] {
        match targets {
            1 => &[],
            2 => &["two"],
            _ => &["two", "four"],
        }
    };
    // One pass of portable WebGPU writes 32 bytes a pixel: four targets of 16 bits, two of 32.
    let at_once = match b.spec.targets() {
        Some(Precision::Full) => 2,
        _ => 4,
    };
    let bins = format!("const BINS: f32 = {number}.0;\n");
    let parameters: Vec<String> = (0..number)
        .step_by(4 * at_once)
        .map(|first| format!("{bins}const FIRST: u32 = {first}u;\n"))
        .collect();
    let extras: Vec<_> = parameters
        .iter()
        .map(|p| [("parameters", p.as_str())])
        .collect();
    let accumulating = with_range(features_of(at_once.min(fours.len())));
    let gathering = with_range(features_of(fours.len()));
    let read = [fours.as_slice(), &range].concat();
    let mut passes = Vec::new();
    passes.extend(of_pixel.then_some(Gather {
        writes: &range,
        ..RANGE_PASS
    }));
    passes.extend(
        fours
            .chunks(at_once)
            .zip(&extras)
            .map(|(writes, extra)| Gather {
                label: "bins",
                shader: "methods::bins::accumulate",
                features: &accumulating,
                extra,
                writes,
                reads: &range,
                ..Gather::NONE
            }),
    );
    passes.push(Gather {
        shader: "methods::bins::gather",
        features: &gathering,
        extra: &extras[0],
        writes: &[0, 1],
        reads: &read,
        ..Gather::NONE
    });
    commutative::build(
        b,
        &Plan {
            targets: &targets,
            passes: &passes,
            resolve: "methods::wboit::resolve",
            resolve_reads: &[0, 1],
            ..Plan::NONE
        },
    )
}
