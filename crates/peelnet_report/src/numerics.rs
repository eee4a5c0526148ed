//! The files of `peelnet stress --numerics`: what target formats cost in accuracy.

use crate::{ReportError, Results, Table, files::write_file};
use peelnet_eval::numerics::{Added, Blended, Numerics};
use std::path::Path;

impl Results<Numerics> {
    /// The files that [`Self::write`] writes.
    pub const FILES: &[&str] = &["numerics.json", "numerics.md"];

    /// The formats by themselves.
    pub fn blended_table(&self) -> Table {
        let headings = [
            "format", "blending", "source", "layers", "exact", "measured", "error", "bound",
        ];
        let line = |b: &Blended| {
            vec![
                b.format.clone(),
                b.blending.clone(),
                format!("{}", b.source),
                b.layers.to_string(),
                short(b.exact),
                b.measured.map_or_else(|| "not finite".to_owned(), short),
                format!("{:.1e}", b.error()),
                format!("{:.1e}", b.bound),
            ]
        };
        Table::new(headings, self.measured.blended.iter().map(line))
    }

    /// The methods in 16 bits against 32.
    pub fn added_table(&self) -> Table {
        let headings = [
            "method",
            "layers",
            "16 bits add, typically",
            "at worst",
            "bound",
            "own error at worst",
        ];
        let line = |a: &Added| {
            let bound = a.bound;
            vec![
                a.method.clone(),
                a.layers.to_string(),
                format!("{:.1e}", a.typical),
                format!("{:.1e}", a.worst),
                bound.map_or_else(|| "–".to_owned(), |b| format!("{b:.1e}")),
                format!("{:.1e}", a.own_error),
            ]
        };
        Table::new(headings, self.measured.added.iter().map(line))
    }

    /// Both tables, for docs/numerics.md.
    pub fn markdown(&self) -> String {
        format!(
            "{}\n{}\n{}\n",
            self.blended_table().markdown(),
            self.added_table().markdown(),
            self.credit()
        )
    }

    /// Writes `numerics.json` and `numerics.md` into a folder.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), ReportError> {
        self.write_json(&folder.join("numerics.json"))?;
        write_file(&folder.join("numerics.md"), self.markdown())
    }
}

fn short(x: f64) -> String {
    if x >= 100.0 {
        format!("{x:.0}")
    } else {
        format!("{x:.4}")
    }
}
