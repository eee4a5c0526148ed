//! The first section of a run's page: one scene, a picture of every method with its error and what it gets wrong, then error against
//! time.

use crate::{
    ReportError, Table,
    bench::{
        chart,
        page::{MAGNIFIED, difference},
    },
    page,
    picture::{data_uri, figure, read},
    table::number,
};
use image::DynamicImage;
use maud::{Markup, html};
use peelnet_eval::{
    Row,
    compare::{EXACT, image_name},
    front::{self, BASE, Mean, Point},
    methods_of,
    ratios::{self, MOMENTS, WEIGHTED},
};
use std::path::Path;

/// Width of the pictures, pixels.
const WIDTH: u32 = 384;

/// The section; nothing without rows.
pub(super) fn section(rows: &[Row], images: Option<&Path>) -> Result<Markup, ReportError> {
    let Some(scene) = rows.first().map(|r| r.scene.as_str()) else {
        return Ok(Markup::default());
    };
    let points = front::points(rows, None, Mean::Arithmetic);
    let mut methods = methods_of(rows);
    // Blending without sorting is only the unit of time.
    methods.retain(|&m| m != BASE);
    let gallery = match images {
        Some(folder) => gallery(rows, scene, &methods, folder)?,
        None => Markup::default(),
    };
    Ok(html! {
        h2 { (scene) ", a scene that no network was trained on" }
        p.note {
            "Every method's picture, and below it how far each channel is from the exact picture, " (MAGNIFIED) " times magnified. MSE: mean \
             squared error on the 0–255 scale over all views; × blending: frame time in times of hardware blending without sorting."
        }
        (gallery)
        h3 { "Error against time" }
        p.note { "The lower, the more accurate; the further left, the faster. Point at a bubble for its figures." }
        (page::chart("chart", &chart(&points)))
        (table(rows, &points, &methods).html("", |k| points.iter().any(|p| p.method == methods[k] && p.on_front)))
    })
}

/// Mean over the views.
fn mean(rows: &[Row], method: &str, value: fn(&Row) -> f64) -> f64 {
    let values = rows.iter().filter(|r| r.method == method).map(value);
    let (sum, count) = values.fold((0.0, 0), |(sum, n), x| (sum + x, n + 1));
    sum / f64::from(count.max(1))
}

/// A picture of each method over its difference map.
fn gallery(
    rows: &[Row],
    scene: &str,
    methods: &[&str],
    folder: &Path,
) -> Result<Markup, ReportError> {
    let file = |method: &str| folder.join(image_name(scene, method));
    let Some(exact) = read(&file(EXACT))? else {
        return Ok(Markup::default());
    };
    let exact = exact.to_rgb8();
    let points = front::points(rows, None, Mean::Arithmetic);
    let mut pairs = Vec::new();
    for method in methods {
        let path = file(method);
        let Some(picture) = read(&path)? else {
            continue;
        };
        let time = points.iter().find(|p| p.method == *method);
        let time = time.map_or_else(String::new, |p| format!(", {:.2} × blending", p.time));
        let caption = if *method == EXACT {
            format!("{method}: exact{time}")
        } else {
            let error = mean(rows, method, |r| r.mse255);
            format!("{method}: MSE {error:.1}{time}")
        };
        let map = DynamicImage::ImageRgb8(difference(&exact, &picture.to_rgb8()));
        let uri = data_uri(&path, &picture, WIDTH)?;
        let map = data_uri(&path, &map, WIDTH)?;
        pairs.push(html! {
            div {
                (figure(&uri, &format!("{scene} drawn with {method}"), &caption))
                @if *method != EXACT {
                    (figure(&map, &format!("difference of {method} and exact"), "difference"))
                }
            }
        });
    }
    Ok(html! { div.gallery { @for pair in pairs { (pair) } } })
}

/// Errors, times and bytes.
fn table(rows: &[Row], points: &[Point], methods: &[&str]) -> Table {
    let ratios = ratios::ratios(rows);
    let (to_weighted, to_moments) = (format!("MSE / {WEIGHTED}"), format!("MSE / {MOMENTS}"));
    let headings = [
        "method",
        "MSE 0–255",
        &to_weighted,
        &to_moments,
        "× blending",
        "ms",
        "bytes a pixel",
    ];
    let line = |method: &&str| {
        let point = points.iter().find(|p| p.method == *method);
        let ratio = ratios.iter().find(|r| r.method == *method);
        vec![
            (*method).to_owned(),
            format!("{:.2}", mean(rows, method, |r| r.mse255)),
            number(ratio.and_then(|r| r.to_weighted), 3),
            number(ratio.and_then(|r| r.to_moments), 3),
            number(point.map(|p| p.time), 2),
            number(point.map(|p| p.time_ms), 1),
            number(point.map(|p| p.bytes.most), 0),
        ]
    };
    Table::new(headings, methods.iter().map(line))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::testing::row;

    #[test]
    fn pictures_come_first_with_errors_and_differences() {
        let dir = tempfile::tempdir().unwrap();
        let mut rows = Vec::new();
        for (method, mse, ms) in [
            (BASE, 90.0, 1.0),
            (EXACT, 0.0, 9.0),
            (WEIGHTED, 50.0, 1.5),
            ("deep-medium", 2.0, 3.0),
        ] {
            let mut r = row("s<1>", method, mse);
            r.time_ms = Some(ms);
            rows.push(r);
            image::RgbImage::from_pixel(8, 8, image::Rgb([mse as u8; 3]))
                .save(dir.path().join(image_name("s<1>", method)))
                .unwrap();
        }
        let text = section(&rows, Some(dir.path())).unwrap().into_string();
        // Three pictures, two of them with a map; four bubbles.
        assert_eq!(text.matches("data:image/png").count(), 5);
        assert_eq!(text.matches("<circle class=\"point\"").count(), 4);
        assert!(
            text.contains("deep-medium: MSE 2.0, 3.00 × blending"),
            "{text}"
        );
        assert!(text.contains("abuffer: exact, 9.00 × blending"), "{text}");
        assert!(!text.contains("s<1>"));
        assert!(text.find("data:image").unwrap() < text.find("<circle").unwrap());
    }

    #[test]
    fn nothing_is_shown_without_rows() {
        assert!(section(&[], None).unwrap().into_string().is_empty());
    }
}
