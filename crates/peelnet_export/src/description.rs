//! What a renderer must do around an exported text: the one source of the text's header and of the documents.

use crate::language::Language;
use peelnet_core::methods::slabs::{Design, Layout};
use peelnet_model::{Inputs, Output, Recipe};
use serde::Serialize;
use std::fmt;

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

impl Blend {
    const fn text(self) -> &'static str {
        match self {
            Self::Add => "ADD",
            Self::Max => "MAX",
            Self::Transmit => "dst * (1 - src)",
        }
    }
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
pub enum Kind {
    /// A number.
    Number,
    /// Two numbers.
    Pair,
    /// The text's `PeelnetStatistics`.
    Statistics,
}

/// A value that a fragment computes before it writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Value {
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub kind: Kind,
    /// The call of an exported function.
    pub call: &'static str,
}

/// The WGSL statement.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&Language::Wgsl.declare(self))
    }
}

impl Serialize for Value {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// A pass that draws all transparent surfaces, in any order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pass {
    /// Its name.
    pub name: &'static str,
    /// The targets of earlier passes that each fragment reads at its own pixel: a number, two or four, as its format has channels.
    pub reads: &'static [&'static str],
    /// What each fragment computes first, as a WGSL statement in files.
    pub compute: Option<Value>,
    /// Its attachments.
    pub targets: &'static [Target],
}

/// What a renderer must do around an exported text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Description {
    /// What comes before the passes.
    pub before: &'static str,
    /// The passes, in order.
    pub passes: &'static [Pass],
    /// The call that resolves each pixel.
    pub resolve: &'static str,
    /// The targets that it reads.
    pub resolve_reads: Vec<&'static str>,
    /// What holds in all passes, and what breaks the result.
    pub rules: &'static [&'static str],
}

/// What levels are cleared to.
const LEAST: f32 = -65504.0;

const fn target(
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

const fn sum(name: &'static str, format: &'static str, write: &'static str) -> Target {
    target(name, format, ([0.0; 4], Blend::Add, Blend::Add), write)
}

const fn most(name: &'static str, format: &'static str, clear: f32, write: &'static str) -> Target {
    target(name, format, ([clear; 4], Blend::Max, Blend::Max), write)
}

const fn most_and_sum(name: &'static str, write: &'static str) -> Target {
    let blend = ([LEAST, LEAST, LEAST, 0.0], Blend::Max, Blend::Add);
    target(name, HALF, blend, write)
}

const fn pass(
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

const fn value(name: &'static str, kind: Kind, call: &'static str) -> Option<Value> {
    Some(Value { name, kind, call })
}

const fn statistics(call: &'static str) -> Option<Value> {
    value("s", Kind::Statistics, call)
}

const fn weight(call: &'static str) -> Option<Value> {
    value("w", Kind::Number, call)
}

const HALF: &str = "rgba16float";
const WHOLE: &str = "rgba32float";

const ZETA: &str = "zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the \
    bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else \
    you choose. Compute zeta with this function in all passes. Its range is the same for the whole frame: \
    peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.";

const WEIGHTED: &str = "vec4f(alpha * rgb, alpha) * w";

const RULES: &[&str] = &[
    "alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.",
    "Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.",
    "z grows with distance, also where depth buffers are reversed.",
    "With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.",
];

const SUMS: &[Target] = &[sum("sums", HALF, WEIGHTED)];

const ANCHORED_STATISTICS: Pass = pass(
    "statistics",
    &[],
    statistics("peelnet_statistics(alpha, zeta)"),
    &[
        sum("moments", HALF, "s.moments"),
        most_and_sum("extent", "s.extent"),
    ],
);

const ONE_SUM: &[Pass] = &[
    ANCHORED_STATISTICS,
    pass(
        "weights",
        &["moments", "extent"],
        weight("peelnet_fragment(alpha, zeta, moments, extent).x"),
        SUMS,
    ),
];

const BETWEEN: &str = "vec4f(alpha * rgb, alpha) * (f.x * (1.0 - min(f.y, 1.0)))";

const ENDS: &str = "vec4f(alpha * rgb, alpha) * (f.x * min(f.y, 1.0))";

const SEPARATE_ENDS: &[Pass] = &[
    ANCHORED_STATISTICS,
    pass(
        "weights",
        &["moments", "extent"],
        value(
            "f",
            Kind::Pair,
            "peelnet_fragment(alpha, zeta, moments, extent)",
        ),
        &[sum("sums", HALF, BETWEEN), sum("ends", HALF, ENDS)],
    ),
];

const RANGE: &[Target] = &[most("range", "rg8unorm", 0.0, "r")];

const fn slabs(
    targets: &'static [Target],
    reads: &'static [&'static str],
    call: &'static str,
) -> [Pass; 3] {
    let range = value("r", Kind::Pair, "peelnet_pixel_range(zeta)");
    let in_range = statistics("peelnet_statistics(alpha, zeta, range)");
    [
        pass("range", &[], range, RANGE),
        pass("statistics", &["range"], in_range, targets),
        pass("weights", reads, weight(call), SUMS),
    ]
}

const ABSORBANCES: Target = sum("absorbances", HALF, "s.absorbances");

const NEAREST: Target = most("nearest", HALF, LEAST, "s.nearest");

const SMALL_SLABS: &[Pass] = &slabs(
    &[ABSORBANCES, NEAREST, sum("firsts", "rg16float", "s.firsts")],
    &["range", "absorbances", "nearest", "firsts"],
    "peelnet_fragment(alpha, zeta, range, absorbances, nearest, firsts).x",
);

const MEDIUM_SLABS: &[Pass] = &slabs(
    &[
        ABSORBANCES,
        most_and_sum("nearest", "s.nearest"),
        most_and_sum("farthest", "s.farthest"),
    ],
    &["range", "absorbances", "nearest", "farthest"],
    "peelnet_fragment(alpha, zeta, range, absorbances, nearest, farthest).x",
);

const LARGE_SLABS: &[Pass] = &slabs(
    &[
        ABSORBANCES,
        NEAREST,
        most("farthest", HALF, LEAST, "s.farthest"),
        sum("firsts", HALF, "s.firsts"),
    ],
    &["range", "absorbances", "nearest", "farthest", "firsts"],
    "peelnet_fragment(alpha, zeta, range, absorbances, nearest, farthest, firsts).x",
);

const LIGHT_LEFT: ([f32; 4], Blend, Blend) = ([1.0; 4], Blend::Transmit, Blend::Transmit);

const THESIS: &[Pass] = &[
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

const NMT: &[Pass] = &[
    pass(
        "statistics",
        &[],
        statistics("peelnet_statistics(alpha, zeta)"),
        &[
            sum("totals", WHOLE, "s.totals"),
            sum("moments", WHOLE, "s.moments"),
            most("extent", "rg32float", LEAST, "s.extent"),
        ],
    ),
    pass(
        "weights",
        &["totals", "moments", "extent"],
        weight("peelnet_fragment(zeta, totals, moments, extent)"),
        &[sum("sums", WHOLE, WEIGHTED)],
    ),
];

const OVER: ([f32; 4], Blend, Blend) = ([0.0, 0.0, 0.0, 1.0], Blend::Add, Blend::Transmit);

const DFAOIT: &[Pass] = &[pass(
    "statistics",
    &["front"],
    statistics("peelnet_statistics(vec4f(rgb, alpha), front)"),
    &[
        sum("behind", HALF, "s.behind"),
        target("all", HALF, OVER, "s.all"),
        sum("count", "r16float", "s.count"),
    ],
)];

const THESIS_BEFORE: &str = "z is the distance along the view axis, in the unit of the scenes that the network was trained on.";

const DFAOIT_BEFORE: &str = "Composite the two nearest fragments of each pixel exactly, by depth peeling or insertion, into front: premultiplied colour, \
    and transmittance in alpha. The pass below draws them again, with front = true.";

pub(crate) fn layout(design: &Design) -> Layout {
    let layout = design.layout();
    layout.expect("recipes that are exported keep what a layout holds")
}

impl Description {
    /// Of the networks of a recipe.
    pub fn of(recipe: Recipe) -> Self {
        let three =
            "peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z, background)";
        let four = "peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z + absorbances.w, background)";
        let (passes, resolve) = match recipe.inputs {
            Inputs::Rest(_) if recipe.output == Output::AnchoredShareSeparateEnds => {
                let resolve = "peelnet_resolve(sums, ends, moments.x, background)";
                (SEPARATE_ENDS, resolve)
            }
            Inputs::Rest(_) => (ONE_SUM, "peelnet_resolve(sums, moments.x, background)"),
            Inputs::Slabs(design, _) => match layout(&design) {
                Layout::Small => (SMALL_SLABS, three),
                Layout::Medium => (MEDIUM_SLABS, three),
                Layout::Large => (LARGE_SLABS, four),
            },
            Inputs::Row(_) => (THESIS, "peelnet_resolve(sums, transmittance, background)"),
            Inputs::Moments(_) => (NMT, "peelnet_resolve(sums, totals.x, background)"),
            Inputs::Layers(_) => {
                let resolve = "peelnet_resolve(front, behind, all, count, background)";
                (DFAOIT, resolve)
            }
        };
        let targets = passes.iter().flat_map(|pass| pass.targets);
        let mut names: Vec<&str> = targets.map(|target| target.name).collect();
        names.extend(passes.iter().flat_map(|pass| pass.reads));
        let mut resolve_reads = Vec::new();
        for word in resolve.split(|c: char| !c.is_alphanumeric()) {
            if names.contains(&word) && !resolve_reads.contains(&word) {
                resolve_reads.push(word);
            }
        }
        let before = match recipe.inputs {
            Inputs::Row(_) => THESIS_BEFORE,
            Inputs::Layers(_) => DFAOIT_BEFORE,
            _ => ZETA,
        };
        Self {
            before,
            passes,
            resolve,
            resolve_reads,
            rules: RULES,
        }
    }

    /// As lines of a comment in a language, without their marks.
    pub(crate) fn lines(&self, language: Language) -> Vec<String> {
        let mut lines = vec![
            "How to draw with it. Targets may have 32 bits a channel wherever 16 are named."
                .to_owned(),
            format!("0. {}", self.before),
        ];
        for (k, pass) in (1..).zip(self.passes) {
            let compute = pass.compute.map(|value| language.declare(&value));
            let (name, compute) = (pass.name, compute.unwrap_or_default());
            lines.push(format!(
                "{k}. Pass \"{name}\": draw all transparent surfaces, in any order. {compute}"
            ));
            lines.extend(pass.targets.iter().map(|target| target.line(language)));
        }
        lines.push(format!(
            "{}. Resolve: {} is the colour of the pixel, and its coverage in alpha.",
            self.passes.len() + 1,
            language.expression(self.resolve)
        ));
        lines.extend(self.rules.iter().map(|rule| format!("- {rule}")));
        lines
    }
}

impl Target {
    fn line(&self, language: Language) -> String {
        let (mut clear, last) = (&self.clear[..], &self.clear[3..]);
        if clear.iter().all(|c| *c == last[0]) {
            clear = last;
        }
        let clear: Vec<String> = clear.iter().map(f32::to_string).collect();
        let (color, alpha) = (self.color.text(), self.alpha.text());
        let blending = if color == alpha {
            color.to_owned()
        } else {
            format!("{color} for rgb, {alpha} for alpha")
        };
        format!(
            "   {}: {}, cleared to {}, blending {blending}, from {}",
            self.name,
            self.format,
            clear.join(", "),
            language.expression(self.write)
        )
    }
}
