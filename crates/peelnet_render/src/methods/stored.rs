//! How methods that store fragments or layers keep their colours: what `colors=WORD` means. The shader side is `helpers/stored.wgsl`.

use super::prelude::*;
use peelnet_core::methods::stored::Colors;

/// `colors`, in 32 bits by default.
pub(super) const COLORS: Parameter = Parameter::words(
    "colors",
    "stored in f32 (default), f16 or u8: 16, 8 or 4 bytes a fragment; u8 cuts light beyond 1 off",
    &["f32", "f16", "u8"],
);

/// What colours are kept in, the bytes of a colour and its alpha, and the feature of the shaders that write and read them.
pub(super) fn layout(spec: &MethodSpec) -> (Colors, u32, Option<&'static str>) {
    match COLORS.word(spec) {
        "f16" => (Colors::Half, 8, Some("half_colors")),
        "u8" => (Colors::Bytes, 4, Some("byte_colors")),
        _ => (Colors::Full, 16, None),
    }
}

pub(super) fn colors(spec: &MethodSpec) -> Colors {
    layout(spec).0
}

/// What a method still promises where its colours are rounded.
pub(super) fn promises(spec: &MethodSpec, full: Promises) -> Promises {
    match colors(spec) {
        Colors::Full => full,
        Colors::Half | Colors::Bytes => Promises {
            exact: false,
            sums: Precision::Half,
            rounds_fragments: true,
            ..full
        },
    }
}

/// What does not hold of colours in bytes.
pub(super) const fn in_bytes(property: Property, cases: &'static str) -> Flaw {
    let reason = "opacities and roots of colours are stored in bytes, which err by 1/510 each, and light beyond 1 is cut off";
    Flaw::new(property, cases, reason).when(|s| COLORS.word(s) == "u8")
}
