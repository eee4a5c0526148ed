//! STL files of text.

use super::{Fault, Soup};
use crate::{
    budget::Budget,
    scan::{Surface, fault_of},
    warnings::Warnings,
};
use glam::Vec3;
use peelnet_files::printable;

/// How far a text is searched for its first facet, bytes.
const SEARCHED: usize = 4096;

/// Whether a file is text: its first word is `solid`, as that of many binary files is, and a facet or the end follows it.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let start = bytes[..bytes.len().min(SEARCHED)].to_ascii_lowercase();
    let has = |word: &[u8]| start.windows(word.len()).any(|w| w == word);
    start.trim_ascii_start().starts_with(b"solid") && (has(b"facet") || has(b"endsolid"))
}

/// Words with their lines. Many programs begin a line for each statement; some do not.
struct Words<'a> {
    text: &'a str,
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a str> {
        let rest = self.text.trim_start();
        let skipped = &self.text[..self.text.len() - rest.len()];
        self.line += breaks(skipped);
        let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.text = rest;
        (!word.is_empty()).then_some(word)
    }

    /// Skips a name, which ends with its line.
    fn skip_line(&mut self) {
        let end = self.text.find(['\n', '\r']).unwrap_or(self.text.len());
        self.text = &self.text[end..];
    }

    fn fault(&self, message: String) -> Fault {
        Fault::at(self.line, message)
    }

    fn expect(&mut self, expected: &str) -> Result<(), Fault> {
        match self.next() {
            Some(word) if word.eq_ignore_ascii_case(expected) => Ok(()),
            Some(word) => Err(self.fault(format!(
                "'{}' stands where '{expected}' should; repair the line",
                printable(word)
            ))),
            None => Err(self.ended()),
        }
    }

    fn vector(&mut self) -> Result<Vec3, Fault> {
        let mut numbers = [0.0; 3];
        for number in &mut numbers {
            let word = self.next().ok_or_else(|| self.ended())?;
            *number = word.parse().map_err(|_| {
                self.fault(format!(
                    "'{}' is not a number; repair the line",
                    printable(word)
                ))
            })?;
        }
        Ok(numbers.into())
    }

    fn ended(&self) -> Fault {
        self.fault("ends inside of a facet; is the file cut off?".into())
    }
}

/// Line breaks of any system.
fn breaks(text: &str) -> usize {
    let bytes = text.as_bytes();
    let pairs = bytes.windows(2).filter(|w| w == b"\r\n").count();
    let all = bytes.iter().filter(|b| matches!(b, b'\n' | b'\r'));
    all.count() - pairs
}

/// Reads a file of text.
pub(super) fn read(
    bytes: &[u8],
    budget: &mut Budget,
    warnings: &mut Warnings,
) -> Result<Surface, Fault> {
    // Names may be of any encoding; all other words are ASCII.
    let text = String::from_utf8_lossy(bytes);
    let mut words = Words {
        text: &text,
        line: 1,
    };
    let mut soup = Soup::default();
    let mut is_open = false;
    while let Some(word) = words.next() {
        match word.to_ascii_lowercase().as_str() {
            "solid" => {
                words.skip_line();
                is_open = true;
            }
            "endsolid" => {
                words.skip_line();
                is_open = false;
            }
            "facet" => {
                budget.take_mesh(1, 0).map_err(Fault::new)?;
                soup.push(facet(&mut words)?);
            }
            _ => {
                return Err(words.fault(format!(
                    "'{}' stands where 'facet' or 'endsolid' should; repair the line",
                    printable(word)
                )));
            }
        }
    }
    let surface = soup.into_surface(budget, warnings)?;
    if is_open {
        warnings.add("has no 'endsolid' at its end: it may be cut off");
    }
    Ok(surface)
}

/// The vertices of a facet, behind its first word. Its normal is not used: many files have wrong ones.
fn facet(words: &mut Words<'_>) -> Result<[Vec3; 3], Fault> {
    words.expect("normal")?;
    words.vector()?;
    words.expect("outer")?;
    words.expect("loop")?;
    let mut triangle = [Vec3::ZERO; 3];
    for vertex in &mut triangle {
        words.expect("vertex")?;
        *vertex = words.vector()?;
        if let Some(what) = fault_of(*vertex) {
            return Err(words.fault(format!("a vertex {what}; repair the mesh")));
        }
    }
    words.expect("endloop")?;
    words.expect("endfacet")?;
    Ok(triangle)
}
