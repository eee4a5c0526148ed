//! How methods that store fragments or layers keep their colours: what `colors=WORD` means. The shader side is `helpers/stored.wgsl`.

use super::{parameter::Word, spec::MethodSpec};

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
