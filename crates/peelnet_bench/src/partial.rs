//! What an interrupted comparison has measured so far.

use crate::{EvalError, Row, compare::check_pictures};
use peelnet_core::files::{Kind, printable};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::path::{Path, PathBuf};

/// Bytes of the file that are read: a hundred thousand rows have half of it.
const MAX_BYTES: u64 = 1 << 28;

/// Rows of finished views, and the settings they were measured with: only a run with the same settings is resumed.
#[derive(Debug)]
pub struct Partial {
    kept: Kept,
    path: Option<PathBuf>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Kept {
    plan: serde_json::Value,
    #[serde(deserialize_with = "crate::records::checked")]
    rows: Vec<Row>,
}

/// The file: what is kept, and its hash, so that rows that were changed are not taken for measured ones.
#[derive(Serialize, Deserialize)]
struct Stored<K> {
    sha256: String,
    #[serde(flatten)]
    kept: K,
}

fn json(value: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec(value).expect("rows have string keys only")
}

/// Hexadecimal hash of a value's JSON, by which rows are checked and a finished run's settings are known.
pub fn json_hash(value: &impl Serialize) -> String {
    peelnet_core::files::hex(&Sha256::digest(json(value)))
}

impl Partial {
    pub const FILE: &str = "partial.json";

    pub const KIND: Kind = Kind {
        name: "the rows of an interrupted bench",
        is: |head| head.starts_with(b"{\"sha256\":\""),
    };

    /// Starts afresh; the file appears in the folder, if one is given, with the first rows.
    pub fn new(folder: Option<&Path>, plan: serde_json::Value) -> Self {
        Self {
            kept: Kept {
                plan,
                rows: Vec::new(),
            },
            path: folder.map(|f| f.join(Self::FILE)),
        }
    }

    pub fn is_in(folder: &Path) -> bool {
        folder.join(Self::FILE).exists()
    }

    /// Goes on with what a run of the same plan left in a folder; starts afresh where there is nothing.
    ///
    /// # Errors
    /// A file that cannot be read, that is of another plan, or whose rows or pictures are not those that were measured.
    pub fn resume(folder: &Path, plan: serde_json::Value) -> Result<Self, EvalError> {
        let path = folder.join(Self::FILE);
        if !Self::is_in(folder) {
            return Ok(Self::new(Some(folder), plan));
        }
        let refuse = |why: String| EvalError::Resume {
            path: path.clone(),
            why,
        };
        let bytes =
            peelnet_core::files::read(&path, MAX_BYTES).map_err(EvalError::io(&path, "read"))?;
        let found = serde_json::from_slice(&bytes).map_err(|e| refuse(e.to_string()))?;
        let Stored::<Kept> { sha256: hash, kept } = found;
        if kept.plan != plan {
            let settings = plan.as_object().into_iter().flatten();
            let others = settings.filter(|(key, value)| kept.plan.get(key) != Some(*value));
            let names: Vec<&str> = others.map(|(key, _)| key.as_str()).collect();
            let names = names.join(", ");
            let why = format!("it was measured with other settings: {names}");
            return Err(refuse(why));
        }
        if json_hash(&kept) != hash {
            let why = "it was changed after it was written: its sha256 differs";
            return Err(refuse(why.to_owned()));
        }
        check_pictures(&kept.rows, folder)?;
        let path = Some(path);
        Ok(Self { kept, path })
    }

    /// Refuses rows that are not of the plan.
    pub fn check(&self, is_planned: impl Fn(&Row) -> bool) -> Result<(), EvalError> {
        let mut rows = self.kept.rows.iter();
        let Some(foreign) = rows.find(|row| !is_planned(row)) else {
            return Ok(());
        };
        Err(EvalError::Resume {
            path: self.path.clone().unwrap_or_default(),
            why: format!(
                "it holds a row of {} on view {} of {}, which is not of this run",
                printable(&foreign.method),
                foreign.view,
                printable(&foreign.scene)
            ),
        })
    }

    pub fn done(&self, scene: &str) -> Vec<u32> {
        let own = self.kept.rows.iter().filter(|r| r.scene == scene);
        let mut views: Vec<u32> = own.map(|r| r.view).collect();
        views.dedup();
        views
    }

    /// Adds a view's rows, and writes the file again.
    pub fn push(&mut self, rows: Vec<Row>) -> Result<(), EvalError> {
        self.kept.rows.extend(rows);
        let Some(path) = &self.path else {
            return Ok(());
        };
        let stored = Stored {
            sha256: json_hash(&self.kept),
            kept: &self.kept,
        };
        peelnet_core::files::write_whole(path, &json(&stored)).map_err(EvalError::io(path, "write"))
    }

    /// All rows. The file stays until they are safe elsewhere: see [`Partial::discard`].
    pub fn finish(self) -> Vec<Row> {
        self.kept.rows
    }

    /// Removes the file of a run whose results are written.
    pub fn discard(folder: &Path) {
        // Where it cannot be removed, the next run overwrites it.
        let _ = std::fs::remove_file(folder.join(Self::FILE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;
    use serde_json::json;

    /// Views that are done are known; rows of other settings, and rows that somebody changed, are refused.
    #[test]
    fn it_goes_on_with_what_was_measured_so() {
        let dir = tempfile::tempdir().unwrap();
        let plan = json!({"size": [4, 4], "methods": ["a"]});
        let mut first = Partial::resume(dir.path(), plan.clone()).unwrap();
        let rows = [(0, "a", 2.0), (0, "b", 3.0), (1, "a", 4.0)].map(|(view, method, mse)| Row {
            view,
            ..row("s", method, mse)
        });
        first.push(rows.to_vec()).unwrap();
        let second = Partial::resume(dir.path(), plan.clone()).unwrap();
        assert_eq!((second.done("s"), second.done("t")), (vec![0, 1], vec![]));
        let refused = |plan: &serde_json::Value| {
            let resumed = Partial::resume(dir.path(), plan.clone());
            resumed.unwrap_err().to_string()
        };
        let e = refused(&json!({"size": [8, 4], "methods": ["a"]}));
        assert!(e.contains("partial.json"), "{e}");
        assert!(e.ends_with("settings: size"), "{e}");
        let file = dir.path().join(Partial::FILE);
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text.replace("\"mse255\":2.0", "\"mse255\":0.5")).unwrap();
        assert!(refused(&plan).contains("sha256"));
    }
}
