//! `_peelnet/plan.json`: what all writers of a dataset agree on.
//!
//! The plan's hash covers everything that shapes the rows, and nothing else: scenes by their contents and not by their paths, and no
//! command line. Who would write other rows is refused before the first one.

use std::collections::BTreeMap;

use peelnet_files::hex;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::error::DatasetError;
use crate::format::Format;
use crate::layout;
use crate::manifest::{self, MAX_WORK_ITEMS, Manifest, Part, SCHEMA_VERSION, SceneEntry};
use crate::store::Store;
use crate::writer::Header;

/// Bytes of a plan that are read.
const MAX_BYTES: u64 = 1 << 28;

/// What all writers of a dataset agree on. The file is its JSON, with these names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// [`SCHEMA_VERSION`] of the first writer.
    pub schema: u32,
    /// Hash over everything that shapes the rows.
    pub hash: String,
    /// Version of the program.
    pub tool_version: String,
    /// Format of all parts.
    pub format: Format,
    /// Seed of sampling and augmentation.
    pub seed: u64,
    /// Adapters that are expected to give the same bytes.
    pub adapter_class: String,
    /// How it peels: `sbuffer`, `dual` or `single`.
    pub peel: String,
    /// Fraction of the pixels that is kept, 0 … 1.
    pub pixels_fraction: f64,
    /// Varied copies of each scene beside the scene itself.
    pub augment: u32,
    /// Everything else that shapes the rows, by name: the frame size, the cameras, limits.
    pub settings: BTreeMap<String, String>,
    /// Number of work items.
    pub work_items: u32,
    /// The scenes. Their paths are the first writer's and not in the hash.
    pub scenes: Vec<SceneEntry>,
    /// The first writer's adapter; not in the hash.
    pub adapter: String,
    /// The first writer's command line; not in the hash.
    pub command: String,
    /// The first writer's name; not in the hash.
    pub worker: String,
}

impl Plan {
    /// The plan of a header.
    pub(crate) fn of(header: &Header) -> Self {
        let mut plan = Self {
            schema: SCHEMA_VERSION,
            hash: String::new(),
            tool_version: header.tool_version.clone(),
            format: header.format,
            seed: header.seed,
            adapter_class: header.adapter_class.clone(),
            peel: header.peel.clone(),
            pixels_fraction: header.pixels_fraction,
            augment: header.augment,
            settings: header.settings.clone(),
            work_items: header.work_items,
            scenes: header.scenes.clone(),
            adapter: header.adapter.clone(),
            command: header.command.clone(),
            worker: header.worker.clone(),
        };
        plan.hash = plan.computed_hash();
        plan
    }

    /// Everything that shapes the rows, by name.
    fn fields(&self) -> Vec<(String, String)> {
        let named = |name: &str, value: String| (name.to_owned(), value);
        let mut fields = vec![
            named("schema version", self.schema.to_string()),
            named("peelnet version", self.tool_version.clone()),
            named("adapter class", self.adapter_class.clone()),
            named("format", self.format.to_string()),
            named("seed", self.seed.to_string()),
            named("peeling method", self.peel.clone()),
            named("fraction of pixels", self.pixels_fraction.to_string()),
            named("number of copies", self.augment.to_string()),
            named("number of scenes", self.scenes.len().to_string()),
        ];
        for (k, scene) in self.scenes.iter().enumerate() {
            let held_out = if scene.held_out { ", held out" } else { "" };
            let value = format!("{} with sha256 {}{held_out}", scene.name, scene.sha256);
            fields.push((format!("scene {k}"), value));
        }
        // Behind the scenes: when these differ, the cameras do as well.
        let settings = self.settings.iter();
        fields.extend(settings.map(|(k, v)| (k.clone(), v.clone())));
        fields.push(named("number of work items", self.work_items.to_string()));
        fields
    }

    fn computed_hash(&self) -> String {
        let mut hasher = Sha256::new();
        for (name, value) in self.fields() {
            // Quoted: no value can look like the next line.
            hasher.update(format!("{name:?} {value:?}\n"));
        }
        hex(&hasher.finalize())
    }

    /// The first field in which two plans differ, with both values.
    fn difference(&self, other: &Self) -> Option<(String, String, String)> {
        let (mine, others) = (self.fields(), other.fields());
        for (name, value) in &mine {
            match others.iter().find(|(n, _)| n == name) {
                Some((_, theirs)) if theirs == value => {}
                Some((_, theirs)) => return Some((name.clone(), value.clone(), theirs.clone())),
                None => return Some((name.clone(), value.clone(), "nothing".to_owned())),
            }
        }
        let more = others
            .iter()
            .find(|(n, _)| mine.iter().all(|(m, _)| m != n));
        more.map(|(name, value)| (name.clone(), "nothing".to_owned(), value.clone()))
    }

    /// Reads and checks a dataset's plan; `None` where there is none.
    ///
    /// # Errors
    /// A plan that cannot be read or was edited.
    pub(crate) fn read(store: &dyn Store) -> Result<Option<Self>, DatasetError> {
        let Some(bytes) = store.get(layout::PLAN, MAX_BYTES)? else {
            return Ok(None);
        };
        let path = store.shown(layout::PLAN);
        manifest::check_schema(&path, &bytes)?;
        let wrong = |reason: String| DatasetError::Manifest {
            path: path.clone(),
            reason,
        };
        let plan: Self =
            serde_json::from_slice(&bytes).map_err(|e| wrong(format!("wrong plan: {e}")))?;
        if plan.work_items == 0 || plan.work_items > MAX_WORK_ITEMS {
            return Err(wrong(format!(
                "{} work items, and from 1 to {MAX_WORK_ITEMS} are read",
                plan.work_items
            )));
        }
        if plan.hash != plan.computed_hash() {
            return Err(wrong(
                "`hash` does not fit the plan: it was edited".to_owned(),
            ));
        }
        Ok(Some(plan))
    }

    /// Makes this the dataset's plan, or checks that the one that is there is the same. Returns the dataset's plan, and whether it is new.
    ///
    /// # Errors
    /// A plan that differs, which names the first difference.
    pub(crate) fn agree(&self, store: &dyn Store) -> Result<(Self, bool), DatasetError> {
        let mut text = serde_json::to_string_pretty(self)
            .expect("a plan has string keys and finite numbers only");
        text.push('\n');
        // The plan that is there first: one request less for all writers but the first.
        let there = match Self::read(store)? {
            None if store.put_if_absent(layout::PLAN, text.as_bytes())? => {
                return Ok((self.clone(), true));
            }
            None => Self::read(store)?,
            there => there,
        };
        let Some(there) = there else {
            return Err(DatasetError::Busy {
                path: store.path().to_owned(),
            });
        };
        match self.difference(&there) {
            None => Ok((there, false)),
            Some((field, mine, theirs)) => Err(DatasetError::PlanDiffers {
                path: store.path().to_owned(),
                difference: format!(
                    "its {field} is {theirs} (worker {}), and here (worker {}) it is {mine}",
                    there.worker, self.worker
                ),
            }),
        }
    }

    /// The manifest of these parts.
    pub(crate) fn manifest(&self, parts: Vec<Part>) -> Manifest {
        let mut manifest = Manifest {
            schema: self.schema,
            plan: self.hash.clone(),
            tool_version: self.tool_version.clone(),
            command: self.command.clone(),
            format: self.format,
            columns: manifest::columns(),
            seed: self.seed,
            adapter: self.adapter.clone(),
            peel: self.peel.clone(),
            pixels_fraction: self.pixels_fraction,
            augment: self.augment,
            settings: self.settings.clone(),
            scenes: self.scenes.clone(),
            work_items: self.work_items,
            shard: None,
            rows: 0,
            pixels: 0,
            lost_fragments: 0,
            coplanar_ties: 0,
            hash: String::new(),
            parts,
        };
        manifest.total();
        manifest
    }
}
