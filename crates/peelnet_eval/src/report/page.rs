//! The report's page: one HTML file that needs neither network nor any other file.

use super::{Attachments, EXPLANATION, Record};
use crate::{EvalError, base64, compare::image_name, table::Table};
use image::{DynamicImage, ImageFormat, imageops::FilterType};
use std::fmt::Write as _;
use std::io::Cursor;
use std::path::Path;

/// Largest sum of the pictures' text, bytes: with tables and curve the page stays under ten megabytes.
const PICTURE_BUDGET: usize = 9_000_000;
/// Widths that are tried for the pictures, pixels.
const WIDTHS: [u32; 5] = [512, 384, 256, 192, 128];

pub(super) const STYLE: &str = "
:root { color-scheme: light dark; --ink: #1b1f24; --paper: #ffffff; --line: #d5d9de; --soft: #f4f6f8; --faint: #59636e; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e9ed; --paper: #14171b; --line: #363c44; --soft: #1d2127; --faint: #9aa4af; }
}
body { margin: 2rem auto; max-width: 72rem; padding: 0 1rem; color: var(--ink); background: var(--paper);
  font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.25rem; margin-top: 2.5rem; } h3 { font-size: 1rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 0.9rem; }
th, td { border-bottom: 1px solid var(--line); padding: 0.3rem 0.7rem; text-align: right; }
th:first-child, td:first-child { text-align: left; }
table.text td { text-align: left; }
p.note { color: var(--faint); font-size: 0.9rem; }
pre { background: var(--soft); padding: 0.8rem; overflow-x: auto; font-size: 0.8rem; }
code { background: var(--soft); padding: 0 0.25em; overflow-wrap: anywhere; }
.curve { background: #ffffff; border: 1px solid var(--line); max-width: 50rem; }
.curve svg { display: block; width: 100%; height: auto; }
.gallery { display: grid; grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); gap: 0.8rem; }
figure { margin: 0; } figure img { width: 100%; height: auto; display: block; border: 1px solid var(--line); }
figcaption { font-size: 0.8rem; color: var(--faint); }
";

/// The whole page.
pub(super) fn page(record: &Record, attachments: &Attachments<'_>) -> Result<String, EvalError> {
    let table = Table::of(&record.rows);
    let mut h = String::with_capacity(1 << 20);
    h.push_str("<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n");
    h.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    let _ = write!(
        h,
        "<title>peelnet: learned transparency against the exact image</title>\n<style>{STYLE}</style>\n\
         <h1>Learned weighted blending against the exact image</h1>\n"
    );

    h.push_str("<h2>Findings</h2>\n<ul>\n");
    for finding in &record.findings {
        let _ = writeln!(h, "<li>{}</li>", escape(finding));
    }
    h.push_str("</ul>\n<h2>The table</h2>\n");
    html_table(&mut h, "", &table.headings(), &table.cells(), &|_| false);
    let _ = writeln!(
        h,
        "<p class=\"note\">{}</p>",
        escape(&EXPLANATION.replace('`', ""))
    );

    h.push_str("<h2>All methods</h2>\n<p class=\"note\">Mean squared error (0–255), mean over the views.</p>\n");
    let (headings, cells) = table.all_methods();
    html_table(&mut h, "", &headings, &cells, &|_| false);
    costs(&mut h, record, &table);

    if let Some(svg) = attachments.loss_svg {
        // A prolog is not allowed inside HTML.
        let svg = svg.find("<svg").map_or(svg, |at| &svg[at..]);
        let _ = writeln!(h, "<h2>Loss</h2>\n<div class=\"curve\">{svg}</div>");
    }
    if let Some(folder) = attachments.images {
        gallery(&mut h, &table, folder)?;
    }
    if let Some(text) = attachments.dataset_summary {
        let _ = writeln!(h, "<h2>Dataset</h2>\n<pre>{}</pre>", escape(text));
    }

    h.push_str("<h2>What was run, and on what</h2>\n");
    let _ = writeln!(h, "<p><code>{}</code></p>", escape(&record.command));
    let pairs: Vec<Vec<String>> = record
        .machine
        .lines()
        .into_iter()
        .map(|(k, v)| vec![k.to_owned(), v])
        .chain(
            record
                .settings
                .iter()
                .map(|(k, v)| vec![k.clone(), v.clone()]),
        )
        .collect();
    html_table(
        &mut h,
        "text",
        &["property".to_owned(), "value".to_owned()],
        &pairs,
        &|_| false,
    );
    if !record.stages.is_empty() {
        h.push_str("<h3>Times</h3>\n");
        let stages: Vec<Vec<String>> = record
            .stages
            .iter()
            .map(|s| vec![s.name.clone(), format!("{:.1}", s.seconds), s.note.clone()])
            .collect();
        let headings = ["stage", "seconds", "what"].map(str::to_owned);
        html_table(&mut h, "text", &headings, &stages, &|_| false);
    }
    h.push_str("</html>\n");
    Ok(h)
}

/// Passes, bytes and time of every method, over all scenes.
fn costs(h: &mut String, record: &Record, table: &Table) {
    let cells: Vec<Vec<String>> = table
        .methods
        .iter()
        .map(|method| {
            let rows: Vec<_> = record.rows.iter().filter(|r| r.method == *method).collect();
            let mut times: Vec<f64> = rows.iter().filter_map(|r| r.time_ms).collect();
            times.sort_by(f64::total_cmp);
            let most = rows.iter().map(|r| r.passes).max().unwrap_or(0);
            let bytes = rows.iter().map(|r| r.bytes_per_pixel).fold(0.0, f64::max);
            vec![
                method.clone(),
                most.to_string(),
                format!("{bytes:.0}"),
                times
                    .get(times.len() / 2)
                    .map_or_else(|| "–".to_owned(), |t| format!("{t:.1}")),
            ]
        })
        .collect();
    h.push_str("<h2>Cost</h2>\n");
    let headings = [
        "method",
        "most passes",
        "most bytes a pixel",
        "GPU ms (median frame)",
    ];
    html_table(h, "", &headings.map(str::to_owned), &cells, &|_| false);
    h.push_str(
        "<p class=\"note\">One frame per view, without warm-up: an order of magnitude, not a benchmark.</p>\n",
    );
}

/// A table; lines for which `marked` holds have the class `front`.
pub(super) fn html_table(
    h: &mut String,
    class: &str,
    headings: &[String],
    cells: &[Vec<String>],
    marked: &dyn Fn(usize) -> bool,
) {
    let _ = write!(
        h,
        "<div class=\"scroll\"><table class=\"{class}\"><thead><tr>"
    );
    for heading in headings {
        let _ = write!(h, "<th>{}</th>", escape(heading));
    }
    h.push_str("</tr></thead><tbody>\n");
    for (k, line) in cells.iter().enumerate() {
        h.push_str(if marked(k) {
            "<tr class=\"front\">"
        } else {
            "<tr>"
        });
        for cell in line {
            let _ = write!(h, "<td>{}</td>", escape(cell));
        }
        h.push_str("</tr>\n");
    }
    h.push_str("</tbody></table></div>\n");
}

/// The pictures of every scene, as large as the budget allows.
fn gallery(h: &mut String, table: &Table, folder: &Path) -> Result<(), EvalError> {
    let mut pictures = Vec::new();
    for line in &table.lines {
        for method in &table.methods {
            let path = folder.join(image_name(&line.scene, method));
            if path.exists() {
                let picture = image::open(&path).map_err(|source| EvalError::Picture {
                    path: path.clone(),
                    action: "read",
                    source,
                })?;
                pictures.push((line, method, picture));
            }
        }
    }
    let mut encoded = Vec::new();
    for width in WIDTHS {
        encoded.clear();
        for (_, method, picture) in &pictures {
            encoded.push(
                data_uri(picture, width).map_err(|source| EvalError::Picture {
                    path: folder.join(method),
                    action: "shrink",
                    source,
                })?,
            );
        }
        if encoded.iter().map(String::len).sum::<usize>() <= PICTURE_BUDGET {
            break;
        }
    }
    if pictures.is_empty() {
        return Ok(());
    }
    h.push_str("<h2>Pictures (view 0)</h2>\n");
    let mut scene = "";
    for ((line, method, _), uri) in pictures.iter().zip(&encoded) {
        if scene != line.scene {
            if !scene.is_empty() {
                h.push_str("</div>\n");
            }
            scene = &line.scene;
            let _ = writeln!(h, "<h3>{}</h3>\n<div class=\"gallery\">", escape(scene));
        }
        let error = line
            .mse255
            .get(*method)
            .map_or_else(String::new, |e| format!(", MSE {e:.2}"));
        let name = escape(method);
        let _ = writeln!(
            h,
            "<figure><img loading=\"lazy\" src=\"{uri}\" alt=\"{} drawn with {name}\"><figcaption>{name}{error}</figcaption></figure>",
            escape(scene),
        );
    }
    h.push_str("</div>\n");
    Ok(())
}

/// A picture as `data:` URI, shrunk to at most `width` pixels.
pub(super) fn data_uri(picture: &DynamicImage, width: u32) -> Result<String, image::ImageError> {
    let shrunk;
    let picture = if picture.width() > width {
        shrunk = picture.resize(width, u32::MAX, FilterType::Triangle);
        &shrunk
    } else {
        picture
    };
    let mut png = Cursor::new(Vec::new());
    picture.to_rgb8().write_to(&mut png, ImageFormat::Png)?;
    Ok(format!(
        "data:image/png;base64,{}",
        base64::encode(png.get_ref())
    ))
}

pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
pub(crate) mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::{Machine, table::tests::row};

    pub(crate) fn machine() -> Machine {
        Machine {
            os: "linux".into(),
            arch: "x86_64".into(),
            cpu: "a <fast> one".into(),
            cores: 2,
            adapter: "test".into(),
            adapter_kind: "software".into(),
            backend: "vulkan".into(),
            driver: String::new(),
            peelnet: "0".into(),
            build: "debug".into(),
        }
    }

    #[test]
    fn a_whole_folder() {
        let dir = tempfile::tempdir().unwrap();
        let images = dir.path().join("images");
        std::fs::create_dir(&images).unwrap();
        let picture = image::RgbImage::from_fn(640, 480, |x, y| image::Rgb([x as u8, y as u8, 7]));
        picture
            .save(images.join(image_name("sixteen-025", "deep-thesis")))
            .unwrap();
        let rows = vec![
            row("sixteen-025", 0, "wboit-papakostas", 10.0),
            row("sixteen-025", 0, "deep-thesis", 5.0),
        ];
        let record = Record::new(machine(), "peelnet run --out \"a&b\"".into(), rows);
        record
            .write(
                dir.path(),
                &Attachments {
                    images: Some(&images),
                    loss_svg: Some("<?xml version=\"1.0\"?>\n<svg></svg>"),
                    dataset_summary: Some("rows 5"),
                },
            )
            .unwrap();
        let page = std::fs::read_to_string(dir.path().join("report.html")).unwrap();
        assert!(page.contains("data:image/png;base64,iVBOR"));
        assert!(page.contains("a &lt;fast&gt; one") && page.contains("a&amp;b"));
        assert!(!page.contains("<?xml") && !page.contains("http"));
        assert!(page.contains("prefers-color-scheme: dark"));
        let json: serde_json::Value =
            serde_json::from_slice(&std::fs::read(dir.path().join("results.json")).unwrap())
                .unwrap();
        assert_eq!(json["rows"][1]["method"], "deep-thesis");
        assert_eq!(json["rows"][0]["time_ms"], serde_json::Value::Null);
        assert_eq!(json["machine"]["cores"], 2);
        let table = std::fs::read_to_string(dir.path().join("table.md")).unwrap();
        assert!(table.contains("| sixteen-025 | 10.00 |"), "{table}");
        assert!(table.contains("15.96 → 11.79"), "{table}");
    }
}
