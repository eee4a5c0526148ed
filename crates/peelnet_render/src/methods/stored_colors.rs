//! How methods that store fragments or layers keep their colours: in 16, 8 or 4 bytes, as `helpers/stored.wgsl` does.

use super::prelude::*;
use peelnet_core::fragment::Fragment;

/// What a stored colour and its alpha are kept in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colors {
    /// 16 bytes.
    #[default]
    Full,
    /// 8 bytes.
    Half,
    /// Four bytes: the roots of the premultiplied colour, which spend them on dark colours, and alpha. Light beyond 1 is cut off.
    Bytes,
}

impl Colors {
    /// A premultiplied colour and its alpha as they come back.
    pub fn restored(self, color: [f32; 4]) -> [f32; 4] {
        let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0 + 0.5).floor() / 255.0;
        match self {
            Self::Full => color,
            Self::Half => color.map(|x| half::f16::from_f32(x).to_f32()),
            Self::Bytes => {
                let [r, g, b] = [0, 1, 2].map(|k| byte(color[k].max(0.0).sqrt()).powi(2));
                [r, g, b, byte(color[3])]
            }
        }
    }

    /// A fragment as it comes back. What alpha rounds to 0 is lost, its light too.
    pub fn rounded(self, fragment: &Fragment) -> Fragment {
        // Light of next to no opacity has no colour to divide out.
        if self == Self::Full {
            return *fragment;
        }
        let [r, g, b] = fragment.premultiplied();
        let [r, g, b, alpha] = self.restored([r, g, b, fragment.alpha]);
        let share = if alpha > 0.0 { 1.0 / alpha } else { 0.0 };
        Fragment {
            alpha,
            color: [r, g, b].map(|c| c * share),
            ..*fragment
        }
    }
}

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

/// What a method still guarantees where its colours are rounded.
pub(super) fn guarantees(spec: &MethodSpec, full: Guarantees) -> Guarantees {
    match colors(spec) {
        Colors::Full => full,
        Colors::Half | Colors::Bytes => Guarantees {
            exact: false,
            sums: Precision::Half,
            rounds_fragments: true,
            ..full
        },
    }
}

/// What does not hold of colours in bytes.
pub(super) const fn in_bytes(property: Property, cases: &'static str) -> KnownFailure {
    let reason = "opacities and roots of colours are stored in bytes, which err by 1/510 each, and light beyond 1 is cut off";
    KnownFailure::new(property, cases, reason).when(are_bytes)
}

pub(super) fn are_bytes(spec: &MethodSpec) -> bool {
    COLORS.word(spec) == "u8"
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Halves keep 11 bits, bytes half a step of the root: near 0 a step is small.
    #[test]
    fn what_comes_back_is_close() {
        for i in 0..=1000 {
            let x = i as f32 / 1000.0;
            let back = |colors: Colors| colors.restored([x, x, x, x]);
            assert!((back(Colors::Half)[0] - x).abs() <= x / 2048.0);
            let [r, .., a] = back(Colors::Bytes);
            let half_step = 0.5 / 255.0;
            assert!((r.sqrt() - x.sqrt()).abs() <= half_step + 1e-6);
            assert!((a - x).abs() <= half_step + 1e-6);
        }
        assert_eq!(
            Colors::Bytes.restored([-1.0, 4.0, 0.0, 1.0]),
            [0.0, 1.0, 0.0, 1.0]
        );
    }

    #[test]
    fn fragments_come_back_with_their_colour() {
        let f = Fragment::new(2.0, 0.5, [0.5, 0.25, 1.0]);
        assert_eq!(Colors::Full.rounded(&f), f);
        assert_eq!(Colors::Half.rounded(&f), f);
        let faint = Fragment::new(2.0, 0.001, [1.0; 3]);
        assert_eq!(Colors::Bytes.rounded(&faint).alpha, 0.0);
    }
}
