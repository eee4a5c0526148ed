//! What a renderer must do around an exported text: the one source of the text's header and of the documents.

use peelnet_core::methods::slabs::{Design, Layout};
use peelnet_model::{Inputs, Output, Recipe};
use serde::Serialize;
use std::fmt::Write as _;

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

/// A pass that draws all transparent surfaces, in any order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pass {
    /// Its name.
    pub name: &'static str,
    /// What each fragment computes first.
    pub compute: &'static str,
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

const WEIGHTED: &str = "vec4f(alpha * rgb, alpha) * w";

const RULES: &[&str] = &[
    "alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.",
    "Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.",
    "z grows with distance, also where depth buffers are reversed.",
    "With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.",
];

const ANCHORED_STATISTICS: Pass = Pass {
    name: "statistics",
    compute: "let s = peelnet_statistics(alpha, zeta);",
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
        compute: "let w = peelnet_fragment(alpha, zeta, moments, extent).x;",
        targets: &[sum("sums", "rgba16float", WEIGHTED)],
    },
];

const SEPARATE_ENDS: &[Pass] = &[
    ANCHORED_STATISTICS,
    Pass {
        name: "weights",
        compute: "let f = peelnet_fragment(alpha, zeta, moments, extent); let w = f.x; let end = f.y > 0.0;",
        targets: &[
            sum(
                "sums",
                "rgba16float",
                "select(vec4f(alpha * rgb, alpha) * w, vec4f(0.0), end)",
            ),
            sum(
                "ends",
                "rgba16float",
                "select(vec4f(0.0), vec4f(alpha * rgb, alpha) * w, end)",
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
    compute: "let r = peelnet_pixel_range(zeta);",
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

const SLABS_COMPUTE: &str = "let s = peelnet_statistics(alpha, zeta, range);";

const SUMS: &[Target] = &[sum("sums", "rgba16float", WEIGHTED)];

const fn slab_weights(compute: &'static str) -> Pass {
    Pass {
        name: "weights",
        compute,
        targets: SUMS,
    }
}

const SMALL_SLABS: &[Pass] = &[
    RANGE,
    Pass {
        name: "statistics",
        compute: SLABS_COMPUTE,
        targets: &[ABSORBANCES, NEAREST, sum("firsts", "rg16float", "s.firsts")],
    },
    slab_weights("let w = peelnet_fragment(alpha, zeta, range, absorbances, nearest, firsts).x;"),
];

const MEDIUM_SLABS: &[Pass] = &[
    RANGE,
    Pass {
        name: "statistics",
        compute: SLABS_COMPUTE,
        targets: &[
            ABSORBANCES,
            most_and_sum("nearest", "s.nearest"),
            most_and_sum("farthest", "s.farthest"),
        ],
    },
    slab_weights("let w = peelnet_fragment(alpha, zeta, range, absorbances, nearest, farthest).x;"),
];

const LARGE_SLABS: &[Pass] = &[
    RANGE,
    Pass {
        name: "statistics",
        compute: SLABS_COMPUTE,
        targets: &[
            ABSORBANCES,
            NEAREST,
            most("farthest", "rgba16float", LEAST, "s.farthest"),
            sum("firsts", "rgba16float", "s.firsts"),
        ],
    },
    slab_weights(
        "let w = peelnet_fragment(alpha, zeta, range, absorbances, nearest, farthest, firsts).x;",
    ),
];

const THESIS: &[Pass] = &[
    Pass {
        name: "statistics",
        compute: "",
        targets: &[sum("statistics", "rg16float", "peelnet_statistics(alpha)")],
    },
    Pass {
        name: "weights",
        compute: "let w = peelnet_fragment(z, statistics);",
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
        compute: "let s = peelnet_statistics(alpha, zeta);",
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
        compute: "let w = peelnet_fragment(zeta, totals, moments, extent);",
        targets: &[sum("sums", "rgba32float", WEIGHTED)],
    },
];

const DFAOIT: &[Pass] = &[Pass {
    name: "statistics",
    compute: "let s = peelnet_statistics(vec4f(rgb, alpha), front);",
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

/// The layout of a recipe's design.
pub(crate) fn layout(design: &Design) -> Layout {
    let layout = design.layout();
    layout.expect("recipes that are exported keep what a layout holds")
}

impl Description {
    /// Of the networks of a recipe.
    pub fn of(recipe: Recipe) -> Self {
        let (before, passes, resolve) = match (recipe.inputs, recipe.output) {
            (Inputs::Rest(_), Output::AnchoredShareSeparateEnds) => (
                ZETA,
                SEPARATE_ENDS,
                "peelnet_resolve(sums, ends, moments.x, background)",
            ),
            (Inputs::Rest(_), _) => (
                ZETA,
                ONE_SUM,
                "peelnet_resolve(sums, moments.x, background)",
            ),
            (Inputs::Slabs(design, _), _) => {
                let three = "peelnet_resolve(sums, dot(absorbances.xyz, vec3f(1.0)), background)";
                let four = "peelnet_resolve(sums, dot(absorbances, vec4f(1.0)), background)";
                let (passes, resolve) = match layout(&design) {
                    Layout::Small => (SMALL_SLABS, three),
                    Layout::Medium => (MEDIUM_SLABS, three),
                    Layout::Large => (LARGE_SLABS, four),
                };
                (ZETA, passes, resolve)
            }
            (Inputs::Row(_), _) => (
                "z is the distance along the view axis, in the unit of the scenes that the network was trained on.",
                THESIS,
                "peelnet_resolve(sums, transmittance, background)",
            ),
            (Inputs::Moments(_), _) => (ZETA, NMT, "peelnet_resolve(sums, totals.x, background)"),
            (Inputs::Layers(_), _) => (
                "Composite the two nearest fragments of each pixel exactly, by depth peeling or insertion, into front: premultiplied colour, \
                 and transmittance in alpha. The pass below draws them again, with front = true.",
                DFAOIT,
                "peelnet_resolve(front, behind, all, count, background)",
            ),
        };
        Self {
            before,
            passes,
            resolve,
            rules: RULES,
        }
    }

    /// As lines of a comment, without their marks.
    pub(crate) fn lines(&self) -> Vec<String> {
        let mut lines = vec![
            "How to draw with it. Targets may have 32 bits a channel wherever 16 are named."
                .to_owned(),
            format!("0. {}", self.before),
        ];
        for (k, pass) in (1..).zip(self.passes) {
            lines.push(format!(
                "{k}. Pass \"{}\": draw all transparent surfaces, in any order. {}",
                pass.name, pass.compute
            ));
            for target in pass.targets {
                lines.push(format!("   {}", target.line()));
            }
        }
        lines.push(format!(
            "{}. Resolve: {} is the colour of the pixel, and its coverage in alpha.",
            self.passes.len() + 1,
            self.resolve
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
            let compute = match pass.compute {
                "" => String::new(),
                code => format!(" Each fragment computes `{code}`"),
            };
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
    fn line(&self) -> String {
        format!(
            "{}: {}, cleared to {}, blending {}, from {}",
            self.name,
            self.format,
            self.clear_text(),
            self.blend_text(),
            self.write
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
