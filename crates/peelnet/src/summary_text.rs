//! A dataset's summary as text.

use peelnet_dataset::Summary;
use peelnet_dataset::summary::Bin;
use peelnet_files::{Kind, printable, thousands};
use std::fmt::Write as _;

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

/// The whole summary.
pub fn summary_text(summary: &Summary) -> String {
    let mut t = String::new();
    let _ = writeln!(t, "rows        {}", thousands(summary.rows));
    let _ = writeln!(t, "pixels      {}", thousands(summary.pixels));
    let _ = writeln!(t, "hash        {}", summary.hash);
    let _ = writeln!(
        t,
        "left out    {} fragments",
        thousands(summary.lost_fragments)
    );
    let _ = writeln!(
        t,
        "coplanar    {} pairs of neighbouring fragments at one depth",
        thousands(summary.coplanar_ties)
    );
    t.push_str("\nscenes\n");
    for scene in &summary.scenes {
        let held_out = if scene.held_out { "  (held out)" } else { "" };
        let _ = writeln!(
            t,
            "  {:<28} {:>14} rows{held_out}",
            printable(&scene.name),
            thousands(scene.rows)
        );
    }
    if !summary.columns.is_empty() {
        t.push_str("\ncolumns                     smallest        largest\n");
        for column in &summary.columns {
            let _ = writeln!(
                t,
                "  {:<18} {:>15} {:>14}",
                column.name,
                figure(column.min),
                figure(column.max)
            );
        }
    }
    t.push_str("\nfragments per pixel\n");
    histogram(&mut t, &summary.fragments_per_pixel, "pixels", |bin| {
        if bin.from < bin.to {
            format!("{:.0}–{:.0}", bin.from, bin.to)
        } else {
            format!("{:.0}", bin.from)
        }
    });
    t.push_str("\nalpha\n");
    histogram(&mut t, &summary.alpha, "rows", |bin| {
        format!("{:.2}–{:.2}", bin.from, bin.to)
    });
    t.push_str("\nchecks\n");
    for check in &summary.checks {
        let verdict = if check.violations == 0 {
            "holds".to_owned()
        } else {
            format!("VIOLATED by {} rows", thousands(check.violations))
        };
        let _ = writeln!(
            t,
            "  {:<16} {verdict}: {} (worst {}, {:.2} of the tolerance)",
            check.name,
            check.formula,
            figure(check.worst),
            check.worst_ratio
        );
    }
    if summary.parts_not_checked > 0 {
        let _ = writeln!(
            t,
            "  {} parts were not checked, because peeling left fragments out of them",
            summary.parts_not_checked
        );
    }
    for v in &summary.violations {
        let _ = writeln!(
            t,
            "  {} row {}: {} is {}, recomputed {} (tolerance {:.1e})",
            v.file, v.row, v.check, v.found, v.expected, v.tolerance
        );
    }
    t
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

fn histogram(t: &mut String, bins: &[Bin], unit: &str, label: impl Fn(&Bin) -> String) {
    let most = bins.iter().map(|b| b.count).max().unwrap_or(0).max(1) as f64;
    // Empty bins at both ends are left out.
    let first = bins.iter().position(|b| b.count > 0).unwrap_or(0);
    let last = bins.iter().rposition(|b| b.count > 0).map_or(0, |k| k + 1);
    for bin in &bins[first..last.max(first)] {
        let bar = "#".repeat((bin.count as f64 / most * BAR).ceil() as usize);
        let line = format!(
            "  {:>12} {:>14} {unit}  {bar}",
            label(bin),
            thousands(bin.count)
        );
        let _ = writeln!(t, "{}", line.trim_end());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn histograms_leave_empty_ends_out() {
        let bin = |from: f64, count| Bin {
            from,
            to: from,
            count,
        };
        let mut t = String::new();
        histogram(
            &mut t,
            &[
                bin(1.0, 0),
                bin(2.0, 4),
                bin(3.0, 0),
                bin(4.0, 1),
                bin(5.0, 0),
            ],
            "pixels",
            |b| format!("{:.0}", b.from),
        );
        assert_eq!(t.lines().count(), 3, "{t}");
        assert!(t.contains(&"#".repeat(40)), "{t}");
        let mut nothing = String::new();
        histogram(&mut nothing, &[], "pixels", |_| String::new());
        assert_eq!(nothing, "");
    }

    #[test]
    fn figures() {
        assert_eq!(figure(12.0), "12");
        assert_eq!(figure(0.25), "0.25000");
        assert_eq!(figure(1.5e-8), "1.500e-8");
    }
}
