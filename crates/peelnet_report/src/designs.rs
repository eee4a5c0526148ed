//! The files of `peelnet bench --designs`: what designs of slabs are worth.

use crate::{ReportError, Results, Table, files::write_file};
use peelnet_eval::designs::{Designs, Kept, Row, Score};
use std::path::Path;

impl Results<Designs> {
    /// The files that [`Self::write`] writes.
    pub const FILES: &[&str] = &["designs.json", "designs.md"];

    /// A row for each design, in the order of their file, and one for each reference.
    pub fn table(&self) -> Table {
        let headings = [
            "design",
            "ends",
            "kept",
            "records",
            "range",
            "sums",
            "loss",
            "bytes",
            "network",
            "parameters",
            "seconds",
            "/ mboit4",
            "worst scene",
            "/ kbuffer-4",
            "contour pairs %",
            "flicker % 0.1 px",
            "1 px",
            "no network: / mboit4",
            "worst scene",
            "/ kbuffer-4",
            "contour pairs %",
        ];
        let measured = &self.measured;
        let references = measured.references.iter().map(|reference| {
            let mut cells = vec![reference.method.clone()];
            cells.resize(11, String::new());
            cells.extend(score(&reference.score));
            cells.extend(reference.score.flicker.map(percent));
            cells.resize(headings.len(), String::new());
            cells
        });
        Table::new(headings, measured.rows.iter().map(line).chain(references))
    }

    /// Writes `designs.json` and `designs.md`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), ReportError> {
        self.write_json(&folder.join("designs.json"))?;
        let Designs {
            file,
            trained_on,
            judged_on,
            learning_rate,
            epochs,
            ..
        } = &self.measured;
        let text = format!(
            "{}\nDesigns of {file}. *Kept* of each slab: M mean depth, N nearest, F farthest fragment. *Sums*: `one`, or known colours `apart`.\n\
             Trained on {}; {epochs} epochs, learning rate {learning_rate}. Judged on {}. One training each: small differences are chance.\n\
             Statistics are rounded as 16-bit targets round them, colours are not. {}\n",
            self.table().markdown(),
            trained_on.join(", "),
            judged_on.join(", "),
            self.credit(),
        );
        write_file(&folder.join("designs.md"), text)
    }
}

fn line(row: &Row) -> Vec<String> {
    let ends: Vec<String> = row.slabs.iter().map(|s| s.end.to_string()).collect();
    let kept: Vec<String> = row.slabs.iter().map(kept).collect();
    let sums = |apart| if apart { "apart" } else { "one" };
    let mut sum = sums(row.apart).to_owned();
    if row.trained_apart != row.apart {
        sum = format!("{sum}, trained {}", sums(row.trained_apart));
    }
    let mut cells = vec![
        row.design.clone(),
        ends.join(" "),
        kept.join(" "),
        row.records.clone(),
        row.range.clone(),
        sum,
        row.loss.name().to_owned(),
        row.bytes.to_string(),
        row.topology.clone(),
        row.parameters.to_string(),
        format!("{:.1}", row.seconds),
    ];
    cells.extend(score(&row.network));
    cells.extend(row.network.flicker.map(percent));
    cells.extend(score(&row.middle));
    cells
}

fn kept(slab: &Kept) -> String {
    let letters = [(slab.mean, 'M'), (slab.nearest, 'N'), (slab.farthest, 'F')];
    let kept: String = letters.iter().filter(|l| l.0).map(|l| l.1).collect();
    if kept.is_empty() {
        "–".to_owned()
    } else {
        kept
    }
}

fn score(score: &Score) -> [String; 4] {
    let number = |x: Option<f64>| x.map_or_else(|| "–".to_owned(), significant);
    let worst = match (&score.worst_scene, score.worst) {
        (Some(scene), Some(worst)) => format!("{} ({scene})", significant(worst)),
        _ => "–".to_owned(),
    };
    [
        number(score.to_moments),
        worst,
        number(score.to_kbuffer),
        percent(score.contour_pairs),
    ]
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:.2}", 100.0 * share))
}

/// Three digits of a ratio.
fn significant(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let before = x.abs().log10().floor();
    let decimals = (2.0 - before).clamp(0.0, 9.0) as usize;
    format!("{x:.decimals$}")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::testing::machine;
    use peelnet_eval::designs::Reference;

    #[test]
    fn ratios_have_three_digits() {
        let shown = [0.0, 0.000_912_34, 0.25, 1.0, 174.25].map(significant);
        assert_eq!(shown, ["0", "0.000912", "0.250", "1.00", "174"]);
    }

    #[test]
    fn files_are_written() {
        let dir = tempfile::tempdir().unwrap();
        let slab = |end, mean, farthest| Kept {
            end,
            mean,
            nearest: true,
            farthest,
        };
        let network = Score {
            to_moments: Some(0.01),
            to_kbuffer: Some(0.25),
            worst_scene: Some("s".into()),
            worst: Some(0.5),
            contour_pairs: Some(0.003),
            flicker: [Some(0.001), None],
        };
        let row = Row {
            design: "medium".into(),
            slabs: vec![slab(0.5, true, true), slab(1.0, false, false)],
            records: "1920x32".into(),
            range: "pixel".into(),
            apart: false,
            trained_apart: true,
            bytes: 22,
            inputs: vec!["root_absorbance".into()],
            topology: "9-12-1".into(),
            parameters: 133,
            loss: Default::default(),
            seed: 1,
            examples: 10,
            seconds: 2.5,
            network: network.clone(),
            middle: Score::default(),
        };
        let designs = Designs {
            file: "f.toml".into(),
            trained_on: vec!["t".into()],
            judged_on: vec!["s".into()],
            learning_rate: 0.016,
            epochs: 20,
            references: vec![Reference {
                method: "mboit4".into(),
                score: network,
            }],
            rows: vec![row],
        };
        let results = Results::new(machine(), "peelnet bench s --designs d", designs);
        results.write(dir.path()).unwrap();
        let text = std::fs::read_to_string(dir.path().join("designs.md")).unwrap();
        let line = "| medium | 0.5 1 | MNF N | 1920x32 | pixel | one, trained apart | image | 22 | 9-12-1 | 133 | 2.5 | 0.0100 | 0.500 (s) | 0.250 | 0.30 | 0.10 | – | – | – | – | – |";
        assert!(text.contains(line), "{text}");
        let json = dir.path().join("designs.json");
        assert_eq!(Results::<Designs>::read(&json).unwrap(), results);
        crate::testing::assert_files(dir.path(), Results::<Designs>::FILES);
    }
}
