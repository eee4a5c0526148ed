//! The files of `peelnet bench path`: errors along a path, their change from frame to frame, and how visible the difference is.

use crate::chart::{Line, Scale, Svg, line_chart};
use crate::report::{
    Files, Measurement, Results, Table,
    files::csv,
    page::{self, SORT_SCRIPT},
    picture::figure_of,
    table::number,
};
use crate::{
    EvalError,
    compare::{EXACT, image_name},
    each_once,
    front::EXACT_MSE,
    path::{Along, FrameRow, PathRow},
    rows,
};
use maud::{Markup, html};
use std::{collections::BTreeSet, path::Path};

const STRIP_WIDTH: u32 = 1200;

const NOTE: &str = "JOD: just-objectionable differences by ColorVideoVDP, 10 for no visible difference. Error: mean absolute difference of \
    sRGB-encoded values from the exact image, 0–255. Change: mean absolute change of that difference from frame to frame, 0–255; an error \
    that is glued to a moving surface changes as well. Worst step: the largest change between two frames. Contour pairs: share of neighbouring \
    pixels with the same transparent surfaces whose errors differ by more than 2 of 255; the mean of all frames that have such pixels. ꟻLIP and MSE in linear light are \
    means over the frames; PSNR of 8-bit sRGB is that of the mean squared error of all.";

impl Measurement for Along {
    const FILES: Files<Self> = &[
        ("path.json", Results::json),
        ("path.csv", |r, _| Ok(csv(&r.measured.rows))),
        ("path-frames.csv", |r, _| Ok(csv(&r.measured.by_frame))),
        ("path.md", |r, _| Ok(r.markdown())),
        ("path-error.svg", |r, _| Ok(r.error_chart().on_white())),
        ("path-change.svg", |r, _| Ok(r.change_chart().on_white())),
        ("report.html", Results::page),
    ];
}

impl Results<Along> {
    /// A line for each method, means over the scenes, the best JOD first.
    pub fn table(&self) -> Table {
        self.table_of(None)
    }

    /// The scenes along which all methods were drawn.
    fn shared(&self) -> BTreeSet<&str> {
        let rows = self.measured.rows.iter();
        rows::shared(rows.map(|r| (r.method.as_str(), r.scene.as_str())))
    }

    /// A sentence where means leave scenes out, because some method lacks them.
    pub fn note(&self) -> Option<String> {
        let all = each_once(self.measured.rows.iter().map(|r| r.scene.as_str())).len();
        let shared = self.shared().len();
        (shared < all).then(|| {
            format!(
                "Means are over {shared} of {all} scenes: some method was left out of the others."
            )
        })
    }

    /// The lines of one scene, or means over those that all methods have.
    fn table_of(&self, scene: Option<&str>) -> Table {
        let shown = scene.map_or_else(|| self.shared(), |scene| BTreeSet::from([scene]));
        let rows = || {
            let all = self.measured.rows.iter();
            all.filter(|r| shown.contains(r.scene.as_str()))
        };
        let mean = |method: &str, value: fn(&PathRow) -> Option<f64>| {
            let own = rows().filter(|r| r.method == method).map(value);
            rows::mean(own.collect::<Option<Vec<f64>>>()?)
        };
        let all = self.measured.rows.iter();
        let own = all.filter(|r| scene.is_none_or(|s| r.scene == s));
        let mut methods = each_once(own.map(|r| r.method.as_str()));
        let jod = |m: &str| mean(m, |r| r.jod).unwrap_or(f64::NEG_INFINITY);
        methods.sort_by(|a, b| jod(b).total_cmp(&jod(a)));
        let worst = |m: &str| {
            let own = rows().filter(|r| r.method == m);
            own.filter_map(|r| r.change_max).reduce(f64::max)
        };
        Table::from_rows(
            &methods,
            &[
                ("method", &|m| (*m).to_owned()),
                ("JOD", &|m| number(mean(m, |r| r.jod), 2)),
                ("error, 0–255", &|m| number(mean(m, |r| Some(r.error)), 3)),
                ("change, 0–255", &|m| number(mean(m, |r| r.change), 3)),
                ("worst step", &|m| number(worst(m), 3)),
                ("contour pairs", &|m| {
                    number(mean(m, |r| r.contour_pairs), 5)
                }),
                ("PSNR dB", &|m| number(mean(m, |r| r.psnr), 1)),
                ("ꟻLIP", &|m| number(mean(m, |r| Some(r.flip)), 4)),
                ("MSE (linear)", &|m| {
                    let mse = mean(m, |r| Some(r.mse_linear));
                    mse.map_or_else(|| "–".to_owned(), |x| format!("{x:.2e}"))
                }),
            ],
        )
    }

    /// A value of every method against the number of the frame, means over the scenes that all have; exact methods have no line.
    fn chart(&self, y: &str, value: fn(&FrameRow) -> Option<f64>) -> Svg {
        let is_exact = |method: &str| {
            let mut own = self.measured.rows.iter().filter(|r| r.method == method);
            own.all(|r| r.mse_linear <= EXACT_MSE)
        };
        let shared = self.shared();
        let line = |method: &&str| {
            let points = (0..self.measured.frames).filter_map(|frame| {
                let all = self.measured.by_frame.iter();
                let all = all.filter(|r| shared.contains(r.scene.as_str()));
                let own = all.filter(|r| r.method == *method && r.frame == frame);
                Some((f64::from(frame), rows::mean(own.filter_map(value))?))
            });
            Line::new(*method, points)
        };
        let rows = self.measured.rows.iter();
        let methods = each_once(rows.map(|r| r.method.as_str()));
        let shown = methods.iter().filter(|m| !is_exact(m));
        let lines: Vec<Line> = shown.map(line).collect();
        line_chart(&lines, "frame", y, Scale::Linear)
    }

    fn error_chart(&self) -> Svg {
        self.chart("mean absolute error, 0–255", |r| Some(r.error))
    }

    fn change_chart(&self) -> Svg {
        let y = "mean absolute change since the frame before, 0–255";
        self.chart(y, |r| r.change)
    }

    fn markdown(&self) -> String {
        let (table, settings) = (self.table().markdown(), self.settings());
        let note = self
            .note()
            .map_or_else(String::new, |note| format!(" {note}"));
        format!("{table}\n{NOTE}{note}\n\n{settings}. {}\n", self.credit())
    }

    fn settings(&self) -> String {
        let Along {
            size: [width, height],
            samples,
            frames,
            fps,
            display,
            ..
        } = &self.measured;
        let samples = if *samples > 1 {
            format!(", {samples} samples a pixel")
        } else {
            String::new()
        };
        format!(
            "{frames} frames of {width}x{height}{samples}, shown at {fps} frames a second on a {display}"
        )
    }

    fn page(&self, folder: &Path) -> Result<String, EvalError> {
        let rows = self.measured.rows.iter();
        let scenes = each_once(rows.map(|r| r.scene.as_str()));
        let body = html! {
            p { "Scenes: " (scenes.len()) ". " (self.settings()) ". The camera moves on an arc, and every object swings." }
            h2 { "All scenes" }
            p.note { (NOTE) @if let Some(note) = self.note() { " " (note) } }
            (self.table().html("sortable", |_| false))
            (page::chart("curve", &self.error_chart()))
            (page::chart("curve", &self.change_chart()))
            h2 { "Scene by scene" }
            @for scene in &scenes { (self.of_scene(scene, folder)?) }
        };
        let title = "Errors along a path";
        Ok(page::page(self, title, body, &[], Some(SORT_SCRIPT)))
    }

    fn of_scene(&self, scene: &str, folder: &Path) -> Result<Markup, EvalError> {
        let table = self.table_of(Some(scene));
        let methods = table.rows.iter().map(|row| row[0].as_str());
        let mut strips = Vec::new();
        for method in std::iter::once(EXACT).chain(methods) {
            let path = folder.join("images").join(image_name(scene, method));
            let caption = if method == EXACT {
                format!("{scene}, exact")
            } else {
                format!(
                    "{method}: error × 8; below, its change since the frame before × 8. Last, the frame of the largest change"
                )
            };
            strips.extend(figure_of(&path, STRIP_WIDTH, &caption)?);
        }
        Ok(html! {
            details {
                summary { (scene) }
                (table.html("sortable", |_| false))
                @for strip in strips { div.strip { (strip) } }
            }
            "\n"
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::testing::{machine, written};

    #[test]
    fn tables_charts_and_strips() {
        let row = |method: &str, scene: &str, jod: f64, mse_linear| PathRow {
            method: method.into(),
            scene: scene.into(),
            mse_linear,
            contour_pairs: Some(jod / 1000.0),
            jod: Some(jod),
            ..PathRow::default()
        };
        let frame = |method: &str, scene: &str, frame, error| FrameRow {
            method: method.into(),
            scene: scene.into(),
            frame,
            error,
            change: (frame > 0).then_some(0.5),
            ..FrameRow::default()
        };
        let along = Along {
            size: [8, 6],
            samples: 4,
            frames: 2,
            rows: vec![
                row("wboit-eq9", "a", 8.0, 1e-3),
                row("depth-peel", "a", 10.0, 0.0),
                row("depth-peel", "<b>", 10.0, 0.0),
                row("wboit-eq9", "<b>", 9.0, 1e-3),
                // No mean is over a scene that the other lacks.
                row("wboit-eq9", "tinted", 1.0, 1.0),
            ],
            by_frame: vec![
                frame("wboit-eq9", "a", 0, 2.0),
                frame("wboit-eq9", "a", 1, 3.0),
                frame("wboit-eq9", "<b>", 1, 5.0),
                // Rounding alone.
                frame("depth-peel", "a", 1, 1e-6),
            ],
            ..Along::default()
        };
        let results = Results::new(machine(), "peelnet bench path", along);
        let table = results.table();
        assert_eq!(table.rows[0][..2], ["depth-peel", "10.00"]);
        assert_eq!(table.rows[1][..2], ["wboit-eq9", "8.50"]);
        let one = results.table_of(Some("<b>"));
        assert_eq!((one.rows.len(), one.rows[1][1].as_str()), (2, "9.00"));
        assert_eq!([&table.rows[1][5], &one.rows[1][5]], ["0.00850", "0.00900"]);
        assert!(results.markdown().contains("2 of 3 scenes"));
        let folder = tempfile::tempdir().unwrap();
        let images = folder.path().join("images");
        std::fs::create_dir(&images).unwrap();
        for method in [EXACT, "wboit-eq9"] {
            let path = images.join(image_name("a", method));
            image::RgbImage::new(8, 8).save(path).unwrap();
        }
        let page = written(folder.path(), &results);
        assert_eq!(page.matches("data:image/png").count(), 2);
        assert!(page.contains("4 samples a pixel") && page.contains("&lt;b&gt;"));
        assert!(!page.contains("<b>"));
        let chart = results.error_chart();
        assert!(chart.as_str().contains("wboit-eq9") && !chart.as_str().contains("depth-peel"));
    }
}
