//! `_peelnet/parts/00003.json`: that a part is finished, and by whom. A part is the dataset's once its record is there.

use serde::{Deserialize, Serialize};

use crate::error::DatasetError;
use crate::layout;
use crate::manifest::{self, Part, SCHEMA_VERSION};
use crate::plan::Plan;
use crate::store::Store;

/// Bytes of a record that are read.
const MAX_BYTES: u64 = 1 << 24;

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
        let name = layout::record(index);
        let Some(bytes) = store.get(&name, MAX_BYTES)? else {
            return Ok(None);
        };
        let path = store.shown(&name);
        manifest::check_schema(&path, &bytes)?;
        let wrong = |reason: String| DatasetError::Record {
            path: path.clone(),
            index,
            reason,
        };
        let record: Self =
            serde_json::from_slice(&bytes).map_err(|e| wrong(format!("wrong record: {e}")))?;
        let worker = peelnet_files::printable(&record.worker);
        if record.part.index != index {
            return Err(wrong(format!(
                "the record of worker {worker} is of part {}, so it was copied or renamed",
                record.part.index
            )));
        }
        if let Some(plan) = plan.filter(|p| p.hash != record.plan) {
            return Err(wrong(format!(
                "worker {worker} wrote it by another plan ({}) than the dataset's ({}): another version, size, seed, flag or adapter",
                short(&record.plan),
                short(&plan.hash)
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
        let mut text = serde_json::to_string_pretty(self)
            .expect("a record has string keys and finite numbers only");
        text.push('\n');
        if store.put_if_absent(&layout::record(index), text.as_bytes())? {
            return Ok(());
        }
        // Gone again: somebody removes records while this works.
        let Some(there) = Self::read(store, index, Some(plan))? else {
            return Err(DatasetError::Busy {
                path: store.path().to_owned(),
            });
        };
        self.same_bytes(store, &there)
    }

    /// An error if another record of this part is of other bytes.
    pub(crate) fn same_bytes(&self, store: &dyn Store, there: &Self) -> Result<(), DatasetError> {
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

/// The start of a hash, for messages.
fn short(hash: &str) -> String {
    peelnet_files::printable(hash).chars().take(12).collect()
}
