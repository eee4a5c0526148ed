//! What a renderer must do around an exported text: the one source of the text's header and of the documents.

use crate::language::{Dialect, WGSL};
use peelnet_core::methods::slabs::{Design, Layout};
use peelnet_model::{Inputs, Output, Recipe};
use serde::Serialize;
use std::fmt::{self, Write as _};

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
        f.write_str(&WGSL.declare(self))
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
    pub resolve_reads: &'static [&'static str],
    /// What holds in all passes, and what breaks the result.
    pub rules: &'static [&'static str],
}

const fn sum(name: &'static str, format: &'static str, write: &'static str) -> Target {
    Target {
        name,
        format,
        clear: [0.0; 4],
        color: Blend::Add,
        alpha: Blend::Add,
        write,
    }
}

const ZETA: &str = "zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the \
    bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else \
    you choose. Compute zeta with this function in all passes. Its range is the same for the whole frame: \
    peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.";

const fn statistics(call: &'static str) -> Option<Value> {
    let (name, kind) = ("s", Kind::Statistics);
    Some(Value { name, kind, call })
}

const fn weight(call: &'static str) -> Option<Value> {
    let (name, kind) = ("w", Kind::Number);
    Some(Value { name, kind, call })
}

const WEIGHTED: &str = "vec4f(alpha * rgb, alpha) * w";

const RULES: &[&str] = &[
    "alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.",
    "Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.",
    "z grows with distance, also where depth buffers are reversed.",
    "With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.",
];

const ANCHORED_STATISTICS: Pass = Pass {
    name: "statistics",
    reads: &[],
    compute: statistics("peelnet_statistics(alpha, zeta)"),
    targets: &[
        sum("moments", "rgba16float", "s.moments"),
        Target {
            name: "extent",
            format: "rgba16float",
            clear: [-65504.0, -65504.0, -65504.0, 0.0],
            color: Blend::Max,
            alpha: Blend::Add,
            write: "s.extent",
        },
    ],
};

const ONE_SUM: &[Pass] = &[
    ANCHORED_STATISTICS,
    Pass {
        name: "weights",
        reads: &["moments", "extent"],
        compute: weight("peelnet_fragment(alpha, zeta, moments, extent).x"),
        targets: &[sum("sums", "rgba16float", WEIGHTED)],
    },
];

const SEPARATE_ENDS: &[Pass] = &[
    ANCHORED_STATISTICS,
    Pass {
        name: "weights",
        reads: &["moments", "extent"],
        compute: Some(Value {
            name: "f",
            kind: Kind::Pair,
            call: "peelnet_fragment(alpha, zeta, moments, extent)",
        }),
        targets: &[
            sum(
                "sums",
                "rgba16float",
                "vec4f(alpha * rgb, alpha) * (f.x * (1.0 - min(f.y, 1.0)))",
            ),
            sum(
                "ends",
                "rgba16float",
                "vec4f(alpha * rgb, alpha) * (f.x * min(f.y, 1.0))",
            ),
        ],
    },
];

const fn most(name: &'static str, format: &'static str, clear: f32, write: &'static str) -> Target {
    Target {
        name,
        format,
        clear: [clear; 4],
        color: Blend::Max,
        alpha: Blend::Max,
        write,
    }
}

const RANGE: Pass = Pass {
    name: "range",
    reads: &[],
    compute: Some(Value {
        name: "r",
        kind: Kind::Pair,
        call: "peelnet_pixel_range(zeta)",
    }),
    targets: &[most("range", "rg8unorm", 0.0, "r")],
};

/// What levels are cleared to.
const LEAST: f32 = -65504.0;

const ABSORBANCES: Target = sum("absorbances", "rgba16float", "s.absorbances");

const NEAREST: Target = most("nearest", "rgba16float", LEAST, "s.nearest");

const fn most_and_sum(name: &'static str, write: &'static str) -> Target {
    Target {
        name,
        format: "rgba16float",
        clear: [LEAST, LEAST, LEAST, 0.0],
        color: Blend::Max,
        alpha: Blend::Add,
        write,
    }
}

const IN_RANGE: Option<Value> = statistics("peelnet_statistics(alpha, zeta, range)");

const SUMS: &[Target] = &[sum("sums", "rgba16float", WEIGHTED)];

const fn slab_weights(reads: &'static [&'static str], call: &'static str) -> Pass {
    Pass {
        name: "weights",
        reads,
        compute: weight(call),
        targets: SUMS,
    }
}

const SMALL_SLABS: &[Pass] = &[
    RANGE,
    Pass {
        name: "statistics",
        reads: &["range"],
        compute: IN_RANGE,
        targets: &[ABSORBANCES, NEAREST, sum("firsts", "rg16float", "s.firsts")],
    },
    slab_weights(
        &["range", "absorbances", "nearest", "firsts"],
        "peelnet_fragment(alpha, zeta, range, absorbances, nearest, firsts).x",
    ),
];

const MEDIUM_SLABS: &[Pass] = &[
    RANGE,
    Pass {
        name: "statistics",
        reads: &["range"],
        compute: IN_RANGE,
        targets: &[
            ABSORBANCES,
            most_and_sum("nearest", "s.nearest"),
            most_and_sum("farthest", "s.farthest"),
        ],
    },
    slab_weights(
        &["range", "absorbances", "nearest", "farthest"],
        "peelnet_fragment(alpha, zeta, range, absorbances, nearest, farthest).x",
    ),
];

const LARGE_SLABS: &[Pass] = &[
    RANGE,
    Pass {
        name: "statistics",
        reads: &["range"],
        compute: IN_RANGE,
        targets: &[
            ABSORBANCES,
            NEAREST,
            most("farthest", "rgba16float", LEAST, "s.farthest"),
            sum("firsts", "rgba16float", "s.firsts"),
        ],
    },
    slab_weights(
        &["range", "absorbances", "nearest", "farthest", "firsts"],
        "peelnet_fragment(alpha, zeta, range, absorbances, nearest, farthest, firsts).x",
    ),
];

const THESIS: &[Pass] = &[
    Pass {
        name: "statistics",
        reads: &[],
        compute: None,
        targets: &[sum("statistics", "rg16float", "peelnet_statistics(alpha)")],
    },
    Pass {
        name: "weights",
        reads: &["statistics"],
        compute: weight("peelnet_fragment(z, statistics)"),
        targets: &[
            sum("sums", "rgba16float", WEIGHTED),
            Target {
                name: "transmittance",
                format: "r16float",
                clear: [1.0; 4],
                color: Blend::Transmit,
                alpha: Blend::Transmit,
                write: "alpha",
            },
        ],
    },
];

const NMT: &[Pass] = &[
    Pass {
        name: "statistics",
        reads: &[],
        compute: statistics("peelnet_statistics(alpha, zeta)"),
        targets: &[
            sum("totals", "rgba32float", "s.totals"),
            sum("moments", "rgba32float", "s.moments"),
            Target {
                name: "extent",
                format: "rg32float",
                clear: [-65504.0; 4],
                color: Blend::Max,
                alpha: Blend::Max,
                write: "s.extent",
            },
        ],
    },
    Pass {
        name: "weights",
        reads: &["totals", "moments", "extent"],
        compute: weight("peelnet_fragment(zeta, totals, moments, extent)"),
        targets: &[sum("sums", "rgba32float", WEIGHTED)],
    },
];

const DFAOIT: &[Pass] = &[Pass {
    name: "statistics",
    reads: &["front"],
    compute: statistics("peelnet_statistics(vec4f(rgb, alpha), front)"),
    targets: &[
        sum("behind", "rgba16float", "s.behind"),
        Target {
            name: "all",
            format: "rgba16float",
            clear: [0.0, 0.0, 0.0, 1.0],
            color: Blend::Add,
            alpha: Blend::Transmit,
            write: "s.all",
        },
        sum("count", "r16float", "s.count"),
    ],
}];

const THESIS_BEFORE: &str = "z is the distance along the view axis, in the unit of the scenes that the network was trained on.";

const DFAOIT_BEFORE: &str = "Composite the two nearest fragments of each pixel exactly, by depth peeling or insertion, into front: premultiplied colour, \
    and transmittance in alpha. The pass below draws them again, with front = true.";

/// The layout of a recipe's design.
pub(crate) fn layout(design: &Design) -> Layout {
    let layout = design.layout();
    layout.expect("recipes that are exported keep what a layout holds")
}

impl Description {
    /// Of the networks of a recipe.
    pub fn of(recipe: Recipe) -> Self {
        let (before, passes, resolve, resolve_reads): (_, _, _, &[_]) = match (
            recipe.inputs,
            recipe.output,
        ) {
            (Inputs::Rest(_), Output::AnchoredShareSeparateEnds) => (
                ZETA,
                SEPARATE_ENDS,
                "peelnet_resolve(sums, ends, moments.x, background)",
                &["sums", "ends", "moments"],
            ),
            (Inputs::Rest(_), _) => (
                ZETA,
                ONE_SUM,
                "peelnet_resolve(sums, moments.x, background)",
                &["sums", "moments"],
            ),
            (Inputs::Slabs(design, _), _) => {
                let three = "peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z, background)";
                let four = "peelnet_resolve(sums, absorbances.x + absorbances.y + absorbances.z + absorbances.w, background)";
                let (passes, resolve) = match layout(&design) {
                    Layout::Small => (SMALL_SLABS, three),
                    Layout::Medium => (MEDIUM_SLABS, three),
                    Layout::Large => (LARGE_SLABS, four),
                };
                (ZETA, passes, resolve, &["sums", "absorbances"])
            }
            (Inputs::Row(_), _) => (
                THESIS_BEFORE,
                THESIS,
                "peelnet_resolve(sums, transmittance, background)",
                &["sums", "transmittance"],
            ),
            (Inputs::Moments(_), _) => (
                ZETA,
                NMT,
                "peelnet_resolve(sums, totals.x, background)",
                &["sums", "totals"],
            ),
            (Inputs::Layers(_), _) => (
                DFAOIT_BEFORE,
                DFAOIT,
                "peelnet_resolve(front, behind, all, count, background)",
                &["front", "behind", "all", "count"],
            ),
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
    pub(crate) fn lines(&self, dialect: &dyn Dialect) -> Vec<String> {
        let mut lines = vec![
            "How to draw with it. Targets may have 32 bits a channel wherever 16 are named."
                .to_owned(),
            format!("0. {}", self.before),
        ];
        for (k, pass) in (1..).zip(self.passes) {
            let compute = pass.compute.map(|value| dialect.declare(&value));
            lines.push(format!(
                "{k}. Pass \"{}\": draw all transparent surfaces, in any order. {}",
                pass.name,
                compute.unwrap_or_default()
            ));
            for target in pass.targets {
                lines.push(format!("   {}", target.line(dialect)));
            }
        }
        lines.push(format!(
            "{}. Resolve: {} is the colour of the pixel, and its coverage in alpha.",
            self.passes.len() + 1,
            dialect.expression(self.resolve)
        ));
        lines.extend(self.rules.iter().map(|rule| format!("- {rule}")));
        lines
    }

    /// As a section of a document.
    pub fn markdown(&self) -> String {
        let mut t = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(t, "**0. Before.** {}\n", self.before);
        for (k, pass) in (1..).zip(self.passes) {
            let compute = pass.compute.map_or_else(String::new, |value| {
                format!(" Each fragment computes `{value}`")
            });
            let _ = writeln!(
                t,
                "**{k}. Pass `{}`.** Draw all transparent surfaces, in any order.{compute}\n\n\
                 | target | format | clear | blend | each fragment writes |\n|---|---|---|---|---|",
                pass.name
            );
            for target in pass.targets {
                let _ = writeln!(
                    t,
                    "| `{}` | `{}` | {} | {} | `{}` |",
                    target.name,
                    target.format,
                    target.clear_text(),
                    target.blend_text(),
                    target.write
                );
            }
            t.push('\n');
        }
        let _ = writeln!(
            t,
            "**{}. Resolve.** `{}` is the colour of the pixel, and its coverage in alpha.\n",
            self.passes.len() + 1,
            self.resolve
        );
        for rule in self.rules {
            let _ = writeln!(t, "- {rule}");
        }
        t
    }
}

impl Target {
    fn line(&self, dialect: &dyn Dialect) -> String {
        format!(
            "{}: {}, cleared to {}, blending {}, from {}",
            self.name,
            self.format,
            self.clear_text(),
            self.blend_text(),
            dialect.expression(self.write)
        )
    }

    fn clear_text(&self) -> String {
        if self.clear.iter().all(|c| *c == self.clear[0]) {
            return self.clear[0].to_string();
        }
        self.clear.map(|c| c.to_string()).join(", ")
    }

    fn blend_text(&self) -> String {
        if self.color == self.alpha {
            self.color.text().to_owned()
        } else {
            format!(
                "{} for rgb, {} for alpha",
                self.color.text(),
                self.alpha.text()
            )
        }
    }
}
