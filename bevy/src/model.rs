//! The exported network: its shader text, and the description of the passes around it.

use crate::{error::PeelnetError, group::FIRST_BINDING};
use bevy::render::render_resource::TextureFormat;
use serde::Deserialize;
use std::{borrow::Cow, fs, path::Path};

const FORMAT: &str = "peelnet-export";
const FORMAT_VERSION: u32 = 1;

/// The name of the target that the resolve writes coverage into, on request. The expression is in the resolve's text.
pub(crate) const MASK: &str = "mask";

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Blend {
    Add,
    Max,
    /// Refused: this plugin does not draw it.
    Transmit,
}

/// A texture that one pass draws into and later passes read.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct Target {
    pub name: String,
    pub format: TextureFormat,
    pub clear: [f64; 4],
    pub color: Blend,
    pub alpha: Blend,
    /// The expression that each fragment writes.
    pub write: String,
}

impl Target {
    fn mask() -> Self {
        Self {
            name: MASK.into(),
            format: TextureFormat::R16Float,
            clear: [0.0; 4],
            color: Blend::Add,
            alpha: Blend::Add,
            write: String::new(),
        }
    }
}

/// One drawing of all transparent surfaces.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct Pass {
    pub name: String,
    /// One pixel in so many is drawn, both ways. Such a pass has one sample a pixel, and no attachment of depth.
    #[serde(default = "every_pixel")]
    pub every: u32,
    /// Names of targets of earlier passes, or of the small texture.
    pub reads: Vec<String>,
    /// The statement before the writes.
    pub compute: Option<String>,
    pub targets: Vec<Target>,
    /// Whether it writes the depths of fragments, into the view's.
    #[serde(skip)]
    pub writes_depth: bool,
}

const fn every_pixel() -> u32 {
    1
}

impl Pass {
    /// The one after all others, on request: the depth of the nearest fragment where enough is covered. Nothing of what is barely there counts as
    /// a surface.
    fn depth() -> Self {
        let compute = "if alpha < 1.0 / 255.0 || mask < peelnet_depths.w { discard; }";
        Self {
            name: "depth".into(),
            every: 1,
            reads: vec![MASK.into()],
            compute: Some(compute.into()),
            targets: vec![],
            writes_depth: true,
        }
    }

    /// Whether it draws fewer pixels than the view has.
    pub const fn is_small(&self) -> bool {
        self.every > 1
    }

    /// Whether the statements use a variable of a fragment, such as its opacity (`alpha`) or its lit colour (`rgb`).
    pub fn needs(&self, variable: &str) -> bool {
        let writes = self.targets.iter().map(|target| &target.write);
        let mut texts = writes.chain(&self.compute);
        texts.any(|text| mentions(text, variable))
    }
}

/// A small texture of what surrounds each pixel, read by the passes between its texels.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct Around {
    pub name: String,
    pub format: TextureFormat,
    /// Pixels from one texel to the next, both ways.
    pub every: u32,
    /// The pass over one pixel a texel, before all others.
    pub pass: Pass,
    /// What is added up of that pass's targets over nine texels.
    pub sum: String,
    /// The expression of a texel.
    pub write: String,
}

/// An exported network: `model.wgsl` and `model.json` of one folder of `models/`.
///
/// The passes, targets, clear values and blends come from `model.json`; the mathematics are the functions of `model.wgsl`. Every recipe
/// whose passes add or take maxima is accepted, as are networks of your own that `peelnet export` wrote.
#[derive(Clone, Debug, PartialEq)]
pub struct PeelnetModel {
    pub(crate) wgsl: Cow<'static, str>,
    pub(crate) description: Description,
    pub(crate) mask: Target,
    depth: Pass,
}

#[derive(Deserialize)]
struct Header {
    format: String,
    format_version: u32,
    tool_version: String,
}

/// What this crate reads of `model.json`.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub(crate) struct Description {
    recipe: String,
    pub around: Option<Around>,
    /// In their order, that of the small texture first.
    pub passes: Vec<Pass>,
    pub resolve: String,
    pub resolve_reads: Vec<String>,
    multisampling: String,
}

impl PeelnetModel {
    /// The network to take by default: two passes and a small one, 32 bytes a sample.
    #[must_use]
    pub fn medium() -> Self {
        Self::shipped("medium")
    }

    /// Fewer bytes and less time, and a formula of six learned numbers instead of a network.
    #[must_use]
    pub fn small() -> Self {
        Self::shipped("small")
    }

    /// The least error, 40 bytes a sample.
    #[must_use]
    pub fn large() -> Self {
        Self::shipped("large")
    }

    /// One pass and a small one, 32 bytes a sample.
    #[must_use]
    pub fn one() -> Self {
        Self::shipped("one")
    }

    fn shipped(name: &str) -> Self {
        // Both are compiled in, and a test reads each of the four.
        let model = peelnet_shipped_networks::find(name).expect("a shipped network");
        Self::new(model.wgsl, model.json).expect("a shipped network is valid")
    }

    /// Reads `model.wgsl` and `model.json` of a folder.
    ///
    /// # Errors
    ///
    /// Files that cannot be read, and all errors of [`Self::new`].
    pub fn load(folder: impl AsRef<Path>) -> Result<Self, PeelnetError> {
        let read = |name: &str| {
            let path = folder.as_ref().join(name);
            let text = fs::read_to_string(&path);
            text.map_err(|e| PeelnetError(format!("{}: {e}", path.display())))
        };
        Self::new(read("model.wgsl")?, &read("model.json")?)
    }

    /// The network of an exported text and its description.
    ///
    /// # Errors
    ///
    /// A description that is not one, or is of another version; passes that this crate cannot draw; a text of another network.
    pub fn new(wgsl: impl Into<Cow<'static, str>>, json: &str) -> Result<Self, PeelnetError> {
        let unreadable =
            |e| PeelnetError(format!("the network's description is not readable: {e}"));
        // The head first: a description of another version may differ in all else.
        let header: Header = serde_json::from_str(json).map_err(unreadable)?;
        let (format, version) = (header.format, header.format_version);
        if format != FORMAT || version != FORMAT_VERSION {
            let tool = header.tool_version;
            return Err(PeelnetError(format!(
                "the network's description is \"{format} {version}\" (written by peelnet {tool}), this plugin reads \"{FORMAT} {FORMAT_VERSION}\"; \
                 export the network again"
            )));
        }
        let mut description: Description = serde_json::from_str(json).map_err(unreadable)?;
        if let Some(Around { every, pass, .. }) = &description.around {
            let every = *every;
            let small = Pass {
                every,
                ..pass.clone()
            };
            description.passes.insert(0, small);
        }
        let wgsl = wgsl.into();
        match description.check(&wgsl) {
            Ok(()) => Ok(Self {
                wgsl,
                description,
                mask: Target::mask(),
                depth: Pass::depth(),
            }),
            Err(reason) => Err(PeelnetError(format!(
                "this plugin cannot draw with a network of recipe {:?}: {reason}; take small, medium, large, one or an anchored one",
                description.recipe
            ))),
        }
    }

    /// The recipe that made the network, such as `medium`.
    #[must_use]
    pub fn recipe(&self) -> &str {
        &self.description.recipe
    }

    /// Bytes that the targets take a sample, beside Bevy's own. The small texture takes one more a pixel.
    #[must_use]
    pub fn bytes_per_sample(&self) -> u32 {
        let bytes = |target: &Target| target.format.block_copy_size(None).unwrap_or_default();
        let passes = self.description.passes.iter().filter(|p| !p.is_small());
        passes.flat_map(|pass| &pass.targets).map(bytes).sum()
    }

    /// The passes over surfaces: those of the description, and the one that writes depth.
    pub(crate) fn passes(&self) -> impl Iterator<Item = &Pass> {
        self.description.passes.iter().chain([&self.depth])
    }

    /// The targets of all passes, each with [`Pass::every`] of its own, and the mask.
    pub(crate) fn targets(&self) -> impl Iterator<Item = (&Target, u32)> {
        let passes = self.description.passes.iter();
        let targets = passes.flat_map(|p| p.targets.iter().map(|target| (target, p.every)));
        targets.chain([(&self.mask, 1)])
    }

    /// Whether one of the things that passes read is the small texture.
    pub(crate) fn is_around(&self, read: &str) -> bool {
        let around = self.description.around.as_ref();
        around.is_some_and(|around| around.name == read)
    }

    /// The binding of a target in the bind groups of passes, and in that of the resolve. The first of ours is the range of depths. Behind all
    /// targets are the small texture, [its sampler](Self::sampler_binding) and [Bevy's depths](Self::depth_binding).
    pub(crate) fn binding(&self, read: &str) -> u32 {
        let before = self.targets().take_while(|(t, _)| t.name != read);
        FIRST_BINDING + 1 + before.count() as u32
    }

    pub(crate) fn sampler_binding(&self) -> u32 {
        self.depth_binding() - 1
    }

    pub(crate) fn depth_binding(&self) -> u32 {
        FIRST_BINDING + 3 + self.targets().count() as u32
    }
}

impl Description {
    /// What this plugin cannot draw of a network with this text.
    fn check(&self, wgsl: &str) -> Result<(), String> {
        if !wgsl.contains(&format!("Recipe {},", self.recipe)) {
            return Err("the text is not of the network that the description is of".into());
        }
        for function in ["peelnet_zeta", "peelnet_resolve"] {
            if !wgsl.contains(&format!("fn {function}(")) {
                return Err(format!("its text has no function {function}"));
            }
        }
        if self.multisampling != "by-sample" {
            let found = &self.multisampling;
            return Err(format!(
                "multisampling {found:?} is not known, only \"by-sample\""
            ));
        }
        let mut drawn: Vec<&String> = Vec::new();
        for pass in &self.passes {
            let name = &pass.name;
            if let Some(target) = pass.reads.iter().find(|target| !drawn.contains(target)) {
                return Err(format!(
                    "pass {name:?} reads {target:?}, which no pass before it draws"
                ));
            }
            for target in &pass.targets {
                if [target.color, target.alpha].contains(&Blend::Transmit) {
                    let name = &target.name;
                    return Err(format!(
                        "target {name:?} blends with \"transmit\", this plugin with \"add\" and \"max\""
                    ));
                }
                drawn.push(&target.name);
            }
            let around = self.around.as_ref().filter(|_| pass.is_small());
            drawn.extend(around.map(|around| &around.name));
            if pass.needs("z") {
                return Err(format!(
                    "pass {name:?} wants plain distances, which networks of this plugin do not use"
                ));
            }
        }
        if self.passes.is_empty() {
            return Err("its description has no passes".into());
        }
        match self.resolve_reads.iter().find(|t| !drawn.contains(t)) {
            Some(target) => Err(format!("its resolve reads {target:?}, which no pass draws")),
            None => Ok(()),
        }
    }
}

/// Whether an expression uses a variable of this name; not as a member (`s.rgb`), and not as part of another name.
fn mentions(text: &str, variable: &str) -> bool {
    let in_word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
    let mut words = text.split(|c| !in_word(c));
    words.any(|word| word.split('.').next() == Some(variable))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn the_shipped_networks_are_read() {
        for (model, bytes) in [
            (PeelnetModel::small(), 28),
            (PeelnetModel::medium(), 32),
            (PeelnetModel::large(), 40),
            (PeelnetModel::one(), 32),
        ] {
            assert_eq!(model.bytes_per_sample(), bytes, "{}", model.recipe());
            // Nothing is lit before the last pass.
            let needs = |p: &Pass| (p.needs("alpha"), p.needs("rgb"));
            let mut needs: Vec<_> = model.description.passes.iter().map(needs).collect();
            assert_eq!(needs.pop(), Some((true, true)));
            assert!(needs.iter().all(|needs| *needs == (true, false)));
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_refused_with_the_reason() {
        let [thesis, small, medium] = ["thesis", "small", "medium"]
            .map(|name| peelnet_shipped_networks::find(name).expect("ships"));
        let mut cases = vec![
            (thesis.wgsl, thesis.json.into(), "no function peelnet_zeta"),
            (
                small.wgsl,
                medium.json.into(),
                "the text is not of the network",
            ),
        ];
        let compute = "let s = peelnet_statistics(alpha, z, range);";
        for (member, value, says) in [
            ("/passes/1/compute", compute, "wants plain distances"),
            ("/passes/1/reads/0", "front", "reads \"front\""),
            (
                "/passes/0/targets/0/color",
                "transmit",
                "blends with \"transmit\"",
            ),
        ] {
            let mut json: Value = serde_json::from_str(medium.json).expect("is valid");
            *json.pointer_mut(member).expect("is there") = value.into();
            cases.push((medium.wgsl, json.to_string(), says));
        }
        for (wgsl, json, says) in cases {
            let error = PeelnetModel::new(wgsl, &json).expect_err("is refused");
            assert!(error.to_string().contains(says), "{error}");
        }
    }

    #[test]
    fn variables_are_told_from_members_and_longer_names() {
        assert!(mentions("vec4f(alpha * rgb, alpha) * w", "rgb"));
        assert!(!mentions("s.rgb", "rgb"));
        assert!(!mentions("peelnet_statistics(alpha, zeta)", "z"));
    }
}
