//! The exported network: its shader text, and the description of the passes around it.

use crate::error::PeelnetError;
use bevy::render::render_resource::TextureFormat;
use serde::Deserialize;
use std::{borrow::Cow, fs, ops::Range, path::Path};

/// The value of `format` in every description.
const FORMAT: &str = "peelnet-export";
/// The version of the description that this crate reads.
const FORMAT_VERSION: u32 = 1;

/// How a target combines what fragments write.
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
    fn bytes(&self) -> u32 {
        self.format.block_copy_size(None).unwrap_or_default()
    }
}

/// One drawing of all transparent surfaces.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pass {
    pub name: String,
    /// Targets of earlier passes, as indices into [`PeelnetModel::targets`].
    pub reads: Vec<usize>,
    /// The statement before the writes.
    pub compute: String,
    /// Of [`PeelnetModel::targets`].
    pub targets: Range<usize>,
    /// Whether a fragment's opacity is needed, and whether its lit colour is.
    pub needs_alpha: bool,
    pub needs_color: bool,
}

/// An exported network: `model.wgsl` and `model.json` of one folder of `models/`.
///
/// The passes, targets, clear values and blends come from `model.json`; the mathematics are the functions of `model.wgsl`. Every recipe
/// whose passes add or take maxima is accepted, as are networks of your own that `peelnet export` wrote.
#[derive(Clone, Debug, PartialEq)]
pub struct PeelnetModel {
    pub(crate) recipe: String,
    pub(crate) wgsl: Cow<'static, str>,
    pub(crate) targets: Vec<Target>,
    pub(crate) passes: Vec<Pass>,
    pub(crate) resolve: String,
    pub(crate) resolve_reads: Vec<usize>,
}

#[derive(Deserialize)]
struct Header {
    format: String,
    format_version: u32,
    tool_version: String,
}

#[derive(Deserialize)]
struct Description {
    recipe: String,
    passes: Vec<DescribedPass>,
    resolve: String,
    resolve_reads: Vec<String>,
    multisampling: String,
}

#[derive(Deserialize)]
struct DescribedPass {
    name: String,
    reads: Vec<String>,
    compute: Option<String>,
    targets: Vec<Target>,
}

impl PeelnetModel {
    /// The network to take by default: three passes, 34 bytes a sample.
    #[must_use]
    pub fn medium() -> Self {
        Self::shipped("medium")
    }

    /// Fewer bytes and less time, and a formula of six learned numbers instead of a network.
    #[must_use]
    pub fn small() -> Self {
        Self::shipped("small")
    }

    /// The least error, 42 bytes a sample.
    #[must_use]
    pub fn large() -> Self {
        Self::shipped("large")
    }

    fn shipped(name: &str) -> Self {
        // Both are compiled in, and a test reads each of the three.
        let model = peelnet_models::find(name).expect("a shipped network");
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
        let described: Description = serde_json::from_str(json).map_err(unreadable)?;
        let recipe = described.recipe.clone();
        Self::of(described, wgsl.into()).map_err(|reason| {
            PeelnetError(format!(
                "this plugin cannot draw with a network of recipe {recipe:?}: {reason}; take small, medium, large or an anchored one"
            ))
        })
    }

    fn of(described: Description, wgsl: Cow<'static, str>) -> Result<Self, String> {
        if !wgsl.contains(&format!("Recipe {},", described.recipe)) {
            return Err("the text is not of the network that the description is of".into());
        }
        for function in ["peelnet_zeta", "peelnet_fragment", "peelnet_resolve"] {
            if !wgsl.contains(&format!("fn {function}(")) {
                return Err(format!("its text has no function {function}"));
            }
        }
        if described.multisampling != "by-sample" {
            let found = described.multisampling;
            return Err(format!(
                "multisampling {found:?} is not known, only \"by-sample\""
            ));
        }
        let mut targets: Vec<Target> = Vec::new();
        let mut passes = Vec::new();
        for pass in described.passes {
            let name = pass.name;
            let reads = found_in(&targets, &pass.reads).map_err(|target| {
                format!("pass {name:?} reads {target:?}, which no pass before it draws")
            })?;
            let transmits = |t: &&Target| [t.color, t.alpha].contains(&Blend::Transmit);
            if let Some(Target { name, .. }) = pass.targets.iter().find(transmits) {
                return Err(format!(
                    "target {name:?} blends with \"transmit\", this plugin with \"add\" and \"max\""
                ));
            }
            let first = targets.len();
            targets.extend(pass.targets);
            let compute = pass.compute.unwrap_or_default();
            let texts = || {
                let writes = targets[first..].iter().map(|t| t.write.as_str());
                writes.chain([compute.as_str()])
            };
            if texts().any(|text| mentions(text, "z")) {
                return Err(format!(
                    "pass {name:?} wants plain distances, which networks of this plugin do not use"
                ));
            }
            let needs_alpha = texts().any(|text| mentions(text, "alpha"));
            let needs_color = texts().any(|text| mentions(text, "rgb"));
            passes.push(Pass {
                name,
                reads,
                compute,
                targets: first..targets.len(),
                needs_alpha,
                needs_color,
            });
        }
        if passes.is_empty() {
            return Err("its description has no passes".into());
        }
        let resolve_reads = found_in(&targets, &described.resolve_reads)
            .map_err(|target| format!("its resolve reads {target:?}, which no pass draws"))?;
        Ok(Self {
            recipe: described.recipe,
            wgsl,
            targets,
            passes,
            resolve: described.resolve,
            resolve_reads,
        })
    }

    /// The recipe that made the network, such as `medium`.
    #[must_use]
    pub fn recipe(&self) -> &str {
        &self.recipe
    }

    /// Bytes that the targets take a sample, beside Bevy's own.
    #[must_use]
    pub fn bytes_per_sample(&self) -> u32 {
        Self::bytes_of(&self.targets)
    }

    pub(crate) fn bytes_of(targets: &[Target]) -> u32 {
        targets.iter().map(Target::bytes).sum()
    }
}

/// The indices of named targets, or the first name that is none.
fn found_in(targets: &[Target], names: &[String]) -> Result<Vec<usize>, String> {
    let find = |name: &String| {
        let index = targets.iter().position(|t| t.name == *name);
        index.ok_or_else(|| name.clone())
    };
    names.iter().map(find).collect()
}

/// Whether an expression uses a variable of this name; not as a member (`s.rgb`), and not as part of another name.
fn mentions(text: &str, variable: &str) -> bool {
    let in_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.match_indices(variable).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        let after = text[at + variable.len()..].chars().next();
        !before.is_some_and(|c| in_name(c) || c == '.') && !after.is_some_and(in_name)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    /// Why the text of one network with the description of another, changed, is refused.
    fn refusal_of(text: &str, description: &str, change: fn(&mut Value)) -> String {
        let [text, description] =
            [text, description].map(|name| peelnet_models::find(name).expect("ships"));
        let mut json = serde_json::from_str(description.json).expect("is valid");
        change(&mut json);
        let error = PeelnetModel::new(text.wgsl, &json.to_string()).expect_err("is refused");
        error.to_string()
    }

    #[test]
    fn the_shipped_networks_are_read() {
        for (model, bytes) in [
            (PeelnetModel::small(), 30),
            (PeelnetModel::medium(), 34),
            (PeelnetModel::large(), 42),
        ] {
            assert_eq!(model.bytes_per_sample(), bytes, "{}", model.recipe());
            // Nothing is lit before the last pass, and the first needs depth alone.
            let needs = |p: &Pass| (p.needs_alpha, p.needs_color);
            let needs: Vec<_> = model.passes.iter().map(needs).collect();
            assert_eq!(needs, [(false, false), (true, false), (true, true)]);
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_refused_with_the_reason() {
        let later = refusal_of("medium", "medium", |json| {
            json["format_version"] = 2.into();
            // What else a later version changes does not matter.
            json["passes"] = "elsewhere".into();
        });
        assert!(later.contains("peelnet-export 2"), "{later}");
        assert!(later.contains("peelnet-export 1"), "{later}");
        let thesis = refusal_of("thesis", "thesis", |_| ());
        assert!(thesis.contains("\"thesis\""), "{thesis}");
        for (text, refusal) in [
            ("no function peelnet_zeta", thesis),
            (
                "wants plain distances",
                refusal_of("medium", "medium", |json| {
                    let compute = "let s = peelnet_statistics(alpha, z, range);";
                    json["passes"][1]["compute"] = compute.into();
                }),
            ),
            (
                "reads \"front\"",
                refusal_of("medium", "medium", |json| {
                    json["passes"][1]["reads"] = serde_json::json!(["front"]);
                }),
            ),
            (
                "blends with \"transmit\"",
                refusal_of("medium", "medium", |json| {
                    json["passes"][0]["targets"][0]["color"] = "transmit".into();
                }),
            ),
            (
                "the text is not of the network",
                refusal_of("small", "medium", |_| ()),
            ),
        ] {
            assert!(refusal.contains(text), "{refusal}");
        }
    }

    #[test]
    fn variables_are_told_from_members_and_longer_names() {
        assert!(mentions("vec4f(alpha * rgb, alpha) * w", "rgb"));
        assert!(!mentions("s.rgb", "rgb"));
        assert!(!mentions("peelnet_statistics(alpha, zeta)", "z"));
    }
}
