//! A dataset's summary as text.

use peelnet_dataset::Summary;
use peelnet_dataset::summary::Bin;
use peelnet_files::{Kind, printable, thousands};
use std::fmt::Display;

/// Characters of the longest bar of a histogram.
const BAR: f64 = 40.0;

/// By what a file with a summary is known, as text or as JSON.
pub const KIND: Kind = Kind {
    name: "a dataset's summary",
    is: |head| {
        let head = String::from_utf8_lossy(head);
        let json = head.starts_with("{\n  \"") && head.contains("\"checks\": [");
        json || head.starts_with("rows        ")
    },
};

/// Text of many lines.
#[derive(Default)]
pub struct Lines(pub String);

impl Lines {
    /// Adds a line.
    pub fn line(&mut self, text: impl Display) {
        self.0.push_str(&format!("{text}\n"));
    }

    /// Adds a line with a name before it.
    pub fn field(&mut self, name: &str, value: impl Display) {
        self.line(format_args!("{name:<11} {value}"));
    }
}

/// The whole summary.
pub fn summary_text(summary: &Summary) -> String {
    let mut t = Lines::default();
    t.field("rows", thousands(summary.rows));
    t.field("pixels", thousands(summary.pixels));
    t.field("hash", &summary.hash);
    let lost = thousands(summary.lost_fragments);
    t.field("left out", format!("{lost} fragments"));
    let ties = thousands(summary.coplanar_ties);
    t.field(
        "coplanar",
        format!("{ties} pairs of neighbouring fragments at one depth"),
    );
    t.line("\nscenes");
    for scene in &summary.scenes {
        let held_out = if scene.held_out { "  (held out)" } else { "" };
        let (name, rows) = (printable(&scene.name), thousands(scene.rows));
        t.line(format!("  {name:<28} {rows:>14} rows{held_out}"));
    }
    if !summary.columns.is_empty() {
        t.line("\ncolumns                     smallest        largest");
    }
    for column in &summary.columns {
        let (min, max) = (figure(column.min), figure(column.max));
        t.line(format!("  {:<18} {min:>15} {max:>14}", column.name));
    }
    t.line("\nfragments per pixel");
    histogram(&mut t, &summary.fragments_per_pixel, "pixels", |bin| {
        if bin.from < bin.to {
            format!("{:.0}–{:.0}", bin.from, bin.to)
        } else {
            format!("{:.0}", bin.from)
        }
    });
    t.line("\nalpha");
    histogram(&mut t, &summary.alpha, "rows", |bin| {
        format!("{:.2}–{:.2}", bin.from, bin.to)
    });
    t.line("\nchecks");
    for check in &summary.checks {
        let verdict = match check.violations {
            0 => "holds".to_owned(),
            n => format!("VIOLATED by {} rows", thousands(n)),
        };
        t.line(format!(
            "  {:<16} {verdict}: {} (worst {}, {:.2} of the tolerance)",
            check.name,
            check.formula,
            figure(check.worst),
            check.worst_ratio
        ));
    }
    if summary.parts_not_checked > 0 {
        t.line(format!(
            "  {} parts were not checked, because peeling left fragments out of them",
            summary.parts_not_checked
        ));
    }
    for v in &summary.violations {
        t.line(format!(
            "  {} row {}: {} is {}, recomputed {} (tolerance {:.1e})",
            v.file, v.row, v.check, v.found, v.expected, v.tolerance
        ));
    }
    t.0
}

/// A number in at most ten characters or so.
fn figure(v: f64) -> String {
    if v == v.trunc() && v.abs() < 1e9 {
        format!("{v:.0}")
    } else if v.abs() >= 1e-3 && v.abs() < 1e6 {
        format!("{v:.5}")
    } else {
        format!("{v:.3e}")
    }
}

fn histogram(t: &mut Lines, bins: &[Bin], unit: &str, label: impl Fn(&Bin) -> String) {
    let most = bins.iter().map(|b| b.count).max().unwrap_or(0).max(1) as f64;
    // Empty bins at both ends are left out.
    let first = bins.iter().position(|b| b.count > 0).unwrap_or(0);
    let last = bins.iter().rposition(|b| b.count > 0).map_or(0, |k| k + 1);
    for bin in &bins[first..last.max(first)] {
        let bar = "#".repeat((bin.count as f64 / most * BAR).ceil() as usize);
        let (label, count) = (label(bin), thousands(bin.count));
        let line = format!("  {label:>12} {count:>14} {unit}  {bar}");
        t.line(line.trim_end());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn histograms_leave_empty_ends_out() {
        for (counts, lines) in [(&[0, 4, 0, 1, 0][..], 3), (&[], 0)] {
            let bin = |(from, &count): (u8, &u64)| Bin {
                from: from.into(),
                to: from.into(),
                count,
            };
            let bins: Vec<Bin> = (1..).zip(counts).map(bin).collect();
            let mut t = Lines::default();
            histogram(&mut t, &bins, "pixels", |b| figure(b.from));
            assert_eq!(t.0.lines().count(), lines, "{}", t.0);
            assert_eq!(t.0.contains(&"#".repeat(40)), lines > 0, "{}", t.0);
        }
    }

    #[test]
    fn figures() {
        let found = [12.0, 0.25, 1.5e-8].map(figure);
        assert_eq!(found, ["12", "0.25000", "1.500e-8"]);
    }
}
