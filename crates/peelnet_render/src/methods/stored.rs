//! How methods that store fragments or layers keep their colours: what `colors=WORD` means. The shader side is `helpers/stored.wgsl`.

use super::{parameter::Word, spec::MethodSpec};
use crate::flaw::{Flaw, Property};

/// `colors`, in 32 bits by default.
pub(super) const COLORS: Word = Word {
    name: "colors",
    about: "stored in f32 (default), f16 or u8: 16, 8 or 4 bytes a fragment; u8 cuts light beyond 1 off",
    words: &["f32", "f16", "u8"],
};

/// Whether nothing of a colour is rounded.
pub(super) fn is_full(spec: &MethodSpec) -> bool {
    COLORS.of(spec) == "f32"
}

/// Bytes of a colour and its alpha.
pub(super) fn bytes(spec: &MethodSpec) -> u32 {
    match COLORS.of(spec) {
        "f16" => 8,
        "u8" => 4,
        _ => 16,
    }
}

/// Features of the shaders that write and read them.
pub(super) fn features(spec: &MethodSpec) -> &'static [&'static str] {
    match COLORS.of(spec) {
        "f16" => &["half_colors"],
        "u8" => &["byte_colors"],
        _ => &[],
    }
}

/// What does not hold of colours in half floats.
pub(super) const fn in_halves(property: Property, cases: &'static [&'static str]) -> Flaw {
    let reason = "colours and opacities are stored in half floats, which err by 2^-11 of the value";
    Flaw::new(property, cases, reason).when(|s| COLORS.of(s) == "f16")
}

/// What does not hold of colours in bytes.
pub(super) const fn in_bytes(property: Property, cases: &'static [&'static str]) -> Flaw {
    let reason = "opacities and roots of colours are stored in bytes, which err by 1/510 each, and light beyond 1 is cut off";
    Flaw::new(property, cases, reason).when(|s| COLORS.of(s) == "u8")
}
