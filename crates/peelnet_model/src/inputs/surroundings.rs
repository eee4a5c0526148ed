//! What surrounds a network: the shader modules of its text, and what a renderer does around that text.

use peelnet_core::methods::quantiles::TILE;
use serde::{Serialize, Serializer};
use std::fmt;

/// What surrounds the networks of a kind. The vocabulary of calls is that of exported texts: `z`, `zeta`, `alpha` and `rgb` of a fragment, and
/// targets by their names.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// Parameters of `peelnet_network` in WGSL, which the features' expressions are functions of.
    pub parameters: &'static str,
    /// Shader modules of the exported text, in order.
    pub modules: &'static [&'static str],
    /// What comes before the passes.
    pub before: &'static str,
    /// What the passes read of each pixel's surroundings.
    pub around: Option<&'static SmallTexture>,
    /// The passes, in order.
    pub passes: &'static [Pass],
    /// The call that resolves each pixel.
    pub resolve: &'static str,
}

/// How a target blends, per channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Blend {
    /// `dst + src`.
    Add,
    /// `max(dst, src)`.
    Max,
    /// `dst · (1 − src)`.
    Transmit,
}

/// A colour attachment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Target {
    /// Its name in the calls.
    pub name: &'static str,
    /// WebGPU's name of the least format.
    pub format: &'static str,
    /// What it is cleared to.
    pub clear: [f32; 4],
    /// Blending of red, green and blue.
    pub color: Blend,
    /// Blending of alpha.
    pub alpha: Blend,
    /// What each fragment writes.
    pub write: &'static str,
}

/// What an exported function returns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueKind {
    /// A number.
    Number,
    /// Two numbers.
    Pair,
    /// Four columns of four numbers.
    Matrix,
    /// The text's `PeelnetStatistics`.
    Statistics,
}

/// A value that a fragment computes before it writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Value {
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub kind: ValueKind,
    /// The call of an exported function.
    pub call: &'static str,
}

/// The WGSL statement.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "let {} = {};", self.name, self.call)
    }
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// A pass that draws all transparent surfaces, in any order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pass {
    /// Its name.
    pub name: &'static str,
    /// The targets of earlier passes, and the small texture, that each fragment reads at its own pixel: a number, two or four, as its format has channels.
    pub reads: &'static [&'static str],
    /// What each fragment computes first, as a WGSL statement in files.
    pub compute: Option<Value>,
    /// Its attachments.
    pub targets: &'static [Target],
}

/// A small texture of what surrounds each pixel, drawn before the passes, which read it with linear interpolation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SmallTexture {
    /// Its name in the calls.
    pub name: &'static str,
    /// WebGPU's name of its least format.
    pub format: &'static str,
    /// It has one texel for so many pixels of the frame, across and down.
    pub every: u32,
    /// Drawn at its size, into other targets.
    pub pass: Pass,
    /// What to sum of those targets over the 3 × 3 texels around each.
    pub sum: &'static str,
    /// What to sum instead where it is made for the next frame, of what the passes keep of the pixel in the middle of each texel; `None` where they
    /// do not say it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last: Option<&'static str>,
    /// A texel's value, of `sum`.
    pub write: &'static str,
    /// Stands for it where it is not drawn.
    pub otherwise: &'static str,
}

/// What levels are cleared to.
pub(super) const LEAST: f32 = -65504.0;

pub(super) const HALF: &str = "rgba16float";

pub(super) const WEIGHTED: &str = "vec4f(alpha * rgb, alpha) * w";

pub(super) const SUMS: &[Target] = &[sum("sums", HALF, WEIGHTED)];

macro_rules! zeta {
    () => {
        "zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the \
    bounding boxes of the transparent objects in view span, clipped to the camera's. The tighter the range, the less errs. \
    Compute zeta with this function in all passes. Its range is the same for the whole frame: \
    peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in."
    };
}

pub(super) use zeta;

pub(super) const ZETA: &str = zeta!();

macro_rules! zeta_among_quantiles {
    () => {
        concat!(
            zeta!(),
            " Where boxes show that nothing lies between two depths, use peelnet_cut(zeta, gaps) for zeta in all passes: it leaves up to two such \
    gaps out. quantiles says where among the depths around the pixel most is seen: peelnet_even() where nothing is known but near and far, with \
    several times the error."
        )
    };
}

pub(super) use zeta_among_quantiles;

pub(super) const ZETA_AMONG_QUANTILES: &str = zeta_among_quantiles!();

pub(super) const fn target(
    name: &'static str,
    format: &'static str,
    (clear, color, alpha): ([f32; 4], Blend, Blend),
    write: &'static str,
) -> Target {
    Target {
        name,
        format,
        clear,
        color,
        alpha,
        write,
    }
}

pub(super) const fn sum(name: &'static str, format: &'static str, write: &'static str) -> Target {
    target(name, format, ([0.0; 4], Blend::Add, Blend::Add), write)
}

pub(super) const fn most(
    name: &'static str,
    format: &'static str,
    clear: f32,
    write: &'static str,
) -> Target {
    target(name, format, ([clear; 4], Blend::Max, Blend::Max), write)
}

pub(super) const fn most_and_sum(name: &'static str, write: &'static str) -> Target {
    let blend = ([LEAST, LEAST, LEAST, 0.0], Blend::Max, Blend::Add);
    target(name, HALF, blend, write)
}

pub(super) const fn pass(
    name: &'static str,
    reads: &'static [&'static str],
    compute: Option<Value>,
    targets: &'static [Target],
) -> Pass {
    Pass {
        name,
        reads,
        compute,
        targets,
    }
}

pub(super) const fn value(
    name: &'static str,
    kind: ValueKind,
    call: &'static str,
) -> Option<Value> {
    Some(Value { name, kind, call })
}

pub(super) const fn statistics(call: &'static str) -> Option<Value> {
    value("s", ValueKind::Statistics, call)
}

pub(super) const fn weight(call: &'static str) -> Option<Value> {
    value("w", ValueKind::Number, call)
}

/// Quantiles of what is seen around a pixel.
pub(super) static QUANTILES: SmallTexture = SmallTexture {
    name: "quantiles",
    format: "rgba8unorm",
    every: TILE,
    pass: pass(
        "around",
        &[],
        value("bins", ValueKind::Matrix, "peelnet_tile_bins(alpha, zeta)"),
        &[
            sum("bins_a", "rgba8unorm", "bins[0]"),
            sum("bins_b", "rgba8unorm", "bins[1]"),
            sum("bins_c", "rgba8unorm", "bins[2]"),
            // In two: four channels of 8 bits count as eight bytes of the 32 that a pass may write, two as two.
            sum("bins_d", "rg8unorm", "bins[3].xy"),
            sum("bins_e", "rg8unorm", "bins[3].zw"),
            most(
                "tile_nearest",
                "r16float",
                LEAST,
                "peelnet_tile_nearest(alpha, zeta)",
            ),
        ],
    ),
    sum: "peelnet_tile_seen(mat4x4f(bins_a, bins_b, bins_c, vec4f(bins_d, bins_e)), tile_nearest)",
    last: None,
    write: "peelnet_quantiles(sum)",
    otherwise: "peelnet_even()",
};
