//! Why something failed, for people: one line, whether a value of theirs was wrong, and which flag helps.

use peelnet_eval::EvalError;
use peelnet_files::{Refused, error_line};
use peelnet_gpu::GpuError;
use peelnet_peel::PeelError;
use peelnet_render::RenderError;
use std::{error::Error, fmt};

/// An error of any of the libraries, or of what is built on them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// The error and its sources in one line.
    pub text: String,
    /// Whether the cause is a wrong value that the caller gave: the command line then ends with exit code 2, and Python raises
    /// `ValueError`.
    pub is_wrong_value: bool,
    /// What to do about it, in terms of the command line's flags.
    pub hint: Option<String>,
    /// Whether the GPU was lost: it has to be opened anew.
    pub is_gpu_lost: bool,
}

impl Failure {
    /// Something that went wrong.
    pub fn failed(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            is_wrong_value: false,
            hint: None,
            is_gpu_lost: false,
        }
    }

    /// A wrong value.
    pub fn wrong(text: impl Into<String>) -> Self {
        Self {
            is_wrong_value: true,
            ..Self::failed(text)
        }
    }

    /// The same with the file or the flag that it is about.
    #[must_use]
    pub fn about(self, what: &str) -> Self {
        Self {
            text: format!("{what}: {}", self.text),
            ..self
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)?;
        self.hint.iter().try_for_each(|hint| write!(f, " ({hint})"))
    }
}

impl<E: Error + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        let mut failure = Self::failed(error_line(&error));
        let mut next: Option<&(dyn Error + 'static)> = Some(&error);
        while let Some(error) = next {
            let (is_wrong_value, hint) = advice(error);
            failure.is_wrong_value |= is_wrong_value;
            failure.hint = failure.hint.or(hint.map(str::to_owned));
            failure.is_gpu_lost |= matches!(find(error), Some(GpuError::Lost(_)));
            next = error.source();
        }
        failure
    }
}

/// An error of a type. Sources in a box are seen as the box.
fn find<'a, E: Error + 'static>(error: &'a (dyn Error + 'static)) -> Option<&'a E> {
    let boxed = || error.downcast_ref::<Box<E>>().map(|b| &**b);
    error.downcast_ref::<E>().or_else(boxed)
}

/// Whether an error says that a value is wrong, and which flag helps.
fn advice(error: &(dyn Error + 'static)) -> (bool, Option<&'static str>) {
    const RESUME: (bool, Option<&str>) = (false, Some("leave out --resume to start again"));
    if let Some(error) = find::<Refused>(error) {
        return (error.is_wrong_value, None);
    }
    if let Some(error) = find::<GpuError>(error) {
        return match error {
            GpuError::NoSuchAdapter { .. } => {
                let hint = "choose one with --adapter, or leave the flag out";
                (true, Some(hint))
            }
            GpuError::OutOfMemory { .. } | GpuError::Lost(_) => (false, Some("--adapter software")),
            GpuError::MissingFeature { what, .. } | GpuError::TooLarge { what, .. }
                if what.starts_with("dual depth peeling") =>
            {
                (false, Some("--peel sbuffer or --peel single"))
            }
            _ => (false, None),
        };
    }
    if let Some(error) = find::<RenderError>(error) {
        return match error {
            RenderError::WrongValue(_) => (true, None),
            RenderError::NeedsModel(_) => (false, Some("give its model file with --model")),
            _ => (false, None),
        };
    }
    if let Some(error) = find::<PeelError>(error) {
        return match error {
            PeelError::Setting { setting, .. } => {
                let hint = match *setting {
                    "views" => Some("set it with --views"),
                    "augment" => Some("lower --augment or --views"),
                    "pixels" => Some("set it with --pixels"),
                    "lists" => Some("set it with --synthetic"),
                    _ => None,
                };
                (true, hint)
            }
            _ => (false, None),
        };
    }
    match find(error) {
        Some(EvalError::Resume { .. }) => RESUME,
        Some(EvalError::SameName { .. }) => (true, None),
        _ => training(error, RESUME),
    }
}

#[cfg(feature = "train")]
fn training(
    error: &(dyn Error + 'static),
    resume: (bool, Option<&'static str>),
) -> (bool, Option<&'static str>) {
    use peelnet_train::TrainError;
    match find(error) {
        Some(TrainError::Checkpoint { .. }) => resume,
        Some(TrainError::CurveFormat(_)) => (true, None),
        Some(TrainError::Config { setting, .. }) => {
            let hint = match *setting {
                "epochs" => Some("set it with --epochs"),
                "batch" => Some("set it with --batch"),
                "hidden" => Some("set it with --hidden"),
                "max_rows" => Some("set it with --max-rows"),
                "buffer_rows" => Some("set it with --buffer-rows"),
                "learning_rate" => Some("set it with --lr"),
                "patience" => Some("set it with --patience"),
                "loss" => Some("set it with --loss"),
                _ => None,
            };
            (true, hint)
        }
        _ => (false, None),
    }
}

#[cfg(not(feature = "train"))]
fn training(
    _: &(dyn Error + 'static),
    _: (bool, Option<&'static str>),
) -> (bool, Option<&'static str>) {
    (false, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors deep inside others get their flag, wrong values are told from the rest, and nothing is said twice.
    #[test]
    fn errors_are_one_line_with_the_flag_that_helps() {
        let error = EvalError::At {
            place: "scene 'cups', method 'mboit4'".to_owned(),
            source: Box::new(RenderError::Gpu(GpuError::Lost("gone".to_owned()))),
        };
        let failure = Failure::from(error);
        assert!(!failure.is_wrong_value && failure.is_gpu_lost);
        let text = failure.to_string();
        assert!(
            text.starts_with("scene 'cups', method 'mboit4': "),
            "{text}"
        );
        assert_eq!(text.matches("gone").count(), 1, "{text}");
        assert!(text.ends_with(" (--adapter software)"), "{text}");
        let failure = Failure::from(PeelError::Setting {
            setting: "pixels",
            reason: "2 is not a fraction".to_owned(),
        });
        assert!(failure.is_wrong_value);
        assert!(failure.to_string().ends_with(" (set it with --pixels)"));
    }
}
