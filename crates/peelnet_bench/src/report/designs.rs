//! The files of `peelnet bench designs`: what designs of slabs are worth.

use crate::designs::{Designs, Kept, Row, Score};
use crate::report::{Files, Measurement, Results, Table};

impl Measurement for Designs {
    const FILES: Files<Self> = &[
        ("designs.json", Results::json),
        ("designs.md", |r, _| Ok(r.markdown())),
    ];
}

impl Results<Designs> {
    /// A row for each design, in the order of their file, and one for each reference.
    pub fn table(&self) -> Table {
        let measured = &self.measured;
        let rows = measured.rows.iter();
        let rows = rows.map(|r| Line(&r.design, Some(r), &r.network));
        let references = measured.references.iter();
        let references = references.map(|r| Line(&r.method, None, &r.score));
        let lines: Vec<Line<'_>> = rows.chain(references).collect();
        Table::from_rows(
            &lines,
            &[
                ("design", &|line| line.0.to_owned()),
                ("ends", &|l| l.row(|r| joined(r, |s| s.end.to_string()))),
                ("kept", &|l| l.row(|r| joined(r, slab_text))),
                ("records", &|l| l.row(|r| r.records.clone())),
                ("range", &|l| l.row(|r| r.range.clone())),
                ("sums", &|l| l.row(sums)),
                ("loss", &|l| l.row(|r| r.loss.to_string())),
                ("bytes", &|l| l.row(|r| r.bytes.to_string())),
                ("network", &|l| l.row(|r| r.topology.clone())),
                ("parameters", &|l| l.row(|r| r.parameters.to_string())),
                ("seconds", &|l| l.row(|r| format!("{:.1}", r.seconds))),
                ("/ mboit4", &|l| ratio(l.2.to_moments)),
                ("worst scene", &|l| worst(l.2)),
                ("/ kbuffer-4", &|l| ratio(l.2.to_kbuffer)),
                ("contour pairs %", &|l| percent(l.2.contour_pairs)),
                ("flicker % 0.1 px", &|l| percent(l.2.flicker[0])),
                ("1 px", &|l| percent(l.2.flicker[1])),
                ("no network: / mboit4", &|l| {
                    l.row(|r| ratio(r.middle.to_moments))
                }),
                ("worst scene", &|l| l.row(|r| worst(&r.middle))),
                ("/ kbuffer-4", &|l| l.row(|r| ratio(r.middle.to_kbuffer))),
                ("contour pairs %", &|l| {
                    l.row(|r| percent(r.middle.contour_pairs))
                }),
            ],
        )
    }

    fn markdown(&self) -> String {
        let Designs {
            file,
            trained_on,
            judged_on,
            learning_rate,
            epochs,
            ..
        } = &self.measured;
        format!(
            "{}\nDesigns of {file}. *Kept* of each slab: M mean depth, N nearest, F farthest fragment. *Sums*: `one`, or known colours `apart`.\n\
             Trained on {}; {epochs} epochs, learning rate {learning_rate}. Judged on {}. One training each: small differences are chance.\n\
             Statistics are rounded as 16-bit targets round them, colours are not. {}\n",
            self.table().markdown(),
            trained_on.join(", "),
            judged_on.join(", "),
            self.credit(),
        )
    }
}

/// A line of the table: a design or a method that errors are compared with, and its errors.
struct Line<'a>(&'a str, Option<&'a Row>, &'a Score);

impl Line<'_> {
    /// What only designs have.
    fn row(&self, cell: impl Fn(&Row) -> String) -> String {
        self.1.map_or_else(String::new, cell)
    }
}

fn joined(row: &Row, text: impl Fn(&Kept) -> String) -> String {
    row.slabs.iter().map(text).collect::<Vec<_>>().join(" ")
}

fn slab_text(slab: &Kept) -> String {
    let letters = [(slab.mean, 'M'), (slab.nearest, 'N'), (slab.farthest, 'F')];
    let kept: String = letters.iter().filter(|l| l.0).map(|l| l.1).collect();
    if kept.is_empty() {
        "–".to_owned()
    } else {
        kept
    }
}

fn sums(row: &Row) -> String {
    let sums = |apart| if apart { "apart" } else { "one" };
    if row.trained_apart == row.apart {
        return sums(row.apart).to_owned();
    }
    format!("{}, trained {}", sums(row.apart), sums(row.trained_apart))
}

fn worst(score: &Score) -> String {
    match (&score.worst_scene, score.worst) {
        (Some(scene), Some(worst)) => format!("{} ({scene})", significant(worst)),
        _ => "–".to_owned(),
    }
}

fn ratio(x: Option<f64>) -> String {
    x.map_or_else(|| "–".to_owned(), significant)
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
    use super::*;

    #[test]
    fn designs_are_told_in_short() {
        let slab = |mean, farthest| Kept {
            end: 0.5,
            mean,
            nearest: mean,
            farthest,
        };
        let row = Row {
            slabs: vec![slab(true, true), slab(false, false)],
            trained_apart: true,
            ..Row::default()
        };
        assert_eq!(joined(&row, slab_text), "MNF –");
        assert_eq!(sums(&row), "one, trained apart");
        assert_eq!([0.01, 0.0, 123.4].map(significant), ["0.0100", "0", "123"]);
    }
}
