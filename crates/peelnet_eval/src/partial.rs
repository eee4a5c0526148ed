//! What an interrupted comparison has measured so far.

use crate::{EvalError, Row};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Rows of finished views, and the settings they were measured with: only a run with the same settings is resumed.
#[derive(Debug, Serialize, Deserialize)]
pub struct Partial {
    plan: serde_json::Value,
    rows: Vec<Row>,
    /// Where it is kept, if anywhere.
    #[serde(skip)]
    path: Option<PathBuf>,
}

impl Partial {
    /// Starts afresh; the file appears in the folder, if one is given, with the first rows.
    pub fn new(folder: Option<&Path>, plan: serde_json::Value) -> Self {
        Self {
            plan,
            rows: Vec::new(),
            path: folder.map(|f| f.join("partial.json")),
        }
    }

    /// Goes on with what a run of the same plan left in a folder; starts afresh where there is nothing.
    ///
    /// # Errors
    /// A file that cannot be read, or that is of another plan.
    pub fn resume(folder: &Path, plan: serde_json::Value) -> Result<Self, EvalError> {
        let path = folder.join("partial.json");
        if !path.exists() {
            return Ok(Self::new(Some(folder), plan));
        }
        let refuse = |why: String| EvalError::Resume {
            path: path.clone(),
            why,
        };
        let bytes = std::fs::read(&path).map_err(EvalError::io(&path, "read"))?;
        let found: Self = serde_json::from_slice(&bytes).map_err(|e| refuse(e.to_string()))?;
        if found.plan != plan {
            let differs = |key: &str| found.plan.get(key) != plan.get(key);
            let keys = plan
                .as_object()
                .into_iter()
                .flatten()
                .map(|(k, _)| k.as_str());
            let names: Vec<&str> = keys.filter(|k| differs(k)).collect();
            return Err(refuse(format!(
                "it was measured with other settings: {}",
                names.join(", ")
            )));
        }
        Ok(Self {
            path: Some(path),
            ..found
        })
    }

    /// All rows so far.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Views of a scene that are done.
    pub fn done(&self, scene: &str) -> Vec<u32> {
        let mut views: Vec<u32> = self
            .rows
            .iter()
            .filter(|r| r.scene == scene)
            .map(|r| r.view)
            .collect();
        views.dedup();
        views
    }

    /// Adds a view's rows, and writes the file again.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn push(&mut self, rows: Vec<Row>) -> Result<(), EvalError> {
        self.rows.extend(rows);
        let Some(path) = &self.path else {
            return Ok(());
        };
        let json = serde_json::to_vec(self).expect("rows have string keys only");
        peelnet_files::write_whole(path, &json).map_err(EvalError::io(path, "write"))
    }

    /// All rows; the file is no longer needed.
    pub fn finish(self) -> Vec<Row> {
        // Where it cannot be removed, the next run refuses or overwrites it.
        let _ = self.path.map(std::fs::remove_file);
        self.rows
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::row::tests::row;
    use serde_json::json;

    #[test]
    fn it_goes_on_where_it_stopped() {
        let dir = tempfile::tempdir().unwrap();
        let plan = json!({"size": [4, 4], "methods": ["a"]});
        let mut first = Partial::resume(dir.path(), plan.clone()).unwrap();
        first
            .push(vec![row("s", 0, "a", 1.0), row("s", 0, "b", 2.0)])
            .unwrap();
        drop(first);
        let mut second = Partial::resume(dir.path(), plan).unwrap();
        assert_eq!((second.done("s"), second.done("t")), (vec![0], vec![]));
        second.push(vec![row("s", 1, "a", 3.0)]).unwrap();
        assert_eq!(second.done("s"), [0, 1]);
        assert_eq!(second.finish().len(), 3);
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
    }

    #[test]
    fn another_plan_is_refused_and_named() {
        let dir = tempfile::tempdir().unwrap();
        let mut first = Partial::new(Some(dir.path()), json!({"size": [4, 4], "methods": ["a"]}));
        first.push(vec![row("s", 0, "a", 1.0)]).unwrap();
        let other = json!({"size": [8, 4], "methods": ["a"]});
        let e = Partial::resume(dir.path(), other).unwrap_err().to_string();
        assert!(
            e.contains("partial.json") && e.ends_with("settings: size"),
            "{e}"
        );
        std::fs::write(dir.path().join("partial.json"), "{").unwrap();
        assert!(Partial::resume(dir.path(), json!({})).is_err());
    }
}
