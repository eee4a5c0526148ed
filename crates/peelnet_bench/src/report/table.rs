//! Tables as Markdown, as plain text and as HTML.

use maud::{Markup, html};
use peelnet_core::files::one_line;
use std::borrow::Cow;

/// A heading, and the cell of a row.
pub(crate) type Column<'c, R> = (&'c str, &'c dyn Fn(&R) -> String);

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    pub headings: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    pub fn new<H: Into<String>>(
        headings: impl IntoIterator<Item = H>,
        rows: impl IntoIterator<Item = Vec<String>>,
    ) -> Self {
        Self {
            headings: headings.into_iter().map(Into::into).collect(),
            rows: rows.into_iter().collect(),
        }
    }

    pub(crate) fn from_rows<'r, R: 'r>(
        rows: impl IntoIterator<Item = &'r R>,
        columns: &[Column<'_, R>],
    ) -> Self {
        let line = |row: &R| columns.iter().map(|(_, cell)| cell(row)).collect();
        let headings = columns.iter().map(|(heading, _)| *heading);
        Self::new(headings, rows.into_iter().map(line))
    }

    /// A line for each name; a cell gets its line's name and its column's number.
    pub(crate) fn matrix(
        corner: &str,
        columns: impl IntoIterator<Item = String>,
        names: &[&str],
        cell: impl Fn(&str, usize) -> String,
    ) -> Self {
        let mut headings = vec![corner.to_owned()];
        headings.extend(columns);
        let line = |name: &&str| {
            let cells = (0..headings.len() - 1).map(|k| cell(name, k));
            std::iter::once((*name).to_owned()).chain(cells).collect()
        };
        Self {
            rows: names.iter().map(line).collect(),
            headings,
        }
    }

    /// As Markdown: the first column to the left, the others to the right.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|c| markdown(c)).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let right = "---:|".repeat(self.headings.len().saturating_sub(1));
        let rows: String = self.rows.iter().map(|r| line(r)).collect();
        format!("{}|---|{right}\n{rows}", line(&self.headings))
    }

    /// As plain text with aligned columns, for a terminal.
    pub fn plain(&self) -> String {
        let lines = std::iter::once(&self.headings).chain(&self.rows);
        let escaped = lines.map(|line| line.iter().map(|cell| one_line(cell)).collect());
        let lines: Vec<Vec<Cow<'_, str>>> = escaped.collect();
        let width = |k: usize| {
            let cells = lines.iter().filter_map(|line| line.get(k));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.headings.len()).map(width).collect();
        let mut text = String::new();
        for line in &lines {
            let start = text.len();
            for (k, (cell, w)) in line.iter().zip(&widths).enumerate() {
                // A width of the format language ends at 65,535.
                let space = " ".repeat(w - cell.chars().count());
                let parts = match k {
                    0 => [cell, space.as_str()],
                    _ => [space.as_str(), cell],
                };
                text.push_str(if k > 0 { "  " } else { "" });
                text.extend(parts);
            }
            text.truncate(start + text[start..].trim_end().len());
            text.push('\n');
        }
        text
    }

    /// As HTML; rows for which `marked` holds have the class `front`.
    pub(crate) fn html(&self, class: &str, marked: impl Fn(usize) -> bool) -> Markup {
        html! {
            div.scroll {
                table class=[(!class.is_empty()).then_some(class)] {
                    thead { tr { @for heading in &self.headings { th { (heading) } } } }
                    tbody {
                        @for (k, row) in self.rows.iter().enumerate() {
                            tr class=[marked(k).then_some("front")] { @for cell in row { td { (cell) } } }
                            "\n"
                        }
                    }
                }
            }
        }
    }
}

/// Text as one line of Markdown, in which it starts no cell and no element.
pub(crate) fn markdown(text: &str) -> String {
    let cell = one_line(text).replace('|', "\\|");
    cell.replace('<', "&lt;").replace('[', "&#91;")
}

/// A scene's name in a table, marked where a learned method was trained on it.
pub(crate) fn scene_heading(scene: &str, trained_on: &[String]) -> String {
    marked(scene, trained_on, " (trained on)")
}

/// The same with another mark.
pub(crate) fn marked(scene: &str, trained_on: &[String], mark: &str) -> String {
    let is_trained_on = trained_on.iter().any(|name| name == scene);
    format!("{scene}{}", if is_trained_on { mark } else { "" })
}

/// A number with some digits, or a dash; `∞` where there is no end.
pub(crate) fn number(value: Option<f64>, digits: usize) -> String {
    match value {
        None => "–".to_owned(),
        Some(v) if v.is_infinite() => "∞".to_owned(),
        Some(v) => format!("{v:.digits$}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Markdown has one bar more than columns; plain text is aligned.
    #[test]
    fn tables_are_markdown_and_plain_text() {
        let table = Table::new(["name", "ms"], [vec!["<a|b>".to_owned(), "1".to_owned()]]);
        let markdown = "| name | ms |\n|---|---:|\n| &lt;a\\|b> | 1 |\n";
        assert_eq!(table.markdown(), markdown);
        assert_eq!(table.plain(), "name   ms\n<a|b>   1\n");
    }

    /// Neither a link nor a picture, also behind a backslash.
    #[test]
    fn a_cell_is_no_element_of_markdown() {
        for (text, escaped) in [("![a](b)", "!&#91;a](b)"), (r"\[a\](b)", r"\&#91;a\](b)")] {
            assert_eq!(markdown(text), escaped);
        }
    }

    #[test]
    fn a_cell_may_be_wider_than_a_width_of_the_format_language() {
        let table = Table::new(["a", "b"], [vec!["x".repeat(70_000), "1".to_owned()]]);
        let plain = table.plain();
        assert!(
            plain.lines().all(|line| line.chars().count() == 70_003),
            "{}",
            plain.len()
        );
    }

    /// A cell cannot end its row, nor move a terminal's cursor.
    #[test]
    fn cells_stay_cells() {
        let table = Table::new(["a\nb"], [vec!["\u{1b}[2J\r\n".to_owned()]]);
        for (text, bracket) in [(table.plain(), "["), (table.markdown(), "&#91;")] {
            assert!(text.contains(r"a\u{a}b"), "{text}");
            let cell = format!(r"\u{{1b}}{bracket}2J\u{{d}}\u{{a}}");
            assert!(text.contains(&cell), "{text}");
        }
        assert_eq!(table.plain().lines().count(), 2);
    }
}
