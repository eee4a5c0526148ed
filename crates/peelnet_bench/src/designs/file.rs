use super::{DESIGNS, Entry, Source};
use crate::EvalError;
use peelnet_core::{
    files::{check_name, printable},
    methods::{
        quantiles::Quantiles,
        slabs::{Design, Extent, Interior, Kept, MAX_BINS, MAX_SLABS},
    },
    statistics::{DEPTH_CODES, ExtremeCode, FARTHEST_CODE},
};
use peelnet_model::inputs::{FIVE, Feature, NINE, SlabInputs};
use peelnet_model::{Budget, Declaration, MAX_HIDDEN_LAYERS, Network, PixelLoss, Recipe};
use serde::Deserialize;
use std::path::Path;

const MAX_BYTES: u64 = 1 << 20;

/// Hidden units of one layer, at most.
const MAX_WIDTH: usize = 4096;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    #[serde(default)]
    training: RawTraining,
    #[serde(default)]
    design: Vec<RawDesign>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTraining {
    epochs: Option<u32>,
    learning_rate: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDesign {
    name: String,
    ends: Vec<f64>,
    means: Vec<bool>,
    nearest: Option<Vec<bool>>,
    farthest: Vec<bool>,
    records: Option<String>,
    #[serde(default)]
    range: Source,
    bins: Option<usize>,
    #[serde(default)]
    apart: bool,
    train_apart: Option<bool>,
    inputs: Option<Vec<String>>,
    hidden: Option<Vec<usize>>,
    loss: Option<String>,
    seed: Option<u64>,
}

/// The designs that ship, `data/designs.toml`.
pub fn shipped() -> Vec<Entry> {
    parse(peelnet_shipped_scenes::DESIGNS, Path::new(DESIGNS)).expect("a test reads them")
}

pub fn read(path: &Path) -> Result<Vec<Entry>, EvalError> {
    let bytes = peelnet_core::files::read(path, MAX_BYTES).map_err(EvalError::io(path, "read"))?;
    let text = String::from_utf8(bytes)
        .map_err(|e| failed(path, "the text", &format!("{e}; save it as UTF-8")))?;
    parse(&text, path)
}

fn failed(path: &Path, what: &str, why: &str) -> EvalError {
    EvalError::Unusable(format!("{}: {what}: {why}", path.display()))
}

/// Parses the text of a file of designs; `path` only serves messages.
///
/// Recipes live as long as the program: each call leaks a few hundred bytes a design.
pub fn parse(text: &str, path: &Path) -> Result<Vec<Entry>, EvalError> {
    let file: RawFile =
        toml::from_str(text).map_err(|e| failed(path, "not understood", &e.to_string()))?;
    let mut budget = Recipe::LARGE.budget;
    budget.epochs = file.training.epochs.unwrap_or(budget.epochs);
    budget.learning_rate = file.training.learning_rate.unwrap_or(budget.learning_rate);
    let rate = budget.learning_rate;
    if budget.epochs == 0 || !(rate.is_finite() && rate > 0.0) {
        let why = "epochs and learning_rate must be greater than 0";
        return Err(failed(path, "[training]", why));
    }
    let mut entries: Vec<Entry> = Vec::new();
    for (raw, number) in file.design.into_iter().zip(1..) {
        let what = format!("design {number} (\"{}\")", printable(&raw.name));
        let entry = raw.entry(budget, &entries);
        entries.push(entry.map_err(|why| failed(path, &what, &why))?);
    }
    if entries.is_empty() {
        let why = "begin each design with a line [[design]]";
        return Err(failed(path, "no design", why));
    }
    Ok(entries)
}

impl RawDesign {
    fn entry(self, budget: Budget, earlier: &[Entry]) -> Result<Entry, String> {
        if self.name.trim().is_empty() {
            return Err("give it a name".to_owned());
        }
        check_name(&self.name).map_err(|e| format!("its name {e}"))?;
        if earlier.iter().any(|e| e.name == self.name) {
            return Err("an earlier design has this name; rename one".to_owned());
        }
        let design = Design {
            slabs: self.slabs()?,
            records: self.records()?,
            extent: match self.range {
                Source::Tiles | Source::Frame => Extent::Among(Quantiles::EVEN),
                Source::Ends | Source::Boxes => Extent::Ends,
                Source::Pixel => Extent::Bins(self.bins()?),
            },
            apart: self.apart,
        };
        let inputs = self.inputs()?;
        let hidden = self.hidden.unwrap_or_else(|| vec![12]);
        if hidden.len() > MAX_HIDDEN_LAYERS {
            return Err(format!(
                "hidden holds {} layers; give at most {MAX_HIDDEN_LAYERS}",
                hidden.len()
            ));
        }
        if let Some(width) = hidden.iter().find(|w| !(2..=MAX_WIDTH).contains(*w)) {
            return Err(format!(
                "hidden holds {width}; give widths from 2 to {MAX_WIDTH}"
            ));
        }
        let loss = match &self.loss {
            None => PixelLoss::default(),
            Some(name) => name.parse().map_err(|e| format!("loss {name:?}: {e}"))?,
        };
        let trained = Design {
            apart: self.train_apart.unwrap_or(self.apart),
            ..design
        };
        // No recipe that ships has a blank in its name.
        let name = format!("design {}", self.name);
        let declaration = Declaration {
            name: Box::leak(name.into_boxed_str()),
            inputs: Box::leak(Box::new(SlabInputs {
                design: trained,
                features: inputs,
            })),
            network: Network {
                hidden: Box::leak(hidden.into_boxed_slice()),
                ..Recipe::LARGE.network
            },
            budget,
            loss: Some(loss),
            ..*Recipe::LARGE
        };
        Ok(Entry {
            name: self.name,
            design,
            source: self.range,
            inputs,
            recipe: Recipe::new(Box::leak(Box::new(declaration))),
            seed: self.seed.unwrap_or(1),
        })
    }

    fn slabs(&self) -> Result<&'static [Kept], String> {
        let count = self.ends.len();
        if !(1..=MAX_SLABS).contains(&count) {
            return Err(format!(
                "ends has {count} values; give 1 to {MAX_SLABS}, one for each slab"
            ));
        }
        let mut begin = 0.0;
        for &end in &self.ends {
            if !(end > begin && end <= 1.0) {
                return Err(format!(
                    "ends holds {end} behind {begin}; give rising values above 0, the last of them 1"
                ));
            }
            begin = end;
        }
        if begin < 1.0 {
            return Err(format!(
                "ends stops at {begin}; the last slab must end at 1"
            ));
        }
        let all = vec![true; count];
        let nearest = self.nearest.as_ref().unwrap_or(&all);
        let lists = [
            ("means", &self.means),
            ("nearest", nearest),
            ("farthest", &self.farthest),
        ];
        for (name, list) in lists {
            if list.len() != count {
                return Err(format!(
                    "{name} has {} values, but ends has {count}; give true or false for each slab",
                    list.len()
                ));
            }
        }
        let kept = (0..count).map(|k| Kept {
            end: self.ends[k],
            mean: self.means[k],
            nearest: nearest[k],
            farthest: self.farthest[k],
        });
        Ok(Vec::leak(kept.collect()))
    }

    fn bins(&self) -> Result<usize, String> {
        let bins = self.bins.unwrap_or(8);
        if (1..=MAX_BINS).contains(&bins) {
            return Ok(bins);
        }
        Err(format!("bins holds {bins}; give 1 to {MAX_BINS}"))
    }

    fn records(&self) -> Result<ExtremeCode, String> {
        let Some(text) = &self.records else {
            return Ok(FARTHEST_CODE);
        };
        let parsed = text.split_once('x').and_then(|(bins, alphas)| {
            Some(ExtremeCode {
                bins: bins.parse().ok()?,
                alphas: alphas.parse().ok()?,
            })
        });
        let fits = |code: &ExtremeCode| {
            code.alphas > 1 && code.bins.checked_mul(code.alphas) == Some(DEPTH_CODES)
        };
        parsed.filter(fits).ok_or_else(|| {
            format!(
                "records {text:?}; give bins of depth x levels of opacity (at least 2) whose product is {DEPTH_CODES}, such as \"1920x32\""
            )
        })
    }

    fn inputs(&self) -> Result<&'static [&'static Feature<Interior>], String> {
        let Some(names) = &self.inputs else {
            return Ok(&NINE);
        };
        let first = FIVE.map(|f| f.about.name);
        if !names.iter().map(String::as_str).take(5).eq(first) {
            return Err(format!("inputs must begin with {}", first.join(", ")));
        }
        let mut found: Vec<&'static Feature<Interior>> = Vec::new();
        for name in names {
            let Some(&feature) = NINE.iter().find(|f| f.about.name == name) else {
                let all = NINE.map(|f| f.about.name).join(", ");
                return Err(format!("inputs holds {name:?}; there are {all}"));
            };
            if found.iter().any(|f| f.about.name == name) {
                return Err(format!("inputs holds {name:?} twice; remove one"));
            }
            found.push(feature);
        }
        Ok(Vec::leak(found))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"
[training]
epochs = 3
learning_rate = 0.5

[[design]]
name = "plain"
ends = [0.25, 1.0]
means = [true, false]
farthest = [false, true]

[[design]]
name = "full"
ends = [1.0]
means = [false]
nearest = [false]
farthest = [true]
records = "960x64"
range = "frame"
apart = true
train_apart = false
inputs = ["root_absorbance", "place_fraction", "mean_fraction", "share_low", "share_high", "of_own"]
hidden = [8, 4]
loss = "contributions"
seed = 7
"#;

    #[test]
    fn every_field_is_read() {
        let entries = parse(GOOD, Path::new("f.toml")).unwrap();
        let [plain, full] = &entries[..] else {
            panic!("{entries:?}")
        };
        let kept = |slabs: &[Kept]| -> Vec<_> {
            let of = |k: &Kept| (k.end, k.mean, k.nearest, k.farthest);
            slabs.iter().map(of).collect()
        };
        let slabs = [(0.25, true, true, false), (1.0, false, true, true)];
        assert_eq!(kept(plain.design.slabs), slabs);
        assert_eq!(plain.design.records, FARTHEST_CODE);
        assert!(!plain.design.apart);
        assert_eq!((plain.inputs.len(), plain.seed), (9, 1));
        assert_eq!(plain.recipe.network.hidden, [12]);
        assert_eq!(plain.recipe.loss, Some(PixelLoss::Image));
        assert_eq!(kept(full.design.slabs), [(1.0, false, false, true)]);
        let ExtremeCode { bins, alphas } = full.design.records;
        assert_eq!(
            (bins, alphas, full.design.extent),
            (960, 64, Extent::Among(Quantiles::EVEN))
        );
        let trained = full.recipe.inputs.downcast::<SlabInputs>().unwrap();
        assert!(full.design.apart && !trained.design.apart);
        assert_eq!((trained.features.len(), full.seed), (6, 7));
        assert_eq!(full.recipe.network.hidden, [8, 4]);
        assert_eq!(full.recipe.loss, Some(PixelLoss::Contributions));
        let budget = plain.recipe.budget;
        assert_eq!((budget.epochs, budget.learning_rate), (3, 0.5));
    }

    #[test]
    fn the_shipped_designs_are_read() {
        let entries = shipped();
        for (name, design) in [
            ("small", Design::SMALL),
            ("medium", Design::MEDIUM),
            ("large", Design::LARGE),
        ] {
            let found = entries.iter().find(|e| e.name == name);
            assert_eq!(found.unwrap().design, design, "{name}");
        }
    }

    /// Each message names the file, the entry, and what to write instead.
    #[test]
    fn errors_name_the_place_and_the_fix() {
        let second = "design 2 (\"full\")";
        for (old, new, place, fix) in [
            ("[1.0]", "[0.9]", second, "must end at 1"),
            ("[1.0]", "[]", second, "give 1 to 8"),
            ("[1.0]", "[nan]", second, "rising"),
            ("[1.0]", "[0.5, 1.0]", second, "means has 1 values"),
            ("960x64", "960x65", second, "product is 61440"),
            ("960x64", "61440x1", second, "at least 2"),
            ("\"of_own\"", "\"of_mine\"", second, "half_extent"),
            ("\"of_own\"", "\"share_low\"", second, "twice"),
            ("\"mean_fraction\", ", "", second, "begin with"),
            ("[8, 4]", "[8, 0]", second, "2 to 4096"),
            ("\"contributions\"", "\"l2\"", second, "transmittance"),
            ("\"frame\"", "\"pixel\"\nbins = 17", second, "1 to 16"),
            ("\"full\"", "\"plain\"", "design 2", "rename"),
            ("full", &"x".repeat(201), "design 2", "at most 200"),
            ("epochs = 3", "epochs = 0", "[training]", "greater than 0"),
            ("hidden", "hiden", "line 23", "`hidden`"),
            (GOOD, "", "no design", "[[design]]"),
        ] {
            assert!(GOOD.contains(old), "{old}");
            let text = GOOD.replacen(old, new, 1);
            let message = parse(&text, Path::new("f.toml")).unwrap_err().to_string();
            for part in ["f.toml", place, fix] {
                assert!(message.contains(part), "{new:?}, {part:?}: {message:?}");
            }
        }
    }
}
