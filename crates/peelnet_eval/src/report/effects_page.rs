//! The page of `peelnet bench --effects`: what effects cost, what they look like, and what shading one layer saves.

use super::page::{STYLE, data_uri, escape, html_table};
use crate::{
    EvalError,
    effects::{EFFECTS, Effects, FILLS, LAYERS, picture_of},
};
use std::{fmt::Write as _, path::Path};

/// Width of the pictures, pixels.
const PICTURE_WIDTH: u32 = 320;

/// The whole page; pictures come from `images/` in the folder.
pub(crate) fn page(effects: &Effects, folder: &Path) -> Result<String, EvalError> {
    let mut h = String::with_capacity(1 << 20);
    h.push_str("<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n");
    h.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    let _ = write!(
        h,
        "<title>peelnet: what effects cost</title>\n<style>{STYLE}</style>\n<h1>Effects: on, off and what they cost</h1>\n\
         <p>{} at {}x{}, medians of {} frames drawn in turn.</p>\n",
        escape(&effects.method),
        effects.size[0],
        effects.size[1],
        effects.frames
    );
    for ((title, note), (headings, cells), svg) in [
        (EFFECTS, effects.table(), None),
        (LAYERS, effects.layer_table(), Some(effects.layer_chart())),
        (FILLS, effects.fill_table(), None),
    ] {
        if cells.is_empty() {
            continue;
        }
        let _ = writeln!(h, "<h2>{title}</h2>\n<p class=\"note\">{note}</p>");
        html_table(&mut h, "", &headings, &cells, &|_| false);
        if let Some(svg) = svg {
            let _ = writeln!(h, "<div class=\"curve\">{svg}</div>");
        }
    }
    h.push_str("<h2>With and without</h2>\n");
    for cost in &effects.costs {
        let mut figures = String::new();
        for on in [true, false] {
            let path = picture_of(folder, &cost.scene, &cost.effect, on);
            if !path.exists() {
                continue;
            }
            let failed = |action| {
                let path = path.clone();
                move |source| EvalError::Picture {
                    path,
                    action,
                    source,
                }
            };
            let picture = image::open(&path).map_err(failed("read"))?;
            let uri = data_uri(&picture, PICTURE_WIDTH).map_err(failed("shrink"))?;
            let state = if on { "with" } else { "without" };
            let _ = write!(
                figures,
                "<figure><img src=\"{uri}\" alt=\"{0} {state} {1}\"><figcaption>{state} {1}</figcaption></figure>",
                escape(&cost.scene),
                escape(&cost.effect)
            );
        }
        if !figures.is_empty() {
            let _ = writeln!(
                h,
                "<h3>{}: {}, {:.2} times the time</h3>\n<div class=\"gallery\">{figures}</div>",
                escape(&cost.scene),
                escape(&cost.effect),
                cost.ratio
            );
        }
    }
    h.push_str("<h2>What was run, and on what</h2>\n");
    let _ = writeln!(h, "<p><code>{}</code></p>", escape(&effects.command));
    let lines = effects.machine.lines().into_iter();
    let lines: Vec<Vec<String>> = lines.map(|(k, v)| vec![k.to_owned(), v]).collect();
    let headings = ["property", "value"].map(str::to_owned);
    html_table(&mut h, "text", &headings, &lines, &|_| false);
    h.push_str("</html>\n");
    Ok(h)
}
