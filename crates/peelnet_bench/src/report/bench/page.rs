//! The page of a bench: charts, tables that sort, pictures with difference maps.

use super::{ERROR_TO_FRONT, TIME_TO_FRONT, TO_BASE, TO_MOMENTS, TO_WEIGHTED, mse};
use crate::chart::bubble_chart;
use crate::report::{
    Results, Table,
    page::{self, SORT_SCRIPT},
    picture::{data_uri, figure, read},
    table::{number, scene_heading},
};
use crate::{
    EvalError, Row,
    bench::Bench,
    compare::{EXACT, image_name},
    front::{self, Mean, Point},
    rows::{MOMENTS, Rows, WEIGHTED, geometric_mean},
};
use image::{DynamicImage, RgbImage};
use maud::{Markup, html};
use std::{collections::HashMap, path::Path};

const PICTURE_WIDTH: u32 = 256;

const MAGNIFIED: u16 = 8;

/// The whole page. In the folder, `images` holds `<scene>-<method>.png`.
pub(super) fn page(results: &Results<Bench>, folder: &Path) -> Result<String, EvalError> {
    let images = &folder.join("images");
    let every = Rows::new(&results.measured.rows);
    let scenes = every.scenes();
    let views = every.of_method(EXACT).0.len();
    // Means are over what all methods have.
    let rows = &every.common();
    let all = front::points(rows, Mean::Geometric);
    let by_size = front::points(rows, Mean::Arithmetic);
    let body = html! {
        p {
            "Methods and settings: " (all.len()) ". Scenes: " (scenes.len()) ". Views: " (views) ". Drawn by " (results.machine.adapter) "."
        }
        h2 { "All scenes" }
        p.note {
            @if let Some(note) = every.note() { (note) " " }
            "Geometric means over scenes and views. Each bubble is a method with its settings: point at it for its figures; its area grows \
             with its bytes per pixel. No method is both faster and more accurate than one on the front (orange)."
        }
        (page::chart("chart", &bubble_chart(&all)))
        (points_table(rows, &all))
        (untimed(rows))
        h2 { "All scenes, arithmetic means" }
        p.note {
            "Arithmetic means of the errors: a method that is nearly exact on many scenes and wrong on one ranks lower here than by \
             geometric means."
        }
        (page::chart("chart", &bubble_chart(&by_size)))
        h2 { "Time scene by scene" }
        p.note { "Times / hardware blending. Where few fragments overlap, exact methods cost little; where smoke fills the frame, much." }
        (results.times_by_scene().html("sortable", |_| false))
        h2 { "Scene by scene" }
        @for scene in &scenes { (of_scene(&results.measured, scene, images)?) }
        h2 { "Time by pass" }
        p.note { "Milliseconds, geometric means over scenes and views." }
        (passes(rows, &all).html("text", |_| false))
        p.note {
            "A time is the least of frames that were drawn method after method in turn onto a 16-bit target, over its background, measured by \
             the GPU's timestamps where the adapter has them. Times include sorting on the CPU, and not the pass that draws background and \
             opaque surfaces. Time at equal error and error at equal time: how far a method is behind the front, interpolated between its \
             points in logarithms. Errors are against abuffer. SSIM: image-compare, windows of 8×8 on 8-bit luma. ꟻLIP: \
             nv-flip, 67 pixels per degree. T error: mean difference between the estimated and the exact transmittance, over the fragments \
             of a sample of pixels. Contour pairs: share of neighbouring pixels with the same transparent surfaces whose errors differ by \
             more than 2 of 255."
        }
    };
    let load = |x: Option<f64>| x.map_or_else(|| "unknown".to_owned(), |x| format!("{x:.2}"));
    let [before, after] = results.measured.load.map(load);
    let load = format!("{before}, {after}");
    let more = [("load before and after".to_owned(), load)];
    let title = "Error against time";
    Ok(page::page(results, title, body, &more, Some(SORT_SCRIPT)))
}

fn of_scene(bench: &Bench, scene: &str, images: &Path) -> Result<Markup, EvalError> {
    let every = Rows::new(&bench.rows).of_scene(scene);
    let own = every.common();
    let points = front::points(&own, Mean::Geometric);
    let first = every.of_method(EXACT).0.first().copied();
    let (fragments, most) = first.map_or((None, None), |r| (r.fragments, r.max_layers));
    let mean_depth = first.map_or(0.0, |r| {
        r.fragments.unwrap_or_default() as f64 / f64::from(r.width * r.height).max(1.0)
    });
    let is_shown = |p: &&Point| p.on_front || p.method == WEIGHTED || p.method == MOMENTS;
    let shown = points.iter().filter(is_shown);
    let count = |x: Option<u64>| x.map_or_else(|| "–".to_owned(), |x| x.to_string());
    Ok(html! {
        details {
            summary { (scene_heading(scene, &bench.trained_on)) }
            p.note {
                "View 0: " (count(fragments)) " fragments, at most " (count(most.map(u64::from))) " in a pixel, "
                (format!("{mean_depth:.2}")) " per pixel on average."
            }
            @if let Some(note) = every.note() { p.note { (note) } }
            (page::chart("chart", &bubble_chart(&points)))
            (points_table(&own, &points))
            (gallery(scene, shown, images, PICTURE_WIDTH)?)
        }
        "\n"
    })
}

pub(crate) fn points_table(rows: &Rows<'_>, points: &[Point]) -> Markup {
    let ratio = |p: &Point, to| number(rows.error_ratio(&p.method, to), 3);
    let mean = |p: &Point, value: fn(&Row) -> Option<f64>, digits| {
        number(rows.of_method(&p.method).mean(value), digits)
    };
    let table = Table::from_rows(
        points,
        &[
            ("method", &|p| p.method.clone()),
            (TO_BASE, &|p| number(p.time, 2)),
            ("ms", &|p| format!("{:.2}", p.time_ms)),
            ("MSE (linear)", &|p| mse(Some(p.mse()))),
            (TO_WEIGHTED, &|p| ratio(p, WEIGHTED)),
            (TO_MOMENTS, &|p| ratio(p, MOMENTS)),
            ("MSE 0–255", &|p| mean(p, |r| Some(r.mse255), 2)),
            ("covered", &|p| mean(p, |r| r.mse255_covered, 2)),
            ("PSNR dB", &|p| mean(p, |r| r.psnr, 1)),
            ("SSIM", &|p| mean(p, |r| r.ssim, 4)),
            ("ꟻLIP", &|p| mean(p, |r| r.flip, 4)),
            ("99 % error", &|p| mean(p, |r| Some(r.p99_error), 1)),
            ("T error", &|p| mean(p, |r| r.transmittance_error, 4)),
            ("contour pairs", &|p| mean(p, |r| r.contour_pairs, 5)),
            ("passes", &|p| most_passes(rows, &p.method)),
            ("bytes a pixel", &|p| p.bytes.text()),
            (TIME_TO_FRONT, &|p| number(Some(p.time_at_equal_error), 2)),
            (ERROR_TO_FRONT, &|p| number(Some(p.error_at_equal_time), 2)),
        ],
    );
    table.html("sortable", |k| points[k].on_front)
}

pub(crate) fn most_passes(rows: &Rows<'_>, method: &str) -> String {
    let own = rows.of_method(method).0.into_iter();
    own.map(|r| r.passes).max().unwrap_or(0).to_string()
}

/// Methods without a time, which no chart and no table of points has, and why.
fn untimed(rows: &Rows<'_>) -> Markup {
    let all = front::untimed(rows);
    let ratio = |method, to| number(rows.error_ratio(method, to), 3);
    let table = Table::from_rows(
        &all,
        &[
            ("error only", &|m| m.0.to_owned()),
            ("MSE (linear)", &|m| mse(rows.error_of(m.0))),
            (TO_WEIGHTED, &|m| ratio(m.0, WEIGHTED)),
            (TO_MOMENTS, &|m| ratio(m.0, MOMENTS)),
            ("why there is no time", &|m| m.1.to_owned()),
        ],
    );
    html! {
        @if !all.is_empty() {
            p.note { "Composited on the CPU from the scene's fragments: the error is the method's own, time and bytes are unknown." }
            (table.html("text", |_| false))
        }
    }
}

fn passes(rows: &Rows<'_>, points: &[Point]) -> Table {
    let line = |p: &Point| {
        let mut times: Vec<(&str, Vec<f64>)> = Vec::new();
        let mut places: HashMap<&str, usize> = HashMap::new();
        for row in rows.of_method(&p.method).0 {
            for part in row.time_by_pass.split_whitespace() {
                let Some((name, ms)) = part.rsplit_once('=') else {
                    continue;
                };
                // A pass may be too short for the clock.
                let ms = ms.parse().unwrap_or(0.0f64).max(1e-4);
                let place = *places.entry(name).or_insert(times.len());
                if place == times.len() {
                    times.push((name, Vec::new()));
                }
                times[place].1.push(ms);
            }
        }
        let part = |(name, t): (&str, Vec<f64>)| Some(format!("{name} {:.2}", geometric_mean(t)?));
        let parts: Vec<String> = times.into_iter().filter_map(part).collect();
        vec![p.method.clone(), parts.join(" · ")]
    };
    Table::new(["method", "passes"], points.iter().map(line))
}

/// The exact picture, then those of methods with their difference maps below. Exact methods look like the first one.
pub(crate) fn gallery<'a>(
    scene: &str,
    points: impl IntoIterator<Item = &'a Point>,
    folder: &Path,
    width: u32,
) -> Result<Markup, EvalError> {
    let file = |method: &str| folder.join(image_name(scene, method));
    let Some(exact) = read(&file(EXACT))? else {
        return Ok(Markup::default());
    };
    let uri = data_uri(&file(EXACT), &exact, width)?;
    let mut all = vec![figure(&uri, &format!("{scene}, exact"))];
    let exact = exact.to_rgb8();
    for p in points.into_iter().filter(|p| !p.is_exact()) {
        let path = file(&p.method);
        let Some(picture) = read(&path)? else {
            continue;
        };
        let map = DynamicImage::ImageRgb8(difference(&exact, &picture.to_rgb8()));
        let [picture, map] = [&picture, &map].map(|image| data_uri(&path, image, width));
        let caption = format!("{}: MSE {:.2e}, {}", p.method, p.error, p.time_text());
        all.push(html! {
            div {
                (figure(&picture?, &caption))
                (figure(&map?, &format!("{}: difference × {MAGNIFIED}", p.method)))
            }
        });
    }
    Ok(html! { div.gallery { @for figure in all { (figure) } } })
}

fn difference(exact: &RgbImage, other: &RgbImage) -> RgbImage {
    let mut map = other.clone();
    for (d, e) in map.pixels_mut().zip(exact.pixels()) {
        for (d, e) in d.0.iter_mut().zip(e.0) {
            *d = (u16::from(d.abs_diff(e)) * MAGNIFIED).min(255) as u8;
        }
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::testing::{machine, row, written};

    #[test]
    fn the_page_shows_what_the_rows_hold() {
        let dir = tempfile::tempdir().unwrap();
        let images = dir.path().join("images");
        std::fs::create_dir(&images).unwrap();
        let mut rows = Vec::new();
        for (method, mse, ms) in [
            (EXACT, 0.0, 9.0),
            (MOMENTS, 25.0, 3.0),
            (WEIGHTED, 50.0, 2.0),
            (front::BASE, 90.0, 1.0),
        ] {
            let mut r = row("s<1>", method, mse);
            r.time_ms_min = Some(ms);
            r.time_by_pass = format!("gather={ms} resolve=0.1");
            rows.push(r);
            let gray = (mse * 2.0) as u8;
            let picture = RgbImage::from_pixel(8, 8, image::Rgb([gray; 3]));
            let path = images.join(image_name("s<1>", method));
            picture.save(path).unwrap();
        }
        let bench = Bench {
            load: [Some(0.5), None],
            trained_on: vec!["s<1>".to_owned()],
            rows,
            ..Bench::default()
        };
        let results = Results::new(machine(), "peelnet bench \"a&b\"", bench);
        let page = written(dir.path(), &results);
        // All scenes in two means and one scene, four bubbles each; beside each picture its difference from the exact one.
        assert_eq!(page.matches("<circle class=\"point\"").count(), 12);
        assert_eq!(page.matches("data:image/png").count(), 7);
        assert_eq!(results.table().rows[2][4], "2.00 (s<1>, trained on)");
        for text in ["s&lt;1&gt;", "a&amp;b", "0.50, unknown"] {
            assert!(page.contains(text), "{text}");
        }
        assert!(!page.contains("s<1>") && !page.contains("a <fast> one"));
        assert!(page.contains("gather 2.00 · resolve 0.10"));
        assert!(!page.contains("http://www.w3.org/1999") && !page.contains("https:"));
    }
}
