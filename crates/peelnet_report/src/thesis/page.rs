//! The page of a run.

use super::{Attachments, EXPLANATION, Stage, ThesisRun, showcase, table};
use crate::{
    ReportError, Results, Table, page,
    picture::{data_uri, figure, read},
};
use maud::{Markup, html};
use peelnet_eval::{Row, by_scene::ByScene, compare::image_name};
use std::path::Path;

/// Largest sum of the pictures' text, bytes: with tables and curve the page stays under ten megabytes.
const PICTURE_BUDGET: usize = 9_000_000;
/// Widths that are tried for the pictures, pixels.
const WIDTHS: [u32; 5] = [512, 384, 256, 192, 128];

/// The whole page.
pub(super) fn page(
    results: &Results<ThesisRun>,
    attachments: &Attachments<'_>,
) -> Result<String, ReportError> {
    let run = &results.measured;
    let errors = ByScene::of(&run.rows);
    let pictures = match attachments.images {
        Some(folder) => gallery(&errors, folder)?,
        None => Markup::default(),
    };
    let body = html! {
        (showcase::section(&run.showcase, attachments.images)?)
        h2 { "The thesis's promise" }
        ul { @for finding in &run.findings { li { (finding) } } }
        h3 { "The thesis's table" }
        (table::like_the_thesis(&errors, &run.trained_on).html("", |_| false))
        p.note { (EXPLANATION.replace('`', "")) }
        h2 { "All methods" }
        p.note { "Mean squared error (0–255), mean over the views." }
        (table::all_methods(&errors, &run.trained_on).html("", |_| false))
        h2 { "Cost" }
        (costs(&run.rows, &errors.methods).html("", |_| false))
        p.note { "One frame per view, without warm-up: an order of magnitude, not a benchmark." }
        @if let Some(svg) = attachments.loss {
            h2 { "Loss" }
            (page::chart("curve", svg))
        }
        (pictures)
        @if let Some(text) = attachments.dataset_summary {
            h2 { "Dataset" }
            pre { (text) }
        }
        @if !run.stages.is_empty() {
            h2 { "Times" }
            (stages(&run.stages).html("text", |_| false))
        }
    };
    let title = "Learned transparency against the exact image";
    Ok(page::page(results, title, body, &run.settings, None))
}

fn stages(stages: &[Stage]) -> Table {
    let lines = stages
        .iter()
        .map(|s| vec![s.name.clone(), format!("{:.1}", s.seconds), s.note.clone()]);
    Table::new(["stage", "seconds", "what"], lines)
}

/// Passes, bytes and time of every method, over all scenes.
fn costs(rows: &[Row], methods: &[String]) -> Table {
    let line = |method: &String| {
        let rows: Vec<_> = rows.iter().filter(|r| r.method == *method).collect();
        let mut times: Vec<f64> = rows.iter().filter_map(|r| r.time_ms).collect();
        times.sort_by(f64::total_cmp);
        let most = rows.iter().map(|r| r.passes).max().unwrap_or(0);
        let bytes = rows.iter().filter_map(|r| r.bytes_per_pixel);
        let bytes = bytes.fold(0.0, f64::max);
        vec![
            method.clone(),
            most.to_string(),
            format!("{bytes:.0}"),
            crate::table::number(times.get(times.len() / 2).copied(), 1),
        ]
    };
    let headings = [
        "method",
        "most passes",
        "most bytes a pixel",
        "GPU ms (median frame)",
    ];
    Table::new(headings, methods.iter().map(line))
}

/// The pictures of every scene, as large as the budget allows.
fn gallery(errors: &ByScene, folder: &Path) -> Result<Markup, ReportError> {
    let mut pictures = Vec::new();
    for (number, scene) in errors.scenes.iter().enumerate() {
        for method in &errors.methods {
            let path = folder.join(image_name(&scene.scene, method));
            if let Some(picture) = read(&path)? {
                pictures.push((number, method, path, picture));
            }
        }
    }
    let mut encoded: Vec<String> = Vec::new();
    for width in WIDTHS {
        let all = pictures.iter();
        encoded = all
            .map(|(.., path, picture)| data_uri(path, picture, width))
            .collect::<Result<_, _>>()?;
        if encoded.iter().map(String::len).sum::<usize>() <= PICTURE_BUDGET {
            break;
        }
    }
    let of_scene = |scene: usize| {
        let all = pictures.iter().zip(&encoded);
        all.filter(move |((number, ..), _)| *number == scene)
    };
    Ok(html! {
        @if !pictures.is_empty() { h2 { "Pictures (view 0)" } }
        @for (number, scene) in errors.scenes.iter().enumerate() {
            @if of_scene(number).next().is_some() {
                h3 { (scene.scene) }
                div.gallery {
                    @for ((_, method, ..), uri) in of_scene(number) {
                        @let error = scene.mse255.get(*method).map_or_else(String::new, |e| format!(", MSE {e:.2}"));
                        (figure(uri, &format!("{} drawn with {method}", scene.scene), &format!("{method}{error}")))
                    }
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::testing::{machine, row};
    use peelnet_chart::{Line, LineChart, Scale};

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
            row("sixteen-025", "wboit-papakostas", 10.0),
            row("sixteen-025", "deep-thesis", 5.0),
        ];
        let results = Results::of_rows(machine(), "peelnet run --out \"a&b\"", rows);
        let loss = LineChart {
            lines: &[Line::new("<training>", [(1.0, 0.5), (2.0, 0.25)])],
            x: "epoch",
            y: "loss",
            x_scale: Scale::Linear,
        };
        results
            .write(
                dir.path(),
                &Attachments {
                    images: Some(&images),
                    loss: Some(&loss.svg()),
                    dataset_summary: Some("rows <5>"),
                },
            )
            .unwrap();
        let page = std::fs::read_to_string(dir.path().join("report.html")).unwrap();
        assert!(page.contains("data:image/png;base64,iVBOR"));
        assert!(page.contains("a &lt;fast&gt; one") && page.contains("a&amp;b"));
        assert!(page.contains("&lt;training&gt;") && page.contains("rows &lt;5&gt;"));
        assert!(!page.contains("<training>") && !page.contains("rows <5>"));
        assert!(!page.contains("<?xml"));
        // The name of SVG's namespace is no address that is fetched.
        assert!(
            !page
                .replace("http://www.w3.org/2000/svg", "")
                .contains("http")
        );
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
        crate::testing::assert_files(dir.path(), Results::<ThesisRun>::FILES);
    }
}
