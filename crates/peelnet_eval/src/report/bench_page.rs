//! The page of `peelnet bench`: the chart, tables that sort, pictures with difference maps, and what it was run on.

use super::{
    Bench,
    chart::chart,
    page::{STYLE, data_uri, escape, html_table},
};
use crate::{
    EvalError, Row,
    compare::{EXACT, image_name},
    front::{self, Mean, Point},
    ratios::{self, MOMENTS, WEIGHTED},
    table::geometric_mean,
};
use image::{DynamicImage, RgbImage};
use std::{fmt::Write as _, path::Path};

/// Width of the pictures, pixels.
const PICTURE_WIDTH: u32 = 256;

/// Factor of the difference maps.
const MAGNIFIED: u16 = 8;

const EXTRA_STYLE: &str = "
.chart svg { display: block; width: 100%; height: auto; }
.chart svg text { fill: var(--ink); } .chart svg polyline:not([stroke='#D55E00']), .chart svg line { stroke: var(--line); }
.chart circle.point:hover { fill-opacity: 1; }
th[data-sort] { cursor: pointer; } th[data-sort]::after { content: ' ↕'; color: var(--faint); }
tr.front td:first-child { font-weight: bold; color: #d55e00; }
details { margin: 0.8rem 0; } summary { cursor: pointer; font-weight: bold; }
";

/// Clicking a heading sorts its table: by number where both cells begin with one.
const SCRIPT: &str = "
for (const table of document.querySelectorAll('table.sortable')) {
  table.querySelectorAll('th').forEach((heading, column) => {
    heading.dataset.sort = '';
    heading.addEventListener('click', () => {
      const down = heading.dataset.sort === 'up';
      table.querySelectorAll('th').forEach(other => { other.dataset.sort = ''; });
      heading.dataset.sort = down ? 'down' : 'up';
      const key = row => row.cells[column].textContent;
      const order = (a, b) => {
        const [x, y] = [parseFloat(key(a)), parseFloat(key(b))];
        if (isNaN(x) && isNaN(y)) return key(a).localeCompare(key(b));
        if (isNaN(x)) return 1;
        if (isNaN(y)) return -1;
        return x - y;
      };
      const rows = [...table.tBodies[0].rows].sort(order);
      if (down) rows.reverse();
      table.tBodies[0].append(...rows);
    });
  });
}
";

/// The whole page. `images` is the folder with `<scene>-<method>.png`.
pub(super) fn page(bench: &Bench, images: &Path) -> Result<String, EvalError> {
    let rows = &bench.rows;
    let mut scenes: Vec<&str> = Vec::new();
    for row in rows {
        if !scenes.contains(&row.scene.as_str()) {
            scenes.push(&row.scene);
        }
    }
    let all = front::points(rows, None, Mean::Geometric);
    let mut h = String::with_capacity(1 << 20);
    h.push_str("<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n");
    h.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    let _ = write!(
        h,
        "<title>peelnet bench: error against time</title>\n<style>{STYLE}{EXTRA_STYLE}</style>\n\
         <h1>What accuracy costs in time</h1>\n<p>{} methods and settings on {} scenes, {} views in all, drawn by {}.</p>\n",
        all.len(),
        scenes.len(),
        views(rows),
        escape(&bench.machine.adapter),
    );
    h.push_str(
        "<h2>All scenes</h2>\n<p class=\"note\">Geometric means over scenes and views. A bubble is a method with its knobs: hover for \
         its figures; its area grows with its bytes a pixel. Nothing is both faster and more accurate than the methods on the front.</p>\n",
    );
    let _ = writeln!(h, "<div class=\"chart\">{}</div>", chart(&all));
    points_table(&mut h, rows, &all);
    h.push_str(
        "<h2>All scenes, by the size of their errors</h2>\n<p class=\"note\">Arithmetic means of the errors: what is nearly exact on many \
         scenes and wrong on one stands lower here than by ratios.</p>\n",
    );
    let by_size = front::points(rows, None, Mean::Arithmetic);
    let _ = writeln!(h, "<div class=\"chart\">{}</div>", chart(&by_size));
    h.push_str("<h2>Scene by scene</h2>\n");
    for scene in &scenes {
        let own: Vec<Row> = rows.iter().filter(|r| r.scene == *scene).cloned().collect();
        let points = front::points(&own, None, Mean::Geometric);
        let first = own.iter().find(|r| r.method == EXACT);
        let (fragments, most) = first.map_or((None, None), |r| (r.fragments, r.max_layers));
        let number = |x: Option<u64>| x.map_or_else(|| "–".to_owned(), |x| x.to_string());
        let _ = writeln!(
            h,
            "<details><summary>{}</summary>\n<p class=\"note\">View 0: {} fragments, at most {} in a pixel, {:.2} a pixel on average.</p>",
            escape(scene),
            number(fragments),
            number(most.map(u64::from)),
            first.map_or(0.0, mean_depth),
        );
        let _ = writeln!(h, "<div class=\"chart\">{}</div>", chart(&points));
        points_table(&mut h, &own, &points);
        gallery(&mut h, scene, &points, images)?;
        h.push_str("</details>\n");
    }
    passes(&mut h, rows, &all);
    h.push_str("<h2>What was run, and on what</h2>\n");
    let _ = writeln!(h, "<p><code>{}</code></p>", escape(&bench.command));
    let load = |x: Option<f64>| x.map_or_else(|| "unknown".to_owned(), |x| format!("{x:.2}"));
    let mut lines: Vec<Vec<String>> = bench
        .machine
        .lines()
        .into_iter()
        .map(|(k, v)| vec![k.to_owned(), v])
        .collect();
    lines.push(vec![
        "load before and after".to_owned(),
        format!("{}, {}", load(bench.load[0]), load(bench.load[1])),
    ]);
    let headings = ["property", "value"].map(str::to_owned);
    html_table(&mut h, "text", &headings, &lines, &|_| false);
    h.push_str(
        "<p class=\"note\">Times are medians of frames that were drawn method after method in turn, measured by the GPU's timestamps \
         where it has them, sorting on the CPU included. Errors are against abuffer. SSIM: image-compare, windows of 8×8 on 8-bit \
         luma. ꟻLIP: nv-flip, 67 pixels a degree. T error: mean difference of the transmittance that weights stand for, over the \
         fragments of a sample of pixels.</p>\n",
    );
    let _ = write!(h, "<script>{SCRIPT}</script>\n</html>\n");
    Ok(h)
}

fn views(rows: &[Row]) -> usize {
    rows.iter().filter(|r| r.method == EXACT).count()
}

/// Fragments a pixel.
fn mean_depth(row: &Row) -> f64 {
    row.fragments.unwrap_or_default() as f64 / f64::from(row.width * row.height).max(1.0)
}

/// A line for every point, with all measures.
fn points_table(h: &mut String, rows: &[Row], points: &[Point]) {
    let ratios = ratios::ratios(rows);
    let headings = [
        "method",
        "time / hardware blending",
        "ms",
        "MSE (linear)",
        &format!("/ {WEIGHTED}"),
        &format!("/ {MOMENTS}"),
        "MSE 0–255",
        "covered",
        "PSNR dB",
        "SSIM",
        "ꟻLIP",
        "99 % error",
        "T error",
        "passes",
        "bytes a pixel",
    ]
    .map(str::to_owned);
    let mut on_front = Vec::new();
    let cells: Vec<Vec<String>> = points
        .iter()
        .map(|p| {
            let own: Vec<&Row> = rows.iter().filter(|r| r.method == p.method).collect();
            let mean = |value: &dyn Fn(&Row) -> Option<f64>| {
                let values: Option<Vec<f64>> = own.iter().map(|r| value(r)).collect();
                values.map(|v| v.iter().sum::<f64>() / v.len().max(1) as f64)
            };
            let ratio = ratios.iter().find(|r| r.method == p.method);
            let text = |x: Option<f64>, digits: usize| {
                x.map_or_else(|| "–".to_owned(), |x| format!("{x:.digits$}"))
            };
            on_front.push(p.on_front);
            vec![
                p.method.clone(),
                format!("{:.2}", p.time),
                format!("{:.2}", p.time_ms),
                if p.is_exact() {
                    "0".to_owned()
                } else {
                    format!("{:.2e}", p.error)
                },
                text(ratio.and_then(|r| r.to_weighted), 3),
                text(ratio.and_then(|r| r.to_moments), 3),
                text(mean(&|r| Some(r.mse255)), 2),
                text(mean(&|r| r.mse255_covered), 2),
                text(mean(&|r| r.psnr), 1),
                text(mean(&|r| r.ssim), 4),
                text(mean(&|r| r.flip), 4),
                text(mean(&|r| Some(r.p99_error)), 1),
                text(mean(&|r| r.transmittance_error), 4),
                own.iter().map(|r| r.passes).max().unwrap_or(0).to_string(),
                format!("{:.0}", p.bytes),
            ]
        })
        .collect();
    html_table(h, "sortable", &headings, &cells, &|line| on_front[line]);
}

/// Where every method's time goes.
fn passes(h: &mut String, rows: &[Row], points: &[Point]) {
    let cells: Vec<Vec<String>> = points
        .iter()
        .map(|p| {
            let mut names: Vec<&str> = Vec::new();
            let mut times: Vec<Vec<f64>> = Vec::new();
            for row in rows.iter().filter(|r| r.method == p.method) {
                for part in row.time_by_pass.split_whitespace() {
                    let Some((name, ms)) = part.rsplit_once('=') else {
                        continue;
                    };
                    let at = names.iter().position(|n| *n == name).unwrap_or_else(|| {
                        names.push(name);
                        times.push(Vec::new());
                        names.len() - 1
                    });
                    // A pass may be too short to be seen by the clock.
                    times[at].push(ms.parse().unwrap_or(0.0f64).max(1e-4));
                }
            }
            let parts: Vec<String> = names
                .iter()
                .zip(times)
                .filter_map(|(name, t)| Some(format!("{name} {:.2}", geometric_mean(t)?)))
                .collect();
            vec![p.method.clone(), parts.join(" · ")]
        })
        .collect();
    h.push_str("<h2>Time by pass</h2>\n<p class=\"note\">Milliseconds, geometric means over scenes and views.</p>\n");
    let headings = ["method", "passes"].map(str::to_owned);
    html_table(h, "text", &headings, &cells, &|_| false);
}

/// The exact picture, then those of the front and of the references with their difference maps.
fn gallery(h: &mut String, scene: &str, points: &[Point], folder: &Path) -> Result<(), EvalError> {
    let read = |method: &str| {
        let path = folder.join(image_name(scene, method));
        let failed = |source| EvalError::Picture {
            path: path.clone(),
            action: "read",
            source,
        };
        path.exists()
            .then(|| image::open(&path).map(|i| i.to_rgb8()).map_err(failed))
            .transpose()
    };
    let Some(exact) = read(EXACT)? else {
        return Ok(());
    };
    let shrink = |picture: &DynamicImage| {
        data_uri(picture, PICTURE_WIDTH).map_err(|source| EvalError::Picture {
            path: folder.to_owned(),
            action: "shrink",
            source,
        })
    };
    let figure = |h: &mut String, uri: &str, caption: &str| {
        let _ = writeln!(
            h,
            "<figure><img loading=\"lazy\" src=\"{uri}\" alt=\"{0}\"><figcaption>{0}</figcaption></figure>",
            escape(caption)
        );
    };
    h.push_str("<div class=\"gallery\">\n");
    let uri = shrink(&DynamicImage::ImageRgb8(exact.clone()))?;
    figure(h, &uri, &format!("{scene}, exact"));
    for p in points {
        let reference = p.method == WEIGHTED || p.method == MOMENTS;
        // What is exact looks like the first picture.
        if p.is_exact() || !(p.on_front || reference) {
            continue;
        }
        let Some(picture) = read(&p.method)? else {
            continue;
        };
        let map = difference(&exact, &picture);
        figure(h, &shrink(&picture.into())?, &p.method);
        let caption = format!("{}: difference × {MAGNIFIED}", p.method);
        figure(h, &shrink(&map.into())?, &caption);
    }
    h.push_str("</div>\n");
    Ok(())
}

/// How far every channel is off, magnified.
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
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::table::tests::row;

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
            let mut r = row("s<1>", 0, method, mse);
            r.time_ms = Some(ms);
            r.time_by_pass = format!("gather={ms} resolve=0.1");
            rows.push(r);
            let gray = (mse * 2.0) as u8;
            RgbImage::from_pixel(8, 8, image::Rgb([gray; 3]))
                .save(images.join(image_name("s<1>", method)))
                .unwrap();
        }
        let bench = Bench {
            machine: crate::report::machine_of_tests(),
            command: "peelnet bench \"a&b\"".into(),
            load: [Some(0.5), None],
            rows,
        };
        bench.write(dir.path()).unwrap();
        let page = std::fs::read_to_string(dir.path().join("report.html")).unwrap();
        // All scenes in two means and one scene, three bubbles each; the difference of two pictures beside each.
        assert_eq!(page.matches("<circle class=\"point\"").count(), 9);
        assert_eq!(page.matches("data:image/png").count(), 5);
        assert!(
            page.contains("s&lt;1&gt;")
                && page.contains("a&amp;b")
                && page.contains("0.50, unknown")
        );
        assert!(page.contains("gather 2.00 · resolve 0.10"));
        assert!(!page.contains("http://www.w3.org/1999") && !page.contains("https:"));
        assert!(
            std::fs::read_to_string(dir.path().join("pareto.svg"))
                .unwrap()
                .contains("<svg")
        );
    }

    #[test]
    fn difference_maps_are_magnified_and_clamped() {
        let a = RgbImage::from_pixel(1, 1, image::Rgb([10, 20, 30]));
        let b = RgbImage::from_pixel(1, 1, image::Rgb([12, 10, 130]));
        assert_eq!(difference(&a, &b).get_pixel(0, 0).0, [16, 80, 255]);
    }
}
