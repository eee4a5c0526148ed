//! Warnings, one for each kind of problem: twenty thousand materials with the same one are one line.

use crate::error::shown;
use peelnet_core::files::printable;
use std::{
    collections::{HashMap, HashSet},
    path::Path,
};

/// Names that a warning lists.
const LISTED: usize = 3;

/// Characters of an error or warning that are shown: more than the longest path of most systems.
const LONGEST: usize = 5000;

/// Warnings by the text around the names in which they differ.
#[derive(Default)]
pub(crate) struct Warnings(HashMap<[String; 2], Kind>);

#[derive(Default)]
struct Kind {
    /// Which kind it was, in the order in which they are met.
    number: usize,
    listed: Vec<String>,
    all: HashSet<String>,
}

impl Warnings {
    /// Adds a warning, once.
    pub fn add(&mut self, text: impl Into<String>) {
        self.about(text, "", "");
    }

    /// Adds a warning about a name, which stands between two texts.
    pub fn about(&mut self, before: impl Into<String>, name: &str, after: impl Into<String>) {
        let number = self.0.len();
        let kind = self.0.entry([before.into(), after.into()]);
        let kind = kind.or_insert_with(|| Kind {
            number,
            ..Kind::default()
        });
        if kind.all.insert(name.to_owned()) && kind.listed.len() < LISTED {
            kind.listed.push(name.to_owned());
        }
    }

    /// Adds a warning about something that a file has and that is not drawn.
    pub fn not_drawn(&mut self, path: &Path, name: &str) {
        self.about(
            format!("{}: not drawn: ", shown(path)),
            &printable(name),
            "",
        );
    }

    /// Adds a warning about something whose numbers were taken as the nearest in their range.
    pub fn clamped(&mut self, path: &Path, name: &str) {
        let text = "numbers outside of their range are taken as the nearest in it";
        self.about(format!("{}: {text}: ", shown(path)), &printable(name), "");
    }

    /// The warnings, each on one line and printable.
    pub fn texts(&self) -> Vec<String> {
        let mut kinds: Vec<_> = self.0.iter().collect();
        kinds.sort_by_key(|(_, kind)| kind.number);
        let text = |([before, after], kind): (&[String; 2], &Kind)| {
            let more = match kind.all.len() - kind.listed.len() {
                0 => String::new(),
                n => format!(" and {n} more"),
            };
            one_line(&format!("{before}{}{more}{after}", kind.listed.join(", ")))
        };
        kinds.into_iter().map(text).collect()
    }
}

/// Text with foreign names in it, fit for one line of a terminal.
pub(crate) fn one_line(text: &str) -> String {
    let end = text.char_indices().nth(LONGEST).map(|(end, _)| end);
    let shown = peelnet_core::files::one_line(&text[..end.unwrap_or(text.len())]);
    shown.into_owned() + if end.is_some() { "…" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_of_a_kind_are_one() {
        let mut warnings = Warnings::default();
        for i in 0..20_000 {
            warnings.about(
                "no material ",
                &format!("'m{}'", i % 10_000),
                "; grey is drawn",
            );
        }
        warnings.about("no material ", "'m'", "; nothing is drawn");
        warnings.add("bell\u{7}\nend");
        warnings.add("bell\u{7}\nend");
        assert_eq!(
            warnings.texts(),
            [
                "no material 'm0', 'm1', 'm2' and 9997 more; grey is drawn",
                "no material 'm'; nothing is drawn",
                r"bell\u{7}\u{a}end",
            ]
        );
        let long = one_line(&"é".repeat(1 << 20));
        assert_eq!(long.chars().count(), LONGEST + 1);
    }
}
