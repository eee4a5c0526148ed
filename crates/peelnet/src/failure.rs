//! Why something failed, for people: one line, whether a value of theirs was wrong, and which flag helps.

use peelnet_bench::EvalError;
use peelnet_core::files::{Refused, error_line};
use peelnet_peel::PeelError;
use peelnet_render::RenderError;
use peelnet_render::gpu::GpuError;
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
            failure.hint = failure.hint.or(hint);
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
fn advice(error: &(dyn Error + 'static)) -> (bool, Option<String>) {
    #[cfg(feature = "train")]
    if let Some(error) = find(error) {
        return training_advice(error);
    }
    let (is_wrong_value, hint) = if let Some(error) = find::<Refused>(error) {
        (error.is_wrong_value, "")
    } else if let Some(error) = find(error) {
        let is_dual = |what: &str| what.starts_with("dual depth peeling");
        match error {
            GpuError::NoSuchAdapter { .. } => {
                (true, "choose one with --adapter, or leave the flag out")
            }
            GpuError::OutOfMemory { .. } | GpuError::Lost(_) => (false, "--adapter software"),
            GpuError::MissingFeature { what, .. } | GpuError::TooLarge { what, .. }
                if is_dual(what) =>
            {
                (false, "--peel sbuffer or --peel single")
            }
            _ => (false, ""),
        }
    } else if let Some(error) = find(error) {
        match error {
            RenderError::WrongValue(_) => (true, ""),
            RenderError::NeedsModel(_) => (false, "give its model file with --model"),
            _ => (false, ""),
        }
    } else if let Some(error) = find(error) {
        match error {
            PeelError::Setting { setting, .. } => {
                let hint = match *setting {
                    "views" => "set it with --views",
                    "augment" => "lower --augment or --views",
                    "pixels" => "set it with --pixels",
                    "max_passes" => "leave --max-passes out, or add --peel dual or --peel single",
                    "lists" => "set it with --synthetic",
                    _ => "",
                };
                (true, hint)
            }
            _ => (false, ""),
        }
    } else {
        match find(error) {
            Some(EvalError::Resume { .. }) => (false, RESUME),
            Some(EvalError::SameName { .. } | EvalError::SameMethod(_)) => (true, ""),
            _ => (false, ""),
        }
    };
    let hint = Some(hint).filter(|hint| !hint.is_empty());
    (is_wrong_value, hint.map(str::to_owned))
}

const RESUME: &str = "leave out --resume to start again";

/// The same of training, whose settings are called as their flags.
#[cfg(feature = "train")]
fn training_advice(error: &peelnet_train::TrainError) -> (bool, Option<String>) {
    use peelnet_train::TrainError;
    match error {
        TrainError::Checkpoint { .. } => (false, Some(RESUME.to_owned())),
        TrainError::Config { setting, .. } => {
            let flag = match *setting {
                "learning_rate" => "lr".to_owned(),
                setting => setting.replace('_', "-"),
            };
            let flags = "epochs batch hidden max-rows buffer-rows lr patience loss";
            let has_flag = flags.split(' ').any(|known| known == flag);
            (true, has_flag.then(|| format!("set it with --{flag}")))
        }
        _ => (false, None),
    }
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
        let place = "scene 'cups', method 'mboit4': ";
        assert!(text.starts_with(place), "{text}");
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
