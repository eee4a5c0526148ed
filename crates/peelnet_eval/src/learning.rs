//! What accuracy costs in training: error against the number of parameters, of training examples, and of epochs.

use crate::{EvalError, Machine, lines, table, write_atomically, write_csv, write_json};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Varied {
    /// Hidden layers.
    Parameters,
    /// The share of the training examples that is used.
    Examples,
    /// Passes over them.
    Epochs,
}

/// One trained network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lesson {
    /// What varies.
    pub varied: Varied,
    /// Layers, such as `5-12-1`.
    pub topology: String,
    /// Weights and biases.
    pub parameters: u64,
    /// Examples that it was trained on.
    pub examples: u64,
    /// Passes over them.
    pub epochs: u32,
    /// Seconds of training.
    pub seconds: f64,
    /// Geometric mean of `mse_linear` over scenes and views.
    pub mse_linear: f64,
    /// The same over that of `mboit4`.
    pub to_moments: f64,
}

impl Lesson {
    fn value(&self) -> f64 {
        match self.varied {
            Varied::Parameters => self.parameters as f64,
            Varied::Examples => self.examples as f64,
            Varied::Epochs => f64::from(self.epochs),
        }
    }
}

/// A finished measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Learning {
    /// What it was measured on.
    pub machine: Machine,
    /// The command line.
    pub command: String,
    /// The recipe whose inputs and output form all networks have.
    pub recipe: String,
    /// Every network.
    pub rows: Vec<Lesson>,
}

impl Learning {
    /// Headings and cells.
    pub fn table(&self) -> (Vec<String>, Vec<Vec<String>>) {
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
        let cells = self
            .rows
            .iter()
            .map(|l| {
                vec![
                    format!("{:?}", l.varied).to_lowercase(),
                    l.topology.clone(),
                    l.parameters.to_string(),
                    l.examples.to_string(),
                    l.epochs.to_string(),
                    format!("{:.1}", l.seconds),
                    format!("{:.2e}", l.mse_linear),
                    format!("{:.3}", l.to_moments),
                ]
            })
            .collect();
        (headings.map(str::to_owned).to_vec(), cells)
    }

    /// Writes `training.json`, `training.csv`, `training.md`, and a chart of the error against what varies and against seconds:
    /// `training-parameters.svg`, `-examples.svg`, `-epochs.svg`, `-seconds.svg`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), EvalError> {
        write_json(&folder.join("training.json"), self)?;
        write_csv(&folder.join("training.csv"), &self.rows)?;
        let (headings, cells) = self.table();
        let text = format!(
            "{}\nNetworks with the inputs of `{}`, errors on the scenes of the command. {}\n",
            table::markdown(&headings, &cells),
            self.recipe,
            self.machine.credit(&self.command),
        );
        write_atomically(&folder.join("training.md"), text.as_bytes())?;
        let line = |varied: Varied, name: &str, x: &dyn Fn(&Lesson) -> f64| -> lines::Line {
            let rows = self.rows.iter().filter(|l| l.varied == varied);
            (
                name.to_owned(),
                rows.map(|l| (x(l), l.to_moments)).collect(),
            )
        };
        let all = [
            (Varied::Parameters, "parameters"),
            (Varied::Examples, "examples"),
            (Varied::Epochs, "epochs"),
        ];
        for (varied, name) in all {
            let svg = lines::chart(&[line(varied, "", &Lesson::value)], name, "MSE / mboit4's");
            write_atomically(&folder.join(format!("training-{name}.svg")), svg.as_bytes())?;
        }
        let seconds = all.map(|(varied, name)| line(varied, name, &|l| l.seconds));
        let svg = lines::chart(&seconds, "seconds of training", "MSE / mboit4's");
        write_atomically(&folder.join("training-seconds.svg"), svg.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;

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
        Learning {
            machine: crate::report::machine_of_tests(),
            command: "peelnet bench --training d".into(),
            recipe: "medium".into(),
            rows,
        }
        .write(dir.path())
        .unwrap();
        let text = std::fs::read_to_string(dir.path().join("training.md")).unwrap();
        assert!(
            text.contains("| parameters | 5-1 | 40 | 1000 | 3 | 0.5 | 1.00e-4 | 0.100 |"),
            "{text}"
        );
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 7);
    }
}
