//! How methods that store fragments or layers keep their colours: what `colors=WORD` means. The shader side is `helpers/stored.wgsl`.

use super::{
    method::Promises,
    parameter::{Precision, Word},
    spec::MethodSpec,
};
use crate::flaw::{Flaw, Property};
use peelnet_core::methods::stored::Colors;

/// `colors`, in 32 bits by default.
pub(super) const COLORS: Word = Word {
    name: "colors",
    about: "stored in f32 (default), f16 or u8: 16, 8 or 4 bytes a fragment; u8 cuts light beyond 1 off",
    words: &["f32", "f16", "u8"],
};

/// What colours are kept in.
pub(super) fn colors(spec: &MethodSpec) -> Colors {
    match COLORS.of(spec) {
        "f16" => Colors::Half,
        "u8" => Colors::Bytes,
        _ => Colors::Full,
    }
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

/// Bytes of a colour and its alpha.
pub(super) const fn bytes(colors: Colors) -> u32 {
    match colors {
        Colors::Full => 16,
        Colors::Half => 8,
        Colors::Bytes => 4,
    }
}

/// Features of the shaders that write and read them.
pub(super) const fn features(colors: Colors) -> &'static [&'static str] {
    match colors {
        Colors::Full => &[],
        Colors::Half => &["half_colors"],
        Colors::Bytes => &["byte_colors"],
    }
}

/// What does not hold of colours in bytes.
pub(super) const fn in_bytes(property: Property, cases: &'static [&'static str]) -> Flaw {
    let reason = "opacities and roots of colours are stored in bytes, which err by 1/510 each, and light beyond 1 is cut off";
    Flaw::new(property, cases, reason).when(|s| COLORS.of(s) == "u8")
}
