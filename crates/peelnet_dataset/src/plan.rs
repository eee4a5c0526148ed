//! `_peelnet/plan.json`: what all writers of a dataset agree on.
//!
//! The plan's hash covers everything that shapes the rows, and nothing else: scenes by their contents and not by their paths, and no
//! command line. Who would write other rows is refused before the first one.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::card;
use crate::error::DatasetError;
use crate::formats::Format;
use crate::hash::sha256;
use crate::manifest::{
    EXTRACT_AGAIN, MAX_WORK_ITEMS, Manifest, Part, SCHEMA_VERSION, SceneEntry, columns,
    hash_of_parts, read_json, to_json,
};
use crate::picture;
use crate::statistics;
use crate::store::{PLAN, Store};

/// What is known about a dataset before its first row: what all its writers agree on, and who this one is. The plan's file is its JSON,
/// with these names.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Version of the program.
    pub tool_version: String,
    /// Format of all parts.
    pub format: Format,
    /// Seed of sampling and augmentation.
    pub seed: u64,
    /// Adapters that are expected to give the same bytes: writers of another class are refused.
    pub adapter_class: String,
    /// `sbuffer`, `dual` or `single`.
    pub peel: String,
    /// Fraction of the pixels that is kept.
    pub pixels_fraction: f64,
    /// Varied copies of each scene beside the scene itself.
    pub augment: u32,
    /// Everything else that shapes the rows, by name: the frame size, the cameras, limits. Writers must agree on it.
    pub settings: BTreeMap<String, String>,
    /// Number of work items (scene × copy × view) of the whole dataset.
    pub work_items: u32,
    /// All scenes of the whole dataset, also when a shard is written. Their paths are not in the plan's hash.
    pub scenes: Vec<SceneEntry>,
    /// Name of the GPU adapter; not in the hash.
    pub adapter: String,
    /// The command line, for provenance; not in the hash.
    pub command: String,
    /// This writer's name, for records and errors: see [`worker_name`]; not in the hash.
    pub worker: String,
    /// The shard to write; `None` writes the whole dataset.
    #[serde(skip)]
    pub shard: Option<Shard>,
    /// Writes only what is missing of the dataset that is there. Shards always do.
    #[serde(skip)]
    pub resume: bool,
}

impl Header {
    pub(crate) fn check(&self, folder: &Path) -> Result<(), DatasetError> {
        let items = self.work_items;
        let reason = if items > MAX_WORK_ITEMS {
            format!(
                "{items} work items (scenes × copies × views) are too many: at most {MAX_WORK_ITEMS}"
            )
        } else if self.scenes.is_empty() || items == 0 {
            "a dataset needs at least one scene and one view".to_owned()
        } else if !(self.pixels_fraction > 0.0 && self.pixels_fraction <= 1.0) {
            "the fraction of pixels must be above 0 and at most 1".to_owned()
        } else {
            return Ok(());
        };
        Err(DatasetError::invalid(folder, reason))
    }
}

/// The header of a dataset's first writer, and the hash over everything in it that shapes the rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Plan {
    pub schema: u32,
    pub hash: String,
    #[serde(flatten)]
    pub header: Header,
}

impl Plan {
    pub(crate) fn new(header: &Header) -> Self {
        let mut plan = Self {
            schema: SCHEMA_VERSION,
            hash: String::new(),
            header: header.clone(),
        };
        plan.hash = plan.computed_hash();
        plan
    }

    pub(crate) fn agrees_with(&self, m: &Manifest) -> bool {
        let h = &self.header;
        let names = (&h.tool_version, &h.peel, h.format, &h.scenes, &h.settings);
        let numbers = (h.seed, h.pixels_fraction, h.augment, h.work_items);
        self.hash == m.plan
            && names == (&m.tool_version, &m.peel, m.format, &m.scenes, &m.settings)
            && numbers == (m.seed, m.pixels_fraction, m.augment, m.work_items)
    }

    /// Everything that shapes the rows, by name.
    fn fields(&self) -> Vec<(String, String)> {
        let header = &self.header;
        let named = |name: &str, value: String| (name.to_owned(), value);
        let mut fields = vec![
            named("schema version", self.schema.to_string()),
            named("peelnet version", header.tool_version.clone()),
            named("adapter class", header.adapter_class.clone()),
            named("format", header.format.to_string()),
            named("seed", header.seed.to_string()),
            named("peeling method", header.peel.clone()),
            named("fraction of pixels", header.pixels_fraction.to_string()),
            named("number of copies", header.augment.to_string()),
            named("number of scenes", header.scenes.len().to_string()),
        ];
        for (k, scene) in header.scenes.iter().enumerate() {
            let held_out = if scene.held_out { ", held out" } else { "" };
            let (name, hash, content) = (&scene.name, &scene.sha256, &scene.content);
            let value = format!("{name} with sha256 {hash}, content {content}{held_out}");
            fields.push((format!("scene {k}"), value));
        }
        // Behind the scenes: when these differ, the cameras do as well.
        let settings = header.settings.iter();
        fields.extend(settings.map(|(k, v)| (k.clone(), v.clone())));
        fields.push(named("number of work items", header.work_items.to_string()));
        fields
    }

    fn computed_hash(&self) -> String {
        let fields = self.fields().into_iter();
        // Quoted: no value can look like the next line.
        let lines: String = fields.map(|(k, v)| format!("{k:?} {v:?}\n")).collect();
        sha256(lines.as_bytes())
    }

    /// An error where another plan differs, with the first field and both values.
    fn check_same(&self, store: &dyn Store, there: &Self) -> Result<(), DatasetError> {
        let (mine, theirs) = (self.fields(), there.fields());
        let value = |fields: &[(String, String)], name: &str| {
            let found = fields.iter().find(|(n, _)| n == name);
            found.map_or("nothing".to_owned(), |(_, value)| value.clone())
        };
        for (field, _) in mine.iter().chain(&theirs) {
            let (mine, theirs) = (value(&mine, field), value(&theirs, field));
            if mine != theirs {
                // Also where a writer was killed that had begun to replace that dataset.
                let instead = match self.header.resume {
                    true => ", or leave out --resume to replace it",
                    false => "",
                };
                let reason = format!(
                    "the dataset there has another plan: its {field} is {theirs} (worker {}), and here (worker {}) it is {mine}; use the same command, version and adapter, or another folder{instead}",
                    there.header.worker, self.header.worker
                );
                return Err(DatasetError::invalid(store.path(), reason));
            }
        }
        Ok(())
    }

    /// Reads and checks a dataset's plan; `None` where there is none.
    pub(crate) fn read(store: &dyn Store) -> Result<Option<Self>, DatasetError> {
        read_json(store, PLAN, "plan", EXTRACT_AGAIN, |plan: &Self| {
            let items = plan.header.work_items;
            if !(1..=MAX_WORK_ITEMS).contains(&items) {
                return Err(format!(
                    "{items} work items, and from 1 to {MAX_WORK_ITEMS} are read"
                ));
            }
            match plan.hash == plan.computed_hash() {
                true => Ok(()),
                false => Err("`hash` does not fit the plan: it was edited".to_owned()),
            }
        })
    }

    /// Makes this the dataset's plan, or checks that the one that is there is the same; the error names the first difference. Returns the
    /// dataset's plan, and whether it is new.
    pub(crate) fn agree(&self, store: &dyn Store) -> Result<(Self, bool), DatasetError> {
        // The plan that is there first: one request less for all writers but the first.
        let there = match Self::read(store)? {
            None if store.put_if_absent(PLAN, to_json(self).as_bytes())? => {
                return Ok((self.clone(), true));
            }
            None => Self::read(store)?,
            there => there,
        };
        let Some(there) = there else {
            return Err(DatasetError::busy(store.path()));
        };
        self.check_same(store, &there)?;
        Ok((there, false))
    }

    pub(crate) fn manifest(&self, parts: Vec<Part>) -> Manifest {
        self.manifest_and_card(parts).0
    }

    /// The manifest, and the files of its card: none of a dataset that is not whole.
    pub(crate) fn manifest_and_card(&self, mut parts: Vec<Part>) -> (Manifest, Vec<card::File>) {
        parts.sort_by_key(|p| p.index);
        let pictures = picture::take(&mut parts);
        let statistics = statistics::take_merged(&mut parts);
        // Records come from outside, with any numbers in them.
        let sum = |count: fn(&Part) -> u64| parts.iter().map(count).fold(0, u64::saturating_add);
        let header = self.header.clone();
        let mut manifest = Manifest {
            schema: self.schema,
            plan: self.hash.clone(),
            tool_version: header.tool_version,
            command: header.command,
            format: header.format,
            columns: columns(),
            seed: header.seed,
            adapter: header.adapter,
            peel: header.peel,
            pixels_fraction: header.pixels_fraction,
            augment: header.augment,
            settings: header.settings,
            scenes: header.scenes,
            work_items: header.work_items,
            rows: sum(|p| p.rows),
            pixels: sum(|p| p.pixels),
            lost_fragments: sum(|p| p.lost_fragments),
            coplanar_ties: sum(|p| p.coplanar_ties),
            hash: hash_of_parts(&parts),
            card: Vec::new(),
            statistics,
            parts,
        };
        // Of records that nobody has checked yet, a card could be of anything.
        let mut files = Vec::new();
        if manifest.is_whole() && manifest.check().is_ok() {
            files = card::files(self, &manifest, pictures);
            manifest.card = card::entries(&files);
        }
        (manifest, files)
    }
}

/// One of N independent pieces of a dataset: the work items k with k ≡ I (mod N).
///
/// Shards count from 1 to N: a scheduler that counts from 0 would write the last one twice with `0` for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    /// I, from 1 to `of`.
    pub index: u32,
    /// N.
    pub of: u32,
}

impl Shard {
    /// Whether this shard writes work item `item`.
    pub const fn contains(self, item: u32) -> bool {
        item % self.of == self.index % self.of
    }
}

impl FromStr for Shard {
    type Err = DatasetError;

    fn from_str(text: &str) -> Result<Self, DatasetError> {
        let numbers = text.split_once('/');
        let numbers = numbers.and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((index, of)) if (1..=of).contains(&index) && of <= MAX_WORK_ITEMS => {
                Ok(Self { index, of })
            }
            _ => Err(DatasetError::Setting(format!(
                "shard {text:?}: expected I/N with whole numbers N from 1 to {MAX_WORK_ITEMS} and I from 1 to N, for example 2/4"
            ))),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

/// The machine's name, as the system says it.
pub(crate) fn host() -> String {
    let file = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let variable = |name| std::env::var(name).ok();
    let name = file.or_else(|| variable("HOSTNAME").or_else(|| variable("COMPUTERNAME")));
    let name = name.unwrap_or_default();
    match peelnet_core::files::printable(name.trim()) {
        name if name.is_empty() => "host".to_owned(),
        name => name.into_owned(),
    }
}

/// The name of this process as a writer: what the variable `PEELNET_WORKER` says, or the machine's name and the process's number.
pub fn worker_name() -> String {
    match std::env::var("PEELNET_WORKER") {
        Ok(name) if !name.trim().is_empty() => {
            peelnet_core::files::printable(name.trim()).into_owned()
        }
        _ => format!("{}:{}", host(), std::process::id()),
    }
}
