//! Text from strangers: names in files, paths, arguments.

use std::{borrow::Cow, error::Error, path::Path};

/// Characters of a foreign name that are shown.
pub const MAX_SHOWN: usize = 200;

/// Refuses a name that is longer than what is shown of it.
///
/// # Errors
/// How long it is, and how long it may be.
pub fn check_name(name: &str) -> Result<(), String> {
    match name.chars().count() {
        0..=MAX_SHOWN => Ok(()),
        n => Err(format!("has {n} characters; give it at most {MAX_SHOWN}")),
    }
}

/// A name from a file or from the command line, fit for one line of a terminal, a shader's comment or a page's source:
/// what could move the cursor, end a line or hide text is escaped as `\u{…}`, and what follows the first
/// [`MAX_SHOWN`] characters is left out with an ellipsis.
pub fn printable(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(MAX_SHOWN) {
        None => one_line(text),
        Some((end, _)) => Cow::Owned(one_line(&text[..end]).into_owned() + "…"),
    }
}

/// Text of any length for one line: what [`printable`] escapes is escaped, nothing is left out. For paths, and for cells of a table.
pub fn one_line(text: &str) -> Cow<'_, str> {
    escaped(text, |c| !is_hidden(c), |c| c.escape_unicode().to_string())
}

/// An error and its sources in one line. A source whose text its parent already contains is left out.
pub fn error_line(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut next = error.source();
    while let Some(source) = next {
        let more = source.to_string();
        if !text.contains(&more) {
            text.push_str(": ");
            text.push_str(&more);
        }
        next = source.source();
    }
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join(" ")
}

/// A path for a message: one line, whatever it holds.
pub fn shown(path: &Path) -> String {
    one_line(&path.to_string_lossy()).into_owned()
}

/// A count with commas between the thousands, and its noun: `1 view`, `1,024 views`.
pub fn counted(count: u64, noun: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{} {noun}{ending}", thousands(count))
}

/// A whole number with commas between the thousands.
pub fn thousands(count: u64) -> String {
    match count / 1000 {
        0 => count.to_string(),
        more => format!("{},{:03}", thousands(more), count % 1000),
    }
}

/// Text of several lines with all that [`printable`] escapes escaped, but line ends: for whole messages, whose length is theirs to choose.
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    escaped(text, is_shown_in_lines, |c| c.escape_unicode().to_string())
}

/// JSON with every such character escaped as JSON does: outside strings it holds none but line ends.
pub fn printable_json(text: &str) -> Cow<'_, str> {
    escaped(text, is_shown_in_lines, |c| {
        let units = c.encode_utf16(&mut [0; 2]).to_vec().into_iter();
        units.map(|unit| format!("\\u{unit:04x}")).collect()
    })
}

fn is_shown_in_lines(c: char) -> bool {
    c == '\n' || !is_hidden(c)
}

/// A text in which all but some characters are replaced.
fn escaped(
    text: &str,
    is_kept: impl Fn(char) -> bool,
    escape: impl Fn(char) -> String,
) -> Cow<'_, str> {
    if text.chars().all(&is_kept) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| if is_kept(c) { c.into() } else { escape(c) };
    Cow::Owned(text.chars().map(shown).collect())
}

/// Whether a character does something else than show itself: controls, separators of lines, marks of direction, and what has no width.
fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// Names as near to one that is not known as a slip of the hand: those that begin with it, or are spelt nearly so; the nearest first.
fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    /// Of Jaro and Winkler's similarity, 0 … 1: `wbiot` has 0.82 of `wboit-eq9`, `smoke` 0.5 of `cups`.
    const LEAST: f64 = 0.8;
    const MOST: usize = 5;
    let name = name.to_lowercase().replace('_', "-");
    let similarity = |other: &str| strsim::jaro_winkler(&name, other);
    let scored = known.into_iter().map(|other| (similarity(other), other));
    let mut near: Vec<_> = scored.filter(|(score, _)| *score >= LEAST).collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0));
    near.into_iter()
        .map(|(_, other)| other)
        .take(MOST)
        .collect()
}

/// What stands instead of a name that is not known: the nearest ones, or all.
pub fn known_names(name: &str, known: &[&str]) -> String {
    match nearest(name, known.iter().copied()) {
        none if none.is_empty() => format!("there are: {}", known.join(", ")),
        near => format!("did you mean {}?", near.join(", ")),
    }
}

/// Lower-case hexadecimal digits, as hashes are written.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_shows_itself_is_untouched() {
        let long = "é".repeat(MAX_SHOWN);
        for text in ["", "Vase Nº 4 – été 𝛼", "\"quoted\" <b> \\n", &long] {
            assert!(matches!(printable(text), Cow::Borrowed(t) if t == text));
        }
    }

    #[test]
    fn what_acts_is_escaped() {
        assert_eq!(
            printable("a\u{1b}[2J\nfn x() {}\r\u{9b}1m\u{202e}b\u{feff}"),
            r"a\u{1b}[2J\u{a}fn x() {}\u{d}\u{9b}1m\u{202e}b\u{feff}"
        );
        assert_eq!(one_line("a\nb\u{2028}"), r"a\u{a}b\u{2028}");
        assert_eq!(printable_lines("a\tb\nc\u{7f}"), "a\\u{9}b\nc\\u{7f}");
    }

    #[test]
    fn one_is_singular() {
        let found = [0, 1, 999, 1_544_000].map(|n| counted(n, "view"));
        let texts = ["0 views", "1 view", "999 views", "1,544,000 views"];
        assert_eq!(found, texts);
    }

    #[test]
    fn length_is_bounded() {
        let long = "é".repeat(MAX_SHOWN + 1);
        assert_eq!(printable(&long).chars().count(), MAX_SHOWN + 1);
        assert!(printable(&long).ends_with('…'));
        let worst = "\u{e0001}".repeat(1_000_000);
        assert!(printable(&worst).len() <= MAX_SHOWN * "\\u{e0001}".len() + '…'.len_utf8());
    }

    #[test]
    fn json_stays_the_same_value() {
        let escaped = printable_json("{\n  \"a\": \"\u{9b}\u{202e}\u{e0001}é\"\n}");
        assert_eq!(escaped, "{\n  \"a\": \"\\u009b\\u202e\\udb40\\udc01é\"\n}");
    }
}
