//! The files of `peelnet bench --training`: error against parameters, examples, epochs and seconds.

use crate::{
    ReportError, Results, Table,
    files::{write_csv, write_file},
};
use peelnet_chart::{Line, LineChart, Scale, Svg};
use peelnet_eval::learning::{Learning, Lesson, Varied};
use std::path::Path;

impl Results<Learning> {
    /// The files that [`Self::write`] writes.
    pub const FILES: &[&str] = &[
        "training.json",
        "training.csv",
        "training.md",
        "training-parameters.svg",
        "training-examples.svg",
        "training-epochs.svg",
        "training-seconds.svg",
    ];

    /// A row for each network.
    pub fn table(&self) -> Table {
        let headings = [
            "varied",
            "network",
            "parameters",
            "examples",
            "epochs",
            "seconds",
            "MSE (linear)",
            "/ mboit4",
        ];
        let line = |l: &Lesson| {
            vec![
                l.varied.to_string(),
                l.topology.clone(),
                l.parameters.to_string(),
                l.examples.to_string(),
                l.epochs.to_string(),
                format!("{:.1}", l.seconds),
                format!("{:.2e}", l.mse_linear),
                format!("{:.3}", l.to_moments),
            ]
        };
        Table::new(headings, self.measured.rows.iter().map(line))
    }

    /// Writes `training.json`, `training.csv`, `training.md`, and charts of the error against what varies and against seconds:
    /// `training-parameters.svg`, `-examples.svg`, `-epochs.svg`, `-seconds.svg`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), ReportError> {
        self.write_json(&folder.join("training.json"))?;
        write_csv(&folder.join("training.csv"), &self.measured.rows)?;
        let text = format!(
            "{}\nNetworks with the inputs of `{}`, errors on the scenes of the command. {}\n",
            self.table().markdown(),
            self.measured.recipe,
            self.credit(),
        );
        write_file(&folder.join("training.md"), text)?;
        let save = |name: &str, svg: Svg| {
            write_file(&folder.join(format!("training-{name}.svg")), svg.on_white())
        };
        for varied in Varied::ALL {
            let name = varied.to_string();
            save(&name, chart(&[self.line(varied, "", Lesson::value)], &name))?;
        }
        let seconds = Varied::ALL.map(|v| self.line(v, &v.to_string(), |l| l.seconds));
        save("seconds", chart(&seconds, "seconds of training"))
    }

    /// The error of the networks in which one thing varies.
    fn line(&self, varied: Varied, name: &str, x: fn(&Lesson) -> f64) -> Line {
        let rows = self.measured.rows.iter().filter(|l| l.varied == varied);
        Line::new(name, rows.map(|l| (x(l), l.to_moments)))
    }
}

fn chart(lines: &[Line], x: &str) -> Svg {
    LineChart {
        lines,
        x,
        y: "MSE / mboit4's",
        x_scale: Scale::Logarithmic,
    }
    .svg()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::testing::machine;

    #[test]
    fn files_are_written() {
        let dir = tempfile::tempdir().unwrap();
        let rows = [10, 20, 40]
            .map(|parameters| Lesson {
                varied: Varied::Parameters,
                topology: "5-1".to_owned(),
                parameters,
                examples: 1000,
                epochs: 3,
                seconds: 0.5,
                mse_linear: 1e-4,
                to_moments: 4.0 / parameters as f64,
            })
            .to_vec();
        let learning = Learning {
            recipe: "medium".into(),
            rows,
        };
        let results = Results::new(machine(), "peelnet bench --training d", learning);
        results.write(dir.path()).unwrap();
        let text = std::fs::read_to_string(dir.path().join("training.md")).unwrap();
        assert!(
            text.contains("| parameters | 5-1 | 40 | 1000 | 3 | 0.5 | 1.00e-4 | 0.100 |"),
            "{text}"
        );
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 7);
        let json = dir.path().join("training.json");
        assert_eq!(Results::<Learning>::read(&json).unwrap(), results);
        crate::testing::assert_files(dir.path(), Results::<Learning>::FILES);
    }
}
