//! The loss curve as a table and as a picture.

use crate::Failure;
use peelnet_bench::chart::{Line, Scale, Svg, line_chart};
use peelnet_core::files::{Kind, holds, shown, write_whole};
use peelnet_train::{EpochReport, HISTORY_KIND, history_csv};
use std::path::Path;

/// The name of the picture's vertical axis.
const LOSS: &str = "mean loss";

/// By what a loss curve is known, whose ending chooses its form: .csv a table, .svg a picture of both losses over the epochs.
///
/// # Errors
/// Any other ending.
pub fn curve_kind(path: &Path) -> Result<Kind, Failure> {
    form(path).map(|(kind, _)| kind)
}

/// What a curve is known by, and its text.
type Form = (Kind, fn(&[EpochReport]) -> String);

fn form(path: &Path) -> Result<Form, Failure> {
    let svg_kind = Kind {
        name: "a loss curve (SVG)",
        // Other charts stay.
        is: |head| Svg::is_ours(head) && holds(head, LOSS.as_bytes()),
    };
    match path.extension().and_then(|e| e.to_str()) {
        Some(e) if e.eq_ignore_ascii_case("csv") => Ok((HISTORY_KIND, history_csv)),
        Some(e) if e.eq_ignore_ascii_case("svg") => Ok((svg_kind, |h| curve_chart(h).on_white())),
        _ => Err(Failure::wrong(format!(
            "{}: a loss curve ends in .csv or .svg",
            shown(path)
        ))),
    }
}

/// Writes the history in the form that the ending asks for.
///
/// # Errors
/// An unknown ending, or the file cannot be written.
pub fn write_curve(path: &Path, history: &[EpochReport]) -> Result<(), Failure> {
    let text = form(path)?.1(history);
    write_whole(path, text.as_bytes()).map_err(|e| Failure::failed(format!("{}: {e}", shown(path))))
}

/// Both losses over the epochs, on a logarithmic axis.
pub fn curve_chart(history: &[EpochReport]) -> Svg {
    let rows = history.iter();
    let losses = rows.flat_map(|row| [Some(row.train_loss), row.held_out_loss]);
    let positive = losses.flatten().filter(|loss| *loss > 0.0);
    // A logarithmic axis has no zero: a loss of zero is drawn below all others.
    let floor = positive.reduce(f64::min).map_or(1e-9, |low| low / 1.2);
    let line = |name: &str, loss: fn(&EpochReport) -> Option<f64>| {
        let points = history.iter();
        let points = points.filter_map(|r| Some((r.epoch.into(), loss(r)?.max(floor))));
        Line::new(name, points)
    };
    let lines = [
        line("training", |r| Some(r.train_loss)),
        line("held out", |r| r.held_out_loss),
    ];
    line_chart(&lines, "epoch", LOSS, Scale::Linear)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(epoch: u32, train_loss: f64, held_out_loss: Option<f64>) -> EpochReport {
        EpochReport {
            epoch,
            epochs: 3,
            train_loss,
            held_out_loss,
            seconds: 0.5,
            rows_per_s: 1234.5,
            best: false,
        }
    }

    /// The table has a line for each epoch; the picture survives no epoch, one epoch and zero loss.
    #[test]
    fn curves_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let written = |name: &str, history: &[EpochReport]| {
            let path = folder.path().join(name);
            write_curve(&path, history).unwrap();
            std::fs::read_to_string(path).unwrap()
        };
        let rows = [row(1, 0.25, Some(0.5)), row(2, 0.125, None)];
        assert_eq!(
            written("new/curve.csv", &rows),
            "epoch,train_loss,held_out_loss,seconds,rows_per_s\n1,0.25,0.5,0.5000,1234\n2,0.125,,0.5000,1234\n"
        );
        for (name, history) in [
            ("none.svg", vec![]),
            ("one.SVG", vec![row(1, 0.1, Some(0.1))]),
            ("zero.svg", vec![row(1, 0.0, None), row(2, 0.0, None)]),
        ] {
            let text = written(name, &history);
            assert!(text.ends_with("</svg>\n"));
            let is_a_curve = curve_kind(Path::new("c.svg")).unwrap().is;
            assert!(is_a_curve(text.as_bytes()));
            assert!(!is_a_curve(text.replace(LOSS, "time").as_bytes()));
        }
    }
}
