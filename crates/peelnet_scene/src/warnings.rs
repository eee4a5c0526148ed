//! Warnings, one for each kind of problem: twenty thousand materials with the same one are one line.

use peelnet_files::printable_lines;
use std::collections::{HashMap, HashSet};

/// Names that a warning lists.
const LISTED: usize = 3;

/// Characters of an error or warning that are shown: more than the longest path of most systems.
const LONGEST: usize = 5000;

/// Warnings in the order in which their kinds are met first.
#[derive(Default)]
pub(crate) struct Warnings {
    kinds: Vec<Kind>,
    /// Numbers of the kinds by the text around their names.
    numbers: HashMap<[String; 2], usize>,
}

/// Warnings that differ in a name alone.
struct Kind {
    text: [String; 2],
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
        let text = [before.into(), after.into()];
        let number = *self.numbers.entry(text).or_insert_with_key(|text| {
            self.kinds.push(Kind {
                text: text.clone(),
                listed: Vec::new(),
                all: HashSet::new(),
            });
            self.kinds.len() - 1
        });
        let kind = &mut self.kinds[number];
        if !kind.all.insert(name.to_owned()) {
            return;
        }
        if kind.listed.len() < LISTED {
            kind.listed.push(name.to_owned());
        }
    }

    /// The warnings, each on one line and printable.
    pub fn texts(&self) -> Vec<String> {
        let text = |kind: &Kind| {
            let [before, after] = &kind.text;
            let more = match kind.all.len() - kind.listed.len() {
                0 => String::new(),
                n => format!(" and {n} more"),
            };
            one_line(&format!("{before}{}{more}{after}", kind.listed.join(", ")))
        };
        self.kinds.iter().map(text).collect()
    }
}

/// Text with foreign names in it, fit for one line of a terminal.
pub(crate) fn one_line(text: &str) -> String {
    let end = text.char_indices().nth(LONGEST).map(|(end, _)| end);
    let shown = printable_lines(&text[..end.unwrap_or(text.len())]).replace('\n', "\\u{a}");
    if end.is_some() { shown + "…" } else { shown }
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
