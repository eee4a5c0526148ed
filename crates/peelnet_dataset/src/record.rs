//! `_peelnet/parts/00003.json`: that a part is finished, and by whom. A part is the dataset's once its record is there.

use serde::{Deserialize, Serialize};

use crate::error::DatasetError;
use crate::manifest::{Part, SCHEMA_VERSION, from_json, to_json};
use crate::plan::Plan;
use crate::store::{FRAGMENTS, PARTS, Store};

/// Bytes of a record that are read.
const MAX_BYTES: u64 = 1 << 24;

/// The name of a part's record.
pub(crate) fn name(index: u32) -> String {
    format!("{PARTS}{index:05}.json")
}

/// The part whose record has this name.
pub(crate) fn index(name: &str) -> Option<u32> {
    let digits = name.strip_prefix(PARTS)?.strip_suffix(".json")?;
    digits.parse().ok().filter(|&k| self::name(k) == name)
}

/// The part that a file of rows belongs to, by its name.
pub(crate) fn part_index(name: &str) -> Option<u32> {
    let (digits, _) = name.strip_prefix(FRAGMENTS)?.split_once('-')?;
    let index = digits.parse().ok();
    index.filter(|k| format!("{k:05}") == digits)
}

/// A finished part. The file is its JSON, with these names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PartRecord {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema: u32,
    /// Hash of the plan that the writer followed.
    pub plan: String,
    /// The writer's name.
    pub worker: String,
    /// The part, as it will be in the manifest.
    pub part: Part,
}

impl PartRecord {
    pub(crate) fn new(plan: &Plan, worker: &str, part: Part) -> Self {
        Self {
            schema: SCHEMA_VERSION,
            plan: plan.hash.clone(),
            worker: worker.to_owned(),
            part,
        }
    }

    /// Reads a part's record; `None` where there is none.
    ///
    /// # Errors
    /// A record that cannot be read, is of another part, or follows another plan than this one.
    pub(crate) fn read(
        store: &dyn Store,
        index: u32,
        plan: Option<&Plan>,
    ) -> Result<Option<Self>, DatasetError> {
        let name = name(index);
        let Some(bytes) = store.get(&name, MAX_BYTES)? else {
            return Ok(None);
        };
        let path = store.shown(&name);
        let wrong = |reason: String| DatasetError::Record {
            path: path.clone(),
            index,
            reason,
        };
        let record: Self = from_json(&path, "record", &bytes).map_err(|e| match e {
            DatasetError::Manifest { reason, .. } => wrong(reason),
            other => other,
        })?;
        let worker = peelnet_files::printable(&record.worker);
        if record.part.index != index {
            return Err(wrong(format!(
                "the record of worker {worker} is of part {}, so it was copied or renamed",
                record.part.index
            )));
        }
        if let Some(plan) = plan.filter(|p| p.hash != record.plan) {
            let start = |hash: &str| -> String {
                let hash = peelnet_files::printable(hash);
                hash.chars().take(12).collect()
            };
            return Err(wrong(format!(
                "worker {worker} wrote it by another plan ({}) than the dataset's ({}): another version, size, seed, flag or adapter",
                start(&record.plan),
                start(&plan.hash)
            )));
        }
        Ok(Some(record))
    }

    /// Makes this the part's record. Where there is one already, it must be of the same bytes.
    ///
    /// # Errors
    /// A record of other bytes, which names both workers.
    pub(crate) fn commit(&self, store: &dyn Store, plan: &Plan) -> Result<(), DatasetError> {
        let index = self.part.index;
        if store.put_if_absent(&name(index), to_json(self).as_bytes())? {
            return Ok(());
        }
        match Self::read(store, index, Some(plan))? {
            Some(there) => self.check_same(store, &there),
            // Gone again: somebody removes records while this works.
            None => Err(DatasetError::Busy {
                path: store.path().to_owned(),
            }),
        }
    }

    /// An error if another record of this part is of other bytes.
    pub(crate) fn check_same(&self, store: &dyn Store, there: &Self) -> Result<(), DatasetError> {
        if there.part.files == self.part.files {
            return Ok(());
        }
        Err(DatasetError::PartConflict {
            path: store.path().to_owned(),
            index: self.part.index,
            worker: self.worker.clone(),
            other: there.worker.clone(),
        })
    }
}
