//! Every method by name: one file each behind [`Compositor`].
//!
//! [`MethodSpec`] is a parsed name with its knobs; [`METHODS`] is the list that names, help texts, benchmarks and
//! tests are made from. Adding a method is one file here, one shader folder, and one line of that list.

pub mod abuffer;
mod anchored;
mod commutative;
mod deep_thesis;
pub mod depth_peel;
mod dfaoit;
pub mod dual_peel;
mod kbuffer;
pub mod layers;
mod linked_list;
mod low_resolution;
mod mboit;
mod nmt;
mod painter;
mod stochastic;
mod wavelet;
mod weighted;

use crate::{
    LearnedWeight, RenderError,
    scene::{FrameTargets, SceneBuffers},
};
use peelnet_core::weights::Weight;
use peelnet_gpu::{Gpu, record::Recorder};
use peelnet_scene::Camera;
use std::{collections::BTreeMap, fmt, str::FromStr};

/// What a method reports of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Transparent fragments of the frame, where the method counts them.
    pub fragments: Option<u64>,
    /// Fragments of the fullest pixel, where the method counts them.
    pub max_layers: Option<u32>,
    /// Fragments that the method did not composite: coplanar ones in dual peeling, those beyond a cap on passes.
    pub lost: u64,
    /// Tiles that the frame was drawn in.
    pub tiles: u32,
    /// Passes over the transparent geometry.
    pub geometry_passes: u32,
    /// Passes over the pixels.
    pub fullscreen_passes: u32,
    /// Bytes that the method allocates a pixel, beyond colour target and `C_0`; storage per fragment included.
    pub bytes_per_pixel: f64,
}

/// What a compositor draws with.
#[derive(Debug)]
pub struct DrawContext<'a, 'g> {
    /// Records and measures passes.
    pub recorder: &'a mut Recorder<'g>,
    /// The scene.
    pub scene: &'a SceneBuffers,
    /// The view.
    pub camera: &'a Camera,
    /// `C_0` and the image to write.
    pub frame: &'a FrameTargets,
    /// Whether to count what statistics need and compositing does not.
    pub counting: bool,
}

/// A method made ready for one scene and frame size.
pub trait Compositor: fmt::Debug {
    /// Composites the transparent fragments over `C_0` into the frame's image.
    ///
    /// # Errors
    /// A lost device, or a frame beyond the adapter's limits.
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError>;
}

/// A method of the list.
#[derive(Clone, Copy, Debug)]
pub struct MethodEntry {
    /// Its name.
    pub name: &'static str,
    /// One line for help texts.
    pub about: &'static str,
    /// What a benchmark of all methods draws: endings of its name, the default first.
    pub points: &'static [&'static str],
    /// Largest number that the name ends in, as in `kbuffer-8`; 0 for a name that stands alone.
    pub most: u32,
    /// Names of its own knobs, with the values they take; see [`MethodEntry::knobs`] for all.
    own_knobs: &'static [(&'static str, &'static str)],
    /// Whether it draws with a trained network.
    pub learned: bool,
    /// Whether it is exact by definition.
    pub exact: bool,
    /// Whether it draws light that takes a colour where it passes through surfaces.
    pub tinted: bool,
    build: fn(&Build<'_>) -> Result<Box<dyn Compositor>, RenderError>,
}

impl MethodEntry {
    /// The name that stands for it where one is enough: by itself, or with a number in the middle of its curve.
    pub fn representative(&self) -> String {
        let middle = self.points[self.points.len() / 2];
        let ending = if self.most > 0 { middle } else { "" };
        format!("{}{ending}", self.name)
    }

    /// Names of its knobs, with the values they take: its own, and what every method has.
    pub fn knobs(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.own_knobs.iter().copied().chain([SCALE])
    }
}

/// What a method is built from.
pub(crate) struct Build<'a> {
    pub gpu: &'a Gpu,
    pub scene: &'a SceneBuffers,
    pub frame: &'a FrameTargets,
    pub spec: &'a MethodSpec,
    pub learned: Option<&'a LearnedWeight>,
}

impl Build<'_> {
    /// The text that a learned method draws with.
    ///
    /// # Errors
    /// No model, or one that was trained for another method.
    pub(crate) fn learned_weight(&self) -> Result<&LearnedWeight, RenderError> {
        let learned = self
            .learned
            .ok_or_else(|| RenderError::NeedsModel(self.spec.to_string()))?;
        let method = learned.recipe.method_name();
        if method != self.spec.name() {
            return Err(RenderError::Knob {
                method: self.spec.to_string(),
                message: format!(
                    "the model given was trained for method {method}; use that method, or another model"
                ),
            });
        }
        Ok(learned)
    }
}

const TARGETS: (&str, &str) = ("targets", "f16 (default) or f32");
const MOMENT_TARGETS: (&str, &str) = (
    "targets",
    "f16 or f32 for all; by default 32-bit moments and 16-bit sums",
);
const SCALE: (&str, &str) = (
    "scale",
    "of the resolution that transparency is drawn at, 1 by default; upsampled by depth",
);
const PASSES: (&str, &str) = ("passes", "a cap on the number of peeling passes");

macro_rules! wboit {
    ($name:literal, $weight:expr, $about:literal, [$($knob:expr),*] $(, $point:literal)*) => {
        MethodEntry {
            name: $name,
            about: $about,
            points: &["", ":targets=f32" $(, $point)*],
            most: 0,
            own_knobs: &[TARGETS $(, $knob)*],
            learned: false,
            exact: false,
            tinted: true,
            build: |b| weighted::wboit(b, $weight),
        }
    };
}

/// Every method there is.
pub const METHODS: &[MethodEntry] = &[
    MethodEntry {
        name: "abuffer",
        about: "exact: S-buffer, every fragment stored and sorted",
        points: &["", ":scale=0.5"],
        most: 0,
        own_knobs: &[("budget", "fragments that one tile may hold")],
        learned: false,
        exact: true,
        tinted: true,
        build: abuffer::build,
    },
    MethodEntry {
        name: "linked-list",
        about: "exact: one pass into a list for each pixel, sorted by relinking",
        points: &[""],
        most: 0,
        own_knobs: &[("nodes", "size of the first pool; it grows as needed")],
        learned: false,
        exact: true,
        tinted: true,
        build: linked_list::build,
    },
    MethodEntry {
        name: "depth-peel",
        about: "exact: front to back, one layer a pass",
        points: &["", ":passes=2", ":passes=4", ":passes=8"],
        most: 0,
        own_knobs: &[PASSES],
        learned: false,
        exact: true,
        tinted: false,
        build: depth_peel::build,
    },
    MethodEntry {
        name: "dual-peel",
        about: "exact but for coplanar fragments: both ends, two layers a pass",
        points: &["", ":passes=2", ":passes=4"],
        most: 0,
        own_knobs: &[PASSES],
        learned: false,
        exact: true,
        tinted: false,
        build: dual_peel::build,
    },
    MethodEntry {
        name: "painter-object",
        about: "objects sorted on the CPU, hardware blending",
        points: &["", ":sort=off"],
        most: 0,
        own_knobs: &[
            TARGETS,
            (
                "sort",
                "on (default) or off: hardware blending in the scene's order",
            ),
        ],
        learned: false,
        exact: false,
        tinted: false,
        build: painter::objects,
    },
    MethodEntry {
        name: "painter-triangle",
        about: "triangles sorted on the CPU, hardware blending",
        points: &[""],
        most: 0,
        own_knobs: &[TARGETS],
        learned: false,
        exact: false,
        tinted: false,
        build: painter::triangles,
    },
    MethodEntry {
        name: "weighted-sum",
        about: "Meshkin 2007",
        points: &[""],
        most: 0,
        own_knobs: &[TARGETS],
        learned: false,
        exact: false,
        tinted: false,
        build: weighted::sum,
    },
    MethodEntry {
        name: "weighted-average",
        about: "Bavoil & Myers 2008",
        points: &[""],
        most: 0,
        own_knobs: &[TARGETS],
        learned: false,
        exact: false,
        tinted: false,
        build: weighted::average,
    },
    MethodEntry {
        name: "blended",
        about: "McGuire & Bavoil 2013, eq 5",
        points: &[""],
        most: 0,
        own_knobs: &[TARGETS],
        learned: false,
        exact: false,
        tinted: true,
        build: weighted::blended,
    },
    wboit!(
        "wboit-eq7",
        |_| Ok(Weight::Eq7),
        "McGuire & Bavoil 2013, eq 6 with weight 7",
        []
    ),
    wboit!(
        "wboit-eq8",
        |_| Ok(Weight::Eq8),
        "McGuire & Bavoil 2013, eq 6 with weight 8",
        []
    ),
    wboit!(
        "wboit-eq9",
        |_| Ok(Weight::Eq9),
        "McGuire & Bavoil 2013, eq 6 with weight 9",
        [],
        ":scale=0.5"
    ),
    wboit!(
        "wboit-eq10",
        |s| Ok(Weight::Eq10 {
            factor: s.number("factor", 3e3)?
        }),
        "McGuire & Bavoil 2013, eq 6 with weight 10",
        [("factor", "largest weight, 3e3 by default")]
    ),
    wboit!(
        "wboit-papakostas",
        |_| Ok(Weight::Papakostas),
        "eq 6 with the weight of Papakostas 2022",
        []
    ),
    wboit!(
        "wboit-inverse-power",
        |s| Ok(Weight::InversePower {
            k: s.number("k", 2.0)?.round().clamp(0.0, 16.0) as u32,
            epsilon: s.number("epsilon", 5.0)?
        }),
        "eq 6 with (z + epsilon)^-k",
        [
            ("k", "a whole exponent, 2 by default"),
            ("epsilon", "offset in scene units, 5 by default")
        ]
    ),
    MethodEntry {
        name: "mboit4",
        about: "Münstermann et al. 2018, four power moments",
        points: &[
            "",
            ":targets=f16",
            ":overestimation=0.5",
            ":own=out",
            ":scale=0.5",
        ],
        most: 0,
        own_knobs: &[
            MOMENT_TARGETS,
            ("overestimation", "0.25 by default"),
            ("bias", "5e-7 by default, 6e-5 with 16-bit moments"),
            (
                "own",
                "in (default, as published) or out: a fragment's own absorbance",
            ),
        ],
        learned: false,
        exact: false,
        tinted: true,
        build: mboit::four,
    },
    MethodEntry {
        name: "mboit6",
        about: "Münstermann et al. 2018, six power moments",
        points: &["", ":own=out"],
        most: 0,
        own_knobs: &[
            MOMENT_TARGETS,
            ("overestimation", "0.25 by default"),
            ("bias", "5e-6 by default, 6e-4 with 16-bit moments"),
            (
                "own",
                "in (default, as published) or out: a fragment's own absorbance",
            ),
        ],
        learned: false,
        exact: false,
        tinted: true,
        build: mboit::six,
    },
    MethodEntry {
        name: "wavelet-3",
        about: "Aizenshtein, Smal & McGuire 2022, Haar wavelets of rank 3",
        points: &["", ":own=in"],
        most: 0,
        own_knobs: &[("own", "out (default) or in: a fragment's own absorbance")],
        learned: false,
        exact: false,
        tinted: false,
        build: wavelet::build,
    },
    MethodEntry {
        name: "kbuffer",
        about: "the K nearest exactly, the rest blended by eq 5",
        points: &["-2", "-4", "-8"],
        most: 64,
        own_knobs: &[TARGETS],
        learned: false,
        exact: false,
        tinted: false,
        build: kbuffer::plain,
    },
    MethodEntry {
        name: "hybrid",
        about: "the K nearest exactly, the rest blended by eq 6",
        points: &["-2", "-4", "-8"],
        most: 64,
        own_knobs: &[
            TARGETS,
            ("weight", "of the tail: eq9 (default), eq7 or eq8"),
        ],
        learned: false,
        exact: false,
        tinted: false,
        build: kbuffer::hybrid,
    },
    MethodEntry {
        name: "stochastic",
        about: "Enderton et al. 2010, S screen-door samples with alpha correction",
        points: &["-4", "-16", "-64"],
        most: 256,
        own_knobs: &[TARGETS],
        learned: false,
        exact: false,
        tinted: false,
        build: stochastic::build,
    },
    MethodEntry {
        name: "deep-thesis",
        about: "Papakostas 2022: eq 6 with a network's weight",
        points: &[""],
        most: 0,
        own_knobs: &[TARGETS],
        learned: true,
        exact: false,
        tinted: false,
        build: deep_thesis::build,
    },
    MethodEntry {
        name: "nmt",
        about: "Tsopouridis et al. 2024: a network reads four moments",
        points: &["", ":targets=f16"],
        most: 0,
        own_knobs: &[MOMENT_TARGETS],
        learned: true,
        exact: false,
        tinted: false,
        build: nmt::build,
    },
    MethodEntry {
        name: "dfaoit",
        about: "Tsopouridis et al. 2024: two layers exact, the colour of the rest from a network",
        points: &[""],
        most: 0,
        own_knobs: &[TARGETS],
        learned: true,
        exact: false,
        tinted: false,
        build: dfaoit::build,
    },
    MethodEntry {
        name: "deep-small",
        about: "a learned share of what lies between the pixel's ends, 5-8-1",
        points: &["", ":targets=f32"],
        most: 0,
        own_knobs: &[TARGETS],
        learned: true,
        exact: false,
        tinted: true,
        build: anchored::build,
    },
    MethodEntry {
        name: "deep-medium",
        about: "the same with exact ends, 5-12-1: the one to ship",
        points: &["", ":targets=f32", ":scale=0.5"],
        most: 0,
        own_knobs: &[TARGETS],
        learned: true,
        exact: false,
        tinted: true,
        build: anchored::build,
    },
    MethodEntry {
        name: "deep-large",
        about: "the same with more features, 9-14-9-1: the most accurate",
        points: &["", ":targets=f16", ":scale=0.5"],
        most: 0,
        own_knobs: &[MOMENT_TARGETS],
        learned: true,
        exact: false,
        tinted: true,
        build: anchored::build,
    },
];

/// A method's name with its knobs, such as `wboit-eq10:factor=3e4,targets=f32`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MethodSpec {
    name: &'static str,
    /// The number that the name ends in, where it ends in one.
    size: Option<u32>,
    knobs: BTreeMap<String, String>,
}

impl MethodSpec {
    /// Every method that draws without a model, with default knobs.
    pub fn all() -> Vec<Self> {
        METHODS
            .iter()
            .filter(|m| !m.learned)
            .filter_map(|m| Self::points(m).next())
            .collect()
    }

    /// Every method with the knobs that belong to its curve of error against time.
    pub fn curve() -> Vec<Self> {
        METHODS.iter().flat_map(Self::points).collect()
    }

    fn points(entry: &'static MethodEntry) -> impl Iterator<Item = Self> {
        let name = entry.name;
        // A test parses them all.
        entry
            .points
            .iter()
            .filter_map(move |ending| format!("{name}{ending}").parse().ok())
    }

    /// The method's name without number and knobs.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Whether it draws with a trained network.
    pub fn needs_model(&self) -> bool {
        self.entry().learned
    }

    /// Its entry in the list.
    pub fn entry(&self) -> &'static MethodEntry {
        // Parsing found the name in the list.
        METHODS
            .iter()
            .find(|m| m.name == self.name)
            .unwrap_or(&METHODS[0])
    }

    /// The number that the name ends in; 0 where it ends in none.
    pub fn size(&self) -> u32 {
        self.size.unwrap_or_default()
    }

    /// The text of a knob that was given.
    pub fn knob(&self, name: &str) -> Option<&str> {
        self.knobs.get(name).map(String::as_str)
    }

    /// A knob that is a finite number.
    pub(crate) fn number(&self, knob: &str, default: f32) -> Result<f32, RenderError> {
        let Some(text) = self.knobs.get(knob) else {
            return Ok(default);
        };
        text.parse()
            .ok()
            .filter(|x: &f32| x.is_finite())
            .ok_or_else(|| self.bad(&format!("{knob} must be a number, not '{text}'")))
    }

    /// A knob that is a positive whole number.
    pub(crate) fn count(&self, knob: &str) -> Result<Option<u64>, RenderError> {
        let Some(text) = self.knobs.get(knob) else {
            return Ok(None);
        };
        match text.parse() {
            Ok(n) if n > 0 => Ok(Some(n)),
            _ => Err(self.bad(&format!(
                "{knob} must be a positive whole number, not '{text}'"
            ))),
        }
    }

    /// Whether 16- or 32-bit targets are asked for; `None` leaves it to the method.
    pub(crate) fn full_precision(&self) -> Result<Option<bool>, RenderError> {
        match self.knobs.get("targets").map(String::as_str) {
            None => Ok(None),
            Some("f16") => Ok(Some(false)),
            Some("f32") => Ok(Some(true)),
            Some(other) => Err(self.bad(&format!("targets must be f16 or f32, not '{other}'"))),
        }
    }

    /// A knob that is one of some words; the first is the default.
    pub(crate) fn word(
        &self,
        knob: &str,
        words: &[&'static str],
    ) -> Result<&'static str, RenderError> {
        let given = self.knobs.get(knob).map_or(words[0], String::as_str);
        words.iter().find(|w| **w == given).copied().ok_or_else(|| {
            self.bad(&format!(
                "{knob} must be one of {}, not '{given}'",
                words.join(", ")
            ))
        })
    }

    fn bad(&self, message: &str) -> RenderError {
        RenderError::Knob {
            method: self.name.to_owned(),
            message: message.to_owned(),
        }
    }
}

impl FromStr for MethodSpec {
    type Err = RenderError;

    fn from_str(text: &str) -> Result<Self, RenderError> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let unknown = || RenderError::UnknownMethod {
            name: name.to_owned(),
            known: METHODS
                .iter()
                .map(|m| format!("{}{}", m.name, if m.most > 0 { "-N" } else { "" }))
                .collect::<Vec<_>>()
                .join(", "),
        };
        let of = |name: &str, numbered: bool| {
            METHODS
                .iter()
                .find(|m| m.name == name && (m.most > 0) == numbered)
        };
        let numbered = || {
            let (name, size) = name.rsplit_once('-')?;
            Some((of(name, true)?, size))
        };
        let (entry, size) = match (of(name, false), numbered()) {
            (Some(entry), _) => (entry, None),
            (None, Some((entry, size))) => (entry, Some(size)),
            (None, None) => return Err(unknown()),
        };
        let mut spec = Self {
            name: entry.name,
            size: None,
            knobs: BTreeMap::new(),
        };
        if let Some(size) = size {
            match size.parse() {
                Ok(n) if (1..=entry.most).contains(&n) => spec.size = Some(n),
                _ => {
                    return Err(spec.bad(&format!(
                        "the number behind '{}-' must be 1 to {}, not '{size}'",
                        entry.name, entry.most
                    )));
                }
            }
        }
        for pair in rest.split(',').filter(|p| !p.is_empty()) {
            let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
            if !entry.knobs().any(|(k, _)| k == key) {
                let known: Vec<_> = entry.knobs().map(|(k, v)| format!("{k} ({v})")).collect();
                return Err(spec.bad(&format!(
                    "there is no knob '{key}'; there are: {}",
                    known.join(", ")
                )));
            }
            spec.knobs.insert(key.to_owned(), value.to_owned());
        }
        Ok(spec)
    }
}

impl fmt::Display for MethodSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)?;
        if let Some(size) = self.size {
            write!(f, "-{size}")?;
        }
        for (i, (key, value)) in self.knobs.iter().enumerate() {
            write!(f, "{}{key}={value}", if i == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}

/// Makes a method ready.
pub(crate) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    // What a scene asks for concerns estimates; what judges them stays exact unless it is asked itself.
    let default = if b.spec.entry().exact {
        1.0
    } else {
        b.scene.transparency_scale
    };
    let scale = b.spec.number("scale", default)?;
    if !(scale > 0.0 && scale <= 1.0) {
        return Err(b
            .spec
            .bad("scale must be above 0 and at most 1, such as 0.5"));
    }
    if b.scene.tinted && (!b.spec.entry().tinted || scale < 1.0) {
        return Err(RenderError::OneTransmittance(b.spec.to_string()));
    }
    if scale < 1.0 {
        low_resolution::build(b, scale)
    } else {
        (b.spec.entry().build)(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_knobs_round_trip() {
        for text in [
            "abuffer",
            "wboit-eq10:factor=3e4,targets=f32",
            "deep-thesis:targets=f32",
            "kbuffer-8",
            "hybrid-4:weight=eq7",
        ] {
            assert_eq!(
                text.parse::<MethodSpec>().expect("parses").to_string(),
                text
            );
        }
    }

    #[test]
    fn unknown_names_and_knobs_are_refused_with_what_there_is() {
        let e = "wbiot".parse::<MethodSpec>().expect_err("typo");
        assert!(e.to_string().contains("wboit-eq9"), "{e}");
        let e = "abuffer:targets=f32"
            .parse::<MethodSpec>()
            .expect_err("no such knob");
        assert!(e.to_string().contains("budget"), "{e}");
        let spec: MethodSpec = "depth-peel:passes=0".parse().expect("parses");
        assert!(spec.count("passes").is_err());
    }

    #[test]
    fn every_point_of_every_curve_parses() {
        let points: usize = METHODS.iter().map(|m| m.points.len()).sum();
        assert_eq!(MethodSpec::curve().len(), points);
        assert!(METHODS.iter().all(|m| !m.points.is_empty()));
    }

    #[test]
    fn numbers_are_checked() {
        for bad in ["kbuffer", "kbuffer-", "kbuffer-0", "kbuffer-65", "mboit4-2"] {
            assert!(bad.parse::<MethodSpec>().is_err(), "{bad}");
        }
        let e = "kbuffer-900".parse::<MethodSpec>().expect_err("too many");
        assert!(e.to_string().contains("1 to 64"), "{e}");
    }

    #[test]
    fn names_are_unique() {
        let mut names: Vec<_> = METHODS.iter().map(|m| m.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), METHODS.len());
    }
}
