//! How a command fails: one line and an exit code.

mod flags;

/// An error and its sources in one line.
pub use peelnet_files::error_line as one_line;
use std::error::Error;
use std::fmt;

/// Why a command ended early.
#[derive(Debug, PartialEq, Eq)]
pub enum Failure {
    /// The command line is wrong. Exit code 2.
    Usage(String),
    /// Something went wrong. Exit code 1.
    Failed(String),
    /// A signal, whose number the exit code has.
    Interrupted,
}

impl Failure {
    /// 2 for wrong usage, 1 for the rest.
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Failed(_) | Self::Interrupted => 1,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(text) | Self::Failed(text) => f.write_str(text),
            Self::Interrupted => f.write_str(crate::interrupt::MESSAGE),
        }
    }
}

/// Libraries speak of values; which flag sets them is added here.
impl<E: Error + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        let mut text = one_line(&error);
        if let Some(hint) = flags::hint(&error) {
            text.push_str(&format!(" ({hint})"));
        }
        if peelnet::cause::is_wrong_value(&error) {
            Self::Usage(text)
        } else {
            Self::Failed(text)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, thiserror::Error)]
    #[error("{text}")]
    struct Link {
        text: &'static str,
        source: Option<Box<Link>>,
    }

    #[test]
    fn the_chain_is_folded_and_nothing_is_said_twice() {
        let error = Link {
            text: "scene.toml: cannot read",
            source: Some(Box::new(Link {
                text: "line 3:\n  unknown key",
                source: None,
            })),
        };
        assert_eq!(
            one_line(&error),
            "scene.toml: cannot read: line 3: unknown key"
        );
        let error = Link {
            text: "a: gone",
            source: Some(Box::new(Link {
                text: "gone",
                source: None,
            })),
        };
        assert_eq!(Failure::from(error), Failure::Failed("a: gone".to_owned()));
    }

    /// Errors deep inside others get their flag, wrong values the exit code of wrong usage.
    #[test]
    fn flags_are_added() {
        let gpu = peelnet_gpu::GpuError::Lost("gone".to_owned());
        let render = peelnet_render::RenderError::Gpu(gpu);
        let error = peelnet_eval::EvalError::Render {
            scene: "cups".to_owned(),
            method: "mboit4".to_owned(),
            source: Box::new(render),
        };
        let failure = Failure::from(error);
        assert_eq!(failure.exit_code(), 1);
        let text = failure.to_string();
        assert!(
            text.starts_with("scene 'cups', method 'mboit4': "),
            "{text}"
        );
        assert!(text.ends_with(" (--adapter software)"), "{text}");
        let failure = Failure::from(peelnet_peel::PeelError::Fraction(2.0));
        assert_eq!(failure.exit_code(), 2);
        assert!(failure.to_string().ends_with(" (set it with --pixels)"));
    }
}
