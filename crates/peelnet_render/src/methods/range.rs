//! What methods that spread few values over a range of depth share: the choice of the range, and the pass that finds a pixel's own. The CPU
//! twin is `peelnet_core::methods::range`.

use super::{
    commutative::{Blend, Gather, Target},
    parameter::{Parameter, Targets, Word},
    spec::MethodSpec,
};
use peelnet_core::methods::range::Bounds;

const FRAME: &str = "frame";
const PIXEL: &str = "pixel";

/// `bounds`, the view's by default.
pub(super) const BOUNDS_OF_FRAME: Word = Word {
    name: "bounds",
    about: "frame (default) or pixel: the range of depths; a pixel's own takes one more pass",
    words: &[FRAME, PIXEL],
};

/// `bounds`, the pixel's own by default.
pub(super) const BOUNDS_OF_PIXEL: Word = Word {
    name: "bounds",
    about: "pixel (default) or frame: the range of depths; the frame's saves a pass",
    words: &[PIXEL, FRAME],
};

/// `targets` of a method with 16-bit targets but for the bounds.
pub(super) const RANGE_TARGETS: Parameter = Parameter::Targets(Targets {
    about: "f16 or f32 for all; by default 16 bits, and 32 for a pixel's bounds",
});

/// The range that a method's `bounds` asks for.
pub(super) fn bounds(spec: &MethodSpec, word: Word) -> Bounds {
    if word.of(spec) == PIXEL {
        Bounds::Pixel
    } else {
        Bounds::Frame
    }
}

/// The feature of shaders that read a pixel's bounds.
pub(super) const PIXEL_BOUNDS: &str = "pixel_bounds";

/// Warped depths of the pixel's nearest fragment, negated, and of its farthest.
pub(super) const RANGE: Target = Target {
    label: "bounds",
    channels: 2,
    full: true,
    // There is no alpha to add.
    blend: Blend::MaxAdd,
};

/// The pass that finds a pixel's bounds.
pub(super) const RANGE_PASS: Gather<'static> = Gather {
    label: "bounds",
    shader: "methods::bins::bounds",
    ..Gather::NONE
};
