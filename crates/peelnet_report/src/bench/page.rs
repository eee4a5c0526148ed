//! The page of a bench: charts, tables that sort, pictures with difference maps.

use super::{bytes, chart};
use crate::{
    ReportError, Results, Table,
    page::{self, SORT_SCRIPT},
    picture::{data_uri, figure, read},
    table::{number, scene_heading},
};
use image::{DynamicImage, RgbImage};
use maud::{Markup, html};
use peelnet_eval::{
    Row,
    bench::Bench,
    compare::{EXACT, image_name},
    front::{self, Mean, Point},
    geometric_mean,
    ratios::{self, MOMENTS, WEIGHTED},
    scenes_of,
};
use std::path::Path;

/// Width of the pictures, pixels.
const PICTURE_WIDTH: u32 = 256;

/// Factor of the difference maps.
pub(crate) const MAGNIFIED: u16 = 8;

/// The whole page. `images` is the folder with `<scene>-<method>.png`.
pub(super) fn page(results: &Results<Bench>, images: &Path) -> Result<String, ReportError> {
    let rows = &results.measured.rows;
    let scenes = scenes_of(rows);
    let all = front::points(rows, None, Mean::Geometric);
    let by_size = front::points(rows, None, Mean::Arithmetic);
    let by_scene = scenes
        .iter()
        .map(|scene| of_scene(&results.measured, scene, images))
        .collect::<Result<Vec<Markup>, _>>()?;
    let views = rows.iter().filter(|r| r.method == EXACT).count();
    let body = html! {
        p {
            "Methods and settings: " (all.len()) ". Scenes: " (scenes.len()) ". Views: " (views) ". Drawn by " (results.machine.adapter) "."
        }
        h2 { "All scenes" }
        p.note {
            "Geometric means over scenes and views. Each bubble is a method with its settings: point at it for its figures; its area grows \
             with its bytes per pixel. No method is both faster and more accurate than one on the front (orange)."
        }
        (page::chart("chart", &chart(&all)))
        (points_table(rows, &all))
        (untimed(rows))
        h2 { "All scenes, arithmetic means" }
        p.note {
            "Arithmetic means of the errors: a method that is nearly exact on many scenes and wrong on one ranks lower here than by \
             geometric means."
        }
        (page::chart("chart", &chart(&by_size)))
        h2 { "Time scene by scene" }
        p.note { "Times / hardware blending. Where few fragments overlap, exact methods cost little; where smoke fills the frame, much." }
        (results.times_by_scene().html("sortable", |_| false))
        h2 { "Scene by scene" }
        @for scene in &by_scene { (scene) }
        h2 { "Time by pass" }
        p.note { "Milliseconds, geometric means over scenes and views." }
        (passes(rows, &all).html("text", |_| false))
        p.note {
            "Times are medians of frames that were drawn method after method in turn onto a 16-bit target, over its background, measured by \
             the GPU's timestamps where the adapter has them. They include sorting on the CPU, and not the pass that draws background and \
             opaque surfaces. Time at equal error and error at equal time: how far a method is behind the front, interpolated between its \
             points in logarithms. Errors are against abuffer. SSIM: image-compare, windows of 8×8 on 8-bit luma. ꟻLIP: \
             nv-flip, 67 pixels per degree. T error: mean difference between the estimated and the exact transmittance, over the fragments \
             of a sample of pixels. Contour pairs: share of neighbouring pixels with the same transparent surfaces whose errors differ by \
             more than 2 of 255."
        }
    };
    let load = |x: Option<f64>| x.map_or_else(|| "unknown".to_owned(), |x| format!("{x:.2}"));
    let [before, after] = results.measured.load.map(load);
    let more = [(
        "load before and after".to_owned(),
        format!("{before}, {after}"),
    )];
    let title = "Error against time";
    Ok(page::page(results, title, body, &more, Some(SORT_SCRIPT)))
}

/// Chart, table and pictures of one scene.
fn of_scene(bench: &Bench, scene: &str, images: &Path) -> Result<Markup, ReportError> {
    let own: Vec<Row> = bench
        .rows
        .iter()
        .filter(|r| r.scene == scene)
        .cloned()
        .collect();
    let points = front::points(&own, None, Mean::Geometric);
    let first = own.iter().find(|r| r.method == EXACT);
    let (fragments, most) = first.map_or((None, None), |r| (r.fragments, r.max_layers));
    let count = |x: Option<u64>| x.map_or_else(|| "–".to_owned(), |x| x.to_string());
    Ok(html! {
        details {
            summary { (scene_heading(scene, &bench.trained_on)) }
            p.note {
                "View 0: " (count(fragments)) " fragments, at most " (count(most.map(u64::from))) " in a pixel, "
                (format!("{:.2}", first.map_or(0.0, mean_depth))) " per pixel on average."
            }
            (page::chart("chart", &chart(&points)))
            (points_table(&own, &points))
            (gallery(scene, &points, images)?)
        }
        "\n"
    })
}

/// Fragments per pixel.
fn mean_depth(row: &Row) -> f64 {
    row.fragments.unwrap_or_default() as f64 / f64::from(row.width * row.height).max(1.0)
}

/// A line for every point, with all measures.
fn points_table(rows: &[Row], points: &[Point]) -> Markup {
    let ratios = ratios::ratios(rows);
    let to_weighted = format!("/ {WEIGHTED}");
    let to_moments = format!("/ {MOMENTS}");
    let headings = [
        "method",
        "time / hardware blending",
        "ms",
        "MSE (linear)",
        &to_weighted,
        &to_moments,
        "MSE 0–255",
        "covered",
        "PSNR dB",
        "SSIM",
        "ꟻLIP",
        "99 % error",
        "T error",
        "contour pairs",
        "passes",
        "bytes a pixel",
        "time / front at equal error",
        "error / front at equal time",
    ];
    let line = |p: &Point| {
        let own: Vec<&Row> = rows.iter().filter(|r| r.method == p.method).collect();
        let mean = |value: fn(&Row) -> Option<f64>| {
            let values: Option<Vec<f64>> = own.iter().map(|r| value(r)).collect();
            values.map(|v| v.iter().sum::<f64>() / v.len().max(1) as f64)
        };
        let ratio = ratios.iter().find(|r| r.method == p.method);
        let error = if p.is_exact() {
            "0".to_owned()
        } else {
            format!("{:.2e}", p.error)
        };
        vec![
            p.method.clone(),
            format!("{:.2}", p.time),
            format!("{:.2}", p.time_ms),
            error,
            number(ratio.and_then(|r| r.to_weighted), 3),
            number(ratio.and_then(|r| r.to_moments), 3),
            number(mean(|r| Some(r.mse255)), 2),
            number(mean(|r| r.mse255_covered), 2),
            number(mean(|r| r.psnr), 1),
            number(mean(|r| r.ssim), 4),
            number(mean(|r| r.flip), 4),
            number(mean(|r| Some(r.p99_error)), 1),
            number(mean(|r| r.transmittance_error), 4),
            number(mean(|r| r.contour_pairs), 5),
            own.iter().map(|r| r.passes).max().unwrap_or(0).to_string(),
            bytes(&p.bytes),
            number(Some(p.time_at_equal_error), 2),
            number(Some(p.error_at_equal_time), 2),
        ]
    };
    Table::new(headings, points.iter().map(line)).html("sortable", |k| points[k].on_front)
}

/// Methods without a time, which no chart and no table of points has, and why.
fn untimed(rows: &[Row]) -> Markup {
    let all = front::untimed(rows);
    if all.is_empty() {
        return Markup::default();
    }
    let ratios = ratios::ratios(rows);
    let line = |(method, why): &(&str, &str)| {
        let ratio = ratios.iter().find(|r| r.method == *method);
        let error = ratio.and_then(|r| r.mse_linear);
        vec![
            (*method).to_owned(),
            error.map_or_else(|| "0".to_owned(), |x| format!("{x:.2e}")),
            number(ratio.and_then(|r| r.to_weighted), 3),
            number(ratio.and_then(|r| r.to_moments), 3),
            (*why).to_owned(),
        ]
    };
    let to_weighted = format!("/ {WEIGHTED}");
    let to_moments = format!("/ {MOMENTS}");
    let headings = [
        "error only",
        "MSE (linear)",
        &to_weighted,
        &to_moments,
        "why there is no time",
    ];
    html! {
        p.note { "Composited on the CPU from the scene's fragments: the error is the method's own, time and bytes are unknown." }
        (Table::new(headings, all.iter().map(line)).html("text", |_| false))
    }
}

/// Where every method's time goes.
fn passes(rows: &[Row], points: &[Point]) -> Table {
    let line = |p: &Point| {
        let mut times: Vec<(&str, Vec<f64>)> = Vec::new();
        for row in rows.iter().filter(|r| r.method == p.method) {
            for part in row.time_by_pass.split_whitespace() {
                let Some((name, ms)) = part.rsplit_once('=') else {
                    continue;
                };
                // A pass may be too short for the clock.
                let ms = ms.parse().unwrap_or(0.0f64).max(1e-4);
                match times.iter_mut().find(|(n, _)| *n == name) {
                    Some((_, all)) => all.push(ms),
                    None => times.push((name, vec![ms])),
                }
            }
        }
        let parts: Vec<String> = times
            .into_iter()
            .filter_map(|(name, t)| Some(format!("{name} {:.2}", geometric_mean(t)?)))
            .collect();
        vec![p.method.clone(), parts.join(" · ")]
    };
    Table::new(["method", "passes"], points.iter().map(line))
}

/// The exact picture, then those of the front and of the references with their difference maps.
fn gallery(scene: &str, points: &[Point], folder: &Path) -> Result<Markup, ReportError> {
    let file = |method: &str| folder.join(image_name(scene, method));
    let Some(exact) = read(&file(EXACT))? else {
        return Ok(Markup::default());
    };
    let exact = exact.to_rgb8();
    let show = |method: &str, picture: RgbImage, caption: &str| {
        let picture = DynamicImage::ImageRgb8(picture);
        let uri = data_uri(&file(method), &picture, PICTURE_WIDTH)?;
        Ok(figure(&uri, caption, caption))
    };
    let mut figures = vec![show(EXACT, exact.clone(), &format!("{scene}, exact"))?];
    for p in points {
        let reference = p.method == WEIGHTED || p.method == MOMENTS;
        // An exact method's picture looks like the first one.
        if p.is_exact() || !(p.on_front || reference) {
            continue;
        }
        let Some(picture) = read(&file(&p.method))? else {
            continue;
        };
        let picture = picture.to_rgb8();
        let map = difference(&exact, &picture);
        let caption = format!("{}: difference × {MAGNIFIED}", p.method);
        figures.push(show(&p.method, picture, &p.method)?);
        figures.push(show(&p.method, map, &caption)?);
    }
    Ok(html! { div.gallery { @for figure in figures { (figure) } } })
}

/// How far every channel is off, magnified.
pub(crate) fn difference(exact: &RgbImage, other: &RgbImage) -> RgbImage {
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
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::testing::{machine, row};

    #[test]
    fn the_page_shows_what_the_rows_hold() {
        let dir = tempfile::tempdir().unwrap();
        let images = dir.path().join("images");
        std::fs::create_dir(&images).unwrap();
        let mut rows = Vec::new();
        for (method, mse, ms) in [
            (EXACT, 0.0, 9.0),
            (WEIGHTED, 50.0, 2.0),
            (front::BASE, 90.0, 1.0),
        ] {
            let mut r = row("s<1>", method, mse);
            r.time_ms = Some(ms);
            r.time_by_pass = format!("gather={ms} resolve=0.1");
            rows.push(r);
            let gray = (mse * 2.0) as u8;
            RgbImage::from_pixel(8, 8, image::Rgb([gray; 3]))
                .save(images.join(image_name("s<1>", method)))
                .unwrap();
        }
        let bench = Bench {
            load: [Some(0.5), None],
            settings: None,
            trained_on: Vec::new(),
            rows,
        };
        let results = Results::new(machine(), "peelnet bench \"a&b\"", bench);
        results.write(dir.path()).unwrap();
        let page = std::fs::read_to_string(dir.path().join("report.html")).unwrap();
        // All scenes in two means and one scene, three bubbles each; the difference of two pictures beside each.
        assert_eq!(page.matches("<circle class=\"point\"").count(), 9);
        assert_eq!(page.matches("data:image/png").count(), 5);
        assert!(
            page.contains("s&lt;1&gt;")
                && page.contains("a&amp;b")
                && page.contains("0.50, unknown")
        );
        assert!(!page.contains("s<1>") && !page.contains("a <fast> one"));
        assert!(page.contains("gather 2.00 · resolve 0.10"));
        assert!(!page.contains("http://www.w3.org/1999") && !page.contains("https:"));
        assert!(
            std::fs::read_to_string(dir.path().join("pareto.svg"))
                .unwrap()
                .contains("<svg")
        );
        let read: Results<Bench> = Results::read(&dir.path().join("results.json")).unwrap();
        assert_eq!(read, results);
        crate::testing::assert_files(dir.path(), Results::<Bench>::FILES);
    }

    #[test]
    fn difference_maps_are_magnified_and_clamped() {
        let a = RgbImage::from_pixel(1, 1, image::Rgb([10, 20, 30]));
        let b = RgbImage::from_pixel(1, 1, image::Rgb([12, 10, 130]));
        assert_eq!(difference(&a, &b).get_pixel(0, 0).0, [16, 80, 255]);
    }
}
