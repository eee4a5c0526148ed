//! The page of `peelnet stress`: what holds, what is known not to, and what fails.

use super::page::{STYLE, escape, html_table};
use crate::stress::{CASES, Stressed};
use std::fmt::Write as _;

const EXTRA_STYLE: &str = "
table.matrix { font-size: 0.75rem; } table.matrix th { writing-mode: vertical-rl; transform: rotate(180deg); padding: 0.4rem 0.1rem; }
table.matrix td { padding: 0.1rem 0.35rem; text-align: center; }
table.matrix td:first-child { white-space: nowrap; text-align: left; } table.text th { text-align: left; }
tr.front td:first-child { font-weight: bold; color: #d55e00; }
";

/// The whole page.
pub(crate) fn page(stressed: &Stressed) -> String {
    let mut h = String::new();
    h.push_str("<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n");
    h.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    let _ = write!(
        h,
        "<title>peelnet stress: hard cases</title>\n<style>{STYLE}{EXTRA_STYLE}</style>\n<h1>Hard cases</h1>\n<p>{}.</p>\n",
        escape(&stressed.summary())
    );
    h.push_str(
        "<p class=\"note\">· all properties of the case hold; d a number of declared flaws; F of failures. A method with a failure is marked.</p>\n",
    );
    let (headings, cells) = stressed.matrix();
    let fails = |k: usize| cells[k].iter().any(|c| c.starts_with('F'));
    html_table(&mut h, "matrix", &headings, &cells, &fails);
    for (title, (headings, cells)) in [
        ("Failures", stressed.failures()),
        ("Declared flaws", stressed.flaws()),
    ] {
        if !cells.is_empty() {
            let _ = writeln!(h, "<h2>{title}</h2>");
            html_table(&mut h, "text", &headings, &cells, &|_| false);
        }
    }
    h.push_str("<h2>The cases</h2>\n");
    let cases: Vec<Vec<String>> = CASES
        .iter()
        .map(|c| [c.id, c.what, c.breaks].map(str::to_owned).to_vec())
        .collect();
    let headings = ["case", "what", "known to break"].map(str::to_owned);
    html_table(&mut h, "text", &headings, &cases, &|_| false);
    h.push_str("<h2>What was run, and on what</h2>\n");
    let _ = writeln!(h, "<p><code>{}</code></p>", escape(&stressed.command));
    let lines = stressed.machine.lines().into_iter();
    let lines: Vec<Vec<String>> = lines.map(|(k, v)| vec![k.to_owned(), v]).collect();
    let headings = ["property", "value"].map(str::to_owned);
    html_table(&mut h, "text", &headings, &lines, &|_| false);
    h.push_str("</html>\n");
    h
}
