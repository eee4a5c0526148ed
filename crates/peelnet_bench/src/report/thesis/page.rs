use super::{EXPLANATION, Stage, ThesisRun, mean};
use crate::chart::bubble_chart;
use crate::report::{
    Results, Table, bench, page,
    page::SORT_SCRIPT,
    picture::{data_uri, figure, read},
    table::number,
};
use crate::{
    EvalError, Row,
    compare::image_name,
    front::{self, BASE, Mean},
    rows::Rows,
};
use maud::{Markup, html};
use std::path::Path;

/// Largest sum of the pictures' text, bytes: with tables and curve the page stays under ten megabytes.
const PICTURE_BUDGET: usize = 9_000_000;
/// Widths that are tried for the pictures, pixels.
const WIDTHS: [u32; 5] = [512, 384, 256, 192, 128];

/// The whole page. In the folder, `images` holds `<scene>-<method>.png`.
pub(super) fn page(results: &Results<ThesisRun>, folder: &Path) -> Result<String, EvalError> {
    let images = &folder.join("images");
    let run = &results.measured;
    let rows = Rows::new(&run.rows);
    let pictures = gallery(&rows, images)?;
    let body = html! {
        (showcase(&run.showcase, images)?)
        h2 { "The thesis's promise" }
        ul { @for finding in &run.findings { li { (finding) } } }
        h3 { "The thesis's table" }
        (results.table().html("", |_| false))
        p.note { (EXPLANATION.replace('`', "")) }
        h2 { "All methods" }
        p.note { "Mean squared error (0–255), mean over the views." }
        (results.all_methods().html("", |_| false))
        h2 { "Cost" }
        (costs(&rows).html("", |_| false))
        p.note { "One frame per view, without warm-up: an order of magnitude, not a benchmark." }
        @if let Some(svg) = &run.loss {
            h2 { "Loss" }
            (page::chart("curve", svg))
        }
        (pictures)
        @if let Some(text) = &run.dataset_summary {
            h2 { "Dataset" }
            pre { (text) }
        }
        @if !run.stages.is_empty() {
            h2 { "Times" }
            (stages(&run.stages).html("text", |_| false))
        }
    };
    let title = "Learned transparency against the exact image";
    let (settings, script) = (&run.settings, Some(SORT_SCRIPT));
    Ok(page::page(results, title, body, settings, script))
}

/// One scene with networks that were trained on none of its kind: pictures with their errors, and error against time. Nothing without rows.
fn showcase(rows: &[Row], images: &Path) -> Result<Markup, EvalError> {
    let Some(scene) = rows.first().map(|r| r.scene.as_str()) else {
        return Ok(Markup::default());
    };
    let rows = Rows::new(rows).common();
    let points = front::points(&rows, Mean::Arithmetic);
    // Blending without sorting is only the unit of time.
    let shown = points.iter().filter(|p| p.method != BASE);
    let pictures = bench::page::gallery(scene, shown, images, WIDTHS[1])?;
    Ok(html! {
        h2 { (scene) ", a scene that no network was trained on" }
        p.note {
            "Every method's picture, and below it how far each channel is from the exact picture. MSE: mean squared error in linear light over \
             all views; x hardware blending: frame time in times of hardware blending without sorting."
        }
        (pictures)
        h3 { "Error against time" }
        p.note { "The lower, the more accurate; the further left, the faster. Point at a bubble for its figures." }
        (page::chart("chart", &bubble_chart(&points)))
        (bench::page::points_table(&rows, &points))
    })
}

fn stages(stages: &[Stage]) -> Table {
    Table::from_rows(
        stages,
        &[
            ("stage", &|s| s.name.clone()),
            ("seconds", &|s| format!("{:.1}", s.seconds)),
            ("what", &|s| s.note.clone()),
        ],
    )
}

fn costs(rows: &Rows<'_>) -> Table {
    let time = |method: &str| {
        let own = rows.of_method(method).0.into_iter();
        let mut times: Vec<f64> = own.filter_map(Row::frame_ms).collect();
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied()
    };
    let bytes = |method: &str| rows.of_method(method).bytes().unwrap_or_default();
    Table::from_rows(
        &rows.methods(),
        &[
            ("method", &|m| (*m).to_owned()),
            ("most passes", &|m| bench::page::most_passes(rows, m)),
            ("most bytes a pixel", &|m| format!("{:.0}", bytes(m).most)),
            ("GPU ms (median view)", &|m| number(time(m), 1)),
        ],
    )
}

/// The pictures of every scene, as large as the budget allows.
fn gallery(rows: &Rows<'_>, folder: &Path) -> Result<Markup, EvalError> {
    let (scenes, methods) = (rows.scenes(), rows.methods());
    let mut pictures = Vec::new();
    for scene in &scenes {
        for method in &methods {
            let path = folder.join(image_name(scene, method));
            if let Some(picture) = read(&path)? {
                pictures.push((scene, method, path, picture));
            }
        }
    }
    let mut encoded: Vec<String> = Vec::new();
    for width in WIDTHS {
        let all = pictures.iter();
        let all = all.map(|(.., path, picture)| data_uri(path, picture, width));
        encoded = all.collect::<Result<_, _>>()?;
        if encoded.iter().map(String::len).sum::<usize>() <= PICTURE_BUDGET {
            break;
        }
    }
    let of_scene = |scene: &str| {
        let all = pictures.iter().zip(&encoded);
        let own: Vec<_> = all.filter(|((own, ..), _)| **own == scene).collect();
        own
    };
    Ok(html! {
        @if !pictures.is_empty() { h2 { "Pictures (view 0)" } }
        @for scene in &scenes {
            @let own = of_scene(scene);
            @if !own.is_empty() {
                h3 { (scene) }
                div.gallery {
                    @for ((_, method, ..), uri) in own {
                        @let error = mean(rows, scene, method, |r| r.mse255);
                        @let error = error.map_or_else(String::new, |e| format!(", MSE {e:.2}"));
                        (figure(uri, &format!("{method}{error}")))
                    }
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::{Line, Scale, line_chart};
    use crate::report::testing::{machine, row, written};

    #[test]
    fn a_whole_folder() {
        let dir = tempfile::tempdir().unwrap();
        let images = dir.path().join("images");
        std::fs::create_dir(&images).unwrap();
        let picture = image::RgbImage::from_fn(640, 480, |x, y| image::Rgb([x as u8, y as u8, 7]));
        let path = images.join(image_name("sixteen-025", "deep-thesis"));
        picture.save(path).unwrap();
        let mut rows = vec![
            row("sixteen-025", "wboit-papakostas", 5.0),
            row("sixteen-025", "wboit-papakostas", 15.0),
            row("sixteen-025", "wboit-eq9", 4.0),
            row("sixteen-025", "deep-thesis", 5.0),
            row("cups", "wboit-eq9", 1.0),
        ];
        let mut results = Results::of_rows(machine(), "peelnet run --out \"a&b\"", rows.clone());
        results.measured.trained_on = vec!["cups".to_owned()];
        rows[3].time_ms_min = Some(3.0);
        results.measured.showcase = vec![rows.swap_remove(3)];
        let losses = [Line::new("<training>", [(1.0, 0.5), (2.0, 0.25)])];
        let chart = line_chart(&losses, "epoch", "loss", Scale::Linear);
        results.measured.loss = Some(chart);
        results.measured.dataset_summary = Some("rows <5>".to_owned());
        let page = written(dir.path(), &results);
        assert!(page.contains("data:image/png;base64,iVBOR"));
        assert_eq!(page.matches("<circle class=\"point\"").count(), 1);
        assert!(page.contains("a &lt;fast&gt; one") && page.contains("a&amp;b"));
        assert!(!page.contains("<training>") && !page.contains("rows <5>"));
        // The name of SVG's namespace is no address that is fetched.
        let page = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!page.contains("http") && !page.contains("<?xml"));
        // Means over the views, beside the thesis's own; a figure of a scene that the network learned from says so in both tables.
        let tables = results.markdown();
        let line =
            "| sixteen-025 | 10.00 | 4.00 | 4.00 | 5.00 | 0.50 | 1.25 | 15.96 → 11.79 | 0.74 |";
        assert!(tables.contains(line), "{tables}");
        assert_eq!(tables.matches("cups (trained on)").count(), 2, "{tables}");
        // A name is one line without elements in the findings, too.
        let rows = ["wboit-papakostas", "deep-thesis"].map(|m| row("x\n# <b>[y](z)", m, 1.0));
        let tables = Results::of_rows(machine(), "peelnet run", rows.to_vec()).markdown();
        assert!(
            tables.contains(r"(x\u{a}# &lt;b>&#91;y](z) 1.00)"),
            "{tables}"
        );
    }
}
