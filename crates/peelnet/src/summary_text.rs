use peelnet_core::files::{Kind, printable, thousands};
use peelnet_dataset::Summary;
use peelnet_dataset::summary::Bin;

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

pub fn summary_text(summary: &Summary) -> String {
    let mut t = format!(
        "rows        {}\n\
         pixels      {}\n\
         hash        {}\n\
         left out    {} fragments\n\
         coplanar    {} pairs of neighbouring fragments at one depth\n\
         \nscenes\n",
        thousands(summary.rows),
        thousands(summary.pixels),
        summary.hash,
        thousands(summary.lost_fragments),
        thousands(summary.coplanar_ties)
    );
    for scene in &summary.scenes {
        let held_out = if scene.held_out { "  (held out)" } else { "" };
        let (name, rows) = (printable(&scene.name), thousands(scene.rows));
        t += &format!("  {name:<28} {rows:>14} rows{held_out}\n");
    }
    if !summary.columns.is_empty() {
        t += "\ncolumns                     smallest        largest\n";
    }
    for column in &summary.columns {
        let (min, max) = (figure(column.min), figure(column.max));
        t += &format!("  {:<18} {min:>15} {max:>14}\n", column.name);
    }
    t += "\nfragments per pixel\n";
    t += &histogram(&summary.fragments_per_pixel, "pixels", |bin| {
        if bin.from < bin.to {
            format!("{:.0}–{:.0}", bin.from, bin.to)
        } else {
            format!("{:.0}", bin.from)
        }
    });
    t += "\nalpha\n";
    t += &histogram(&summary.alpha, "rows", |bin| {
        format!("{:.2}–{:.2}", bin.from, bin.to)
    });
    t += "\nchecks\n";
    for check in &summary.checks {
        let verdict = match check.violations {
            0 => "holds".to_owned(),
            n => format!("VIOLATED by {} rows", thousands(n)),
        };
        let (name, formula, worst) = (&check.name, &check.formula, figure(check.worst));
        let ratio = check.worst_ratio;
        t += &format!(
            "  {name:<16} {verdict}: {formula} (worst {worst}, {ratio:.2} of the tolerance)\n"
        );
    }
    if summary.parts_not_checked > 0 {
        t += &format!(
            "  {} parts were not checked, because peeling left fragments out of them\n",
            summary.parts_not_checked
        );
    }
    for v in &summary.violations {
        t += &format!(
            "  {} row {}: {} is {}, recomputed {} (tolerance {:.1e})\n",
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

fn histogram(bins: &[Bin], unit: &str, label: impl Fn(&Bin) -> String) -> String {
    let most = bins.iter().map(|b| b.count).max().unwrap_or(0).max(1) as f64;
    // Empty bins at both ends are left out.
    let first = bins.iter().position(|b| b.count > 0).unwrap_or(0);
    let last = bins.iter().rposition(|b| b.count > 0).map_or(0, |k| k + 1);
    let lines = bins[first..last.max(first)].iter().map(|bin| {
        let bar = "#".repeat((bin.count as f64 / most * BAR).ceil() as usize);
        let (label, count) = (label(bin), thousands(bin.count));
        let line = format!("  {label:>12} {count:>14} {unit}  {bar}");
        line.trim_end().to_owned() + "\n"
    });
    lines.collect()
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
            let text = histogram(&bins, "pixels", |b| figure(b.from));
            assert_eq!(text.lines().count(), lines, "{text}");
            assert_eq!(text.contains(&"#".repeat(40)), lines > 0, "{text}");
        }
    }
}
