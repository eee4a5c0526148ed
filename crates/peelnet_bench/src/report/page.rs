//! What all pages share: their frame, their style, and what was run on which machine.

use crate::Machine;
use crate::chart::{Svg, bar_chart};
use crate::report::{Results, Table};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use peelnet_core::files::{printable_lines, thousands};
use peelnet_dataset::summary::Bin;

pub(crate) const GENERATOR_TAG: &str = "<meta name=\"generator\" content=\"peelnet\">";

const STYLE: &str = include_str!("page.css");

/// Clicking a heading sorts its table: by number where both cells begin with one.
pub(crate) const SORT_SCRIPT: &str = include_str!("sort.js");

/// A page: `body` between its heading and what was run. `more` is added to that, as name and value.
pub(crate) fn page<T>(
    results: &Results<T>,
    title: &str,
    body: Markup,
    more: &[(String, String)],
    script: Option<&str>,
) -> String {
    let body = html! {
        (body)
        h2 { "Machine and command" }
        p { code { (results.command) } }
        (machine(&results.machine, more).html("text", |_| false))
    };
    plain_page(title, body, script)
}

/// A page without what was run.
pub(crate) fn plain_page(title: &str, body: Markup, script: Option<&str>) -> String {
    let markup = html! {
        (DOCTYPE) "\n"
        html lang="en" {
            head {
                meta charset="utf-8";
                (PreEscaped(GENERATOR_TAG))
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "peelnet: " (title) }
                style { (PreEscaped(STYLE)) }
            }
            "\n"
            body {
                h1 { (title) }
                (body)
                @if let Some(script) = script { script { (PreEscaped(script)) } }
            }
        }
        "\n"
    };
    // maud escapes what a browser would read as markup; this, what acts on a terminal or an editor.
    printable_lines(&markup.into_string()).into_owned()
}

/// A chart in a page. `class` is `chart` for one in the page's colours, `curve` for one on white paper.
pub(crate) fn chart(class: &str, svg: &Svg) -> Markup {
    // What crate::chart draws is escaped already.
    html! { div class=(class) { (PreEscaped(svg.as_str())) } }
}

/// A histogram with its caption, which says how high bars are.
pub(crate) fn histogram(caption: &str, bins: &[Bin], unit: &str) -> Markup {
    let most = bins.iter().map(|bin| bin.count).max().unwrap_or(0);
    html! {
        figure {
            (chart("chart", &bar_chart(bins, unit)))
            figcaption { (caption) " (highest: " (thousands(most)) ")" }
        }
        "\n"
    }
}

/// Name and value of each property of the machine, and of what else is reported.
fn machine(m: &Machine, more: &[(String, String)]) -> Table {
    let memory = match m.memory {
        0 => "unknown".to_owned(),
        bytes => format!("{:.0} GiB", bytes as f64 / f64::from(1 << 30)),
    };
    let lines = [
        ("adapter", format!("{} ({})", m.adapter, m.adapter_kind)),
        ("driver", format!("{}, {}", m.backend, m.driver)),
        ("processor", format!("{}, {} cores", m.cpu, m.cores)),
        ("memory", memory),
        ("system", format!("{} {}", m.os, m.arch)),
        ("peelnet", format!("{} ({} build)", m.peelnet, m.build)),
    ];
    let lines = lines.map(|(name, value)| vec![name.to_owned(), value]);
    let more = more
        .iter()
        .map(|(name, value)| vec![name.clone(), value.clone()]);
    Table::new(["property", "value"], lines.into_iter().chain(more))
}
