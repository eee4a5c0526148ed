//! `bins-N`: cumulative absorbance in N intervals of depth (Osorio López's write-up, and as shipped in a block game). `reference.rs`
//! states the sources.
//!
//! The choice of the range that intervals are spread over, and the pass that finds a pixel's own, are `wavelet`'s, too.

mod expectations;
pub mod range;
pub mod reference;

use crate::methods::prelude::*;
use crate::passes::{Handle, Pass};
use range::Bounds;

/// `targets` of a method with 16-bit targets but for the bounds.
pub(super) const RANGE_TARGETS: Parameter =
    Parameter::targets("f16 or f32 for all; by default 16 bits, and 32 for a pixel's bounds");

const BOUNDS: Parameter = Parameter::words(
    "bounds",
    "pixel (default) or frame: the range of depths; the frame's saves a pass",
    &["pixel", "frame"],
);

/// The range that a method's `bounds` asks for.
pub(super) fn bounds(spec: &MethodSpec, parameter: Parameter) -> Bounds {
    if parameter.word(spec) == "pixel" {
        Bounds::Pixel
    } else {
        Bounds::Frame
    }
}

/// The pass that finds a pixel's bounds, where those are asked for: the target that holds the warped depths of its nearest fragment,
/// negated, and of its farthest.
pub(super) fn range_pass(p: &mut Passes<'_>, bounds: Bounds) -> Option<Handle> {
    if bounds == Bounds::Frame {
        return None;
    }
    // There is no alpha to add.
    let range = p.target(Target::full("bounds", 2, Blend::MaxAdd));
    p.geometry("methods::bins::bounds", Needs::DEPTH)
        .writes([range]);
    Some(range)
}

impl Pass {
    /// Reads a pixel's bounds behind all else, where there are any.
    pub(super) fn reads_range(&mut self, range: Option<Handle>) -> &mut Self {
        self.reads(range).features(range.map(|_| "pixel_bounds"))
    }
}

pub(super) const METHOD: Method = Method {
    numbered: Numbered::powers(4, 16),
    parameters: &[RANGE_TARGETS, BOUNDS],
    curve: &["-8", "-4", "-8:bounds=frame", "-16", "-8:targets=f16"],
    expectations: expectations::METHOD,
    ..Method::new(
        "bins",
        "absorbance in N intervals between a pixel's nearest and farthest fragment",
        passes,
    )
};

fn passes(p: &mut Passes<'_>) {
    let number = p.on.spec.number();
    let parameters =
        |first: usize| format!("const BINS: f32 = {number}.0;\nconst FIRST: u32 = {first}u;\n");
    let features = |targets: usize| {
        let two = (targets > 1).then_some("two");
        two.into_iter().chain((targets > 2).then_some("four"))
    };
    p.parameters = parameters(0);
    let sums = p.target(SUMS);
    let transmittance = p.target(TRANSMITTANCE);
    let names = ["bins_a", "bins_b", "bins_c", "bins_d"].into_iter();
    let fours = names.map(|name| Target::half(name, 4, Blend::Add));
    let fours = p.targets(fours.take(number as usize / 4));
    let range = range_pass(p, bounds(p.on.spec, BOUNDS));
    // One pass of portable WebGPU writes 32 bytes a pixel: four targets of 16 bits, two of 32.
    let at_once = match p.on.spec.targets() {
        Some(Precision::Full) => 2,
        _ => 4,
    };
    for (k, written) in fours.chunks(at_once).enumerate() {
        p.geometry("methods::bins::accumulate", Needs::OPACITY)
            .label("bins")
            .parameters(parameters(4 * at_once * k))
            .features(features(written.len()))
            .reads_range(range)
            .writes(written.iter().copied());
    }
    p.geometry("methods::bins::gather", Needs::COLOR)
        .features(features(fours.len()))
        .reads(fours)
        .reads_range(range)
        .writes([sums, transmittance]);
    p.resolve("methods::wboit::resolve", [sums, transmittance]);
}
