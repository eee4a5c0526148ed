//! The files of `peelnet bench effects`: what effects cost, what they look like, and what shading one layer saves.

use crate::EvalError;
use crate::chart::{Line, Scale, Svg, line_chart};
use crate::effects::{Cost, Effects, FILLED, Fill, LayerCost, Parts, picture_of};
use crate::report::{Files, Measurement, Results, Table, page, picture::figure_of};
use maud::{Markup, html};
use std::path::Path;

const PICTURE_WIDTH: u32 = 320;

/// Title of the table of layers, which has a chart.
const LAYERS: &str = "One layer shaded, or all";

/// A table with its title and what its columns mean.
type Section = (&'static str, &'static str, Table);

impl Measurement for Effects {
    const FILES: Files<Self> = &[
        ("effects.json", Results::json),
        ("effects.md", |r, _| Ok(r.markdown())),
        ("effects-layers.svg", |r, _| {
            let layers = &r.measured.layers;
            let chart = (!layers.is_empty()).then(|| r.layer_chart().on_white());
            Ok(chart.unwrap_or_default())
        }),
        ("report.html", Results::page),
    ];
}

impl Results<Effects> {
    pub fn tables(&self) -> Vec<Section> {
        let bytes = |c: &Cost| match (c.bytes_with, c.bytes_without) {
            (with, without) if with == without => format!("{with:.0}"),
            (with, without) => format!("{with:.0}, without {without:.0}"),
        };
        let costs = Table::from_rows(
            &self.measured.costs,
            &[
                ("scene", &|c| c.scene.clone()),
                ("effect", &|c| c.effect.clone()),
                ("with, ms", &|c| two(c.ms_with)),
                ("without, ms", &|c| two(c.ms_without)),
                ("time with / without", &|c| two(c.ratio)),
                ("bytes a pixel", &bytes),
            ],
        );
        let alone = |ms: f64, p: &Parts| two(ms / p.ms_both);
        let parts = Table::from_rows(
            &self.measured.parts,
            &[
                ("scene", &|p| p.scene.clone()),
                ("both, ms", &|p| two(p.ms_both)),
                ("shading alone / both", &|p| alone(p.ms_shading, p)),
                ("transparency alone / both", &|p| {
                    alone(p.ms_transparency, p)
                }),
            ],
        );
        let layers = Table::from_rows(
            &self.measured.layers,
            &[
                ("scene", &|l| l.scene.clone()),
                ("layers", &|l| l.layers.to_string()),
                ("one shaded, ms", &|l| two(l.ms_one)),
                ("all shaded, ms", &|l| two(l.ms_all)),
                ("one / all", &|l| two(l.ratio)),
            ],
        );
        let all: [Section; 4] = [
            (
                "What each effect costs",
                "Time of a frame of the scene as it is, over that of the same scene without the effect. Both are drawn in turn in one run.",
                costs,
            ),
            (
                "Shading and transparency, each alone",
                "Times relative to the frame as it is, all drawn in turn. Shading alone: every surface is opaque, with all effects. Transparency \
                 alone: every surface is unlit, and as transparent as before.",
                parts,
            ),
            (
                LAYERS,
                "The view of layers with physically based shading of the highlighted layer alone, against shading all layers.",
                layers,
            ),
            (
                "Triangles and the part of the frame filled",
                "The view of layers with one layer shaded: times relative to the fewest triangles at half of the frame; then times relative to \
                 shading all layers.",
                self.fill_table(),
            ),
        ];
        let filled = all.into_iter().filter(|(.., table)| !table.rows.is_empty());
        filled.collect()
    }

    /// Triangles against the part of the frame filled: times relative to the scene's first cell.
    fn fill_table(&self) -> Table {
        let mut headings = vec!["scene".to_owned(), "triangles".to_owned()];
        headings.extend(FILLED.map(|part| format!("{:.0} % filled", part * 100.0)));
        headings.extend(FILLED.map(|part| format!("{:.0} %, one / all", part * 100.0)));
        let fills = &self.measured.fills;
        let line = |row: &[Fill]| {
            let of_scene = |f: &&Fill| f.scene == row[0].scene;
            let first = fills.iter().find(of_scene).map_or(1.0, |f| f.ms_one);
            let mut cells = vec![row[0].scene.clone(), row[0].triangles.to_string()];
            cells.extend(row.iter().map(|f| two(f.ms_one / first)));
            cells.extend(row.iter().map(|f| two(f.ms_one / f.ms_all)));
            cells
        };
        Table::new(headings, fills.chunks(FILLED.len()).map(line))
    }

    fn layer_chart(&self) -> Svg {
        let line = |name: &str, ms: fn(&LayerCost) -> f64| {
            let layers = self.measured.layers.iter();
            Line::new(name, layers.map(|l| (f64::from(l.layers), ms(l))))
        };
        let lines = [
            line("all layers shaded", |l| l.ms_all),
            line("one layer shaded", |l| l.ms_one),
        ];
        line_chart(&lines, "layers", "frame time, ms", Scale::Logarithmic)
    }

    fn settings(&self) -> String {
        let ([width, height], frames) = (self.measured.size, self.measured.frames);
        format!("{width}x{height}, medians of {frames} frames drawn in turn")
    }

    fn markdown(&self) -> String {
        let mut tables = String::new();
        for (title, note, table) in self.tables() {
            tables += &format!("## {title}\n\n{note}\n\n{}\n", table.markdown());
        }
        format!(
            "{tables}`{}`, {}. {}\n",
            self.measured.method,
            self.settings(),
            self.credit()
        )
    }

    fn page(&self, folder: &Path) -> Result<String, EvalError> {
        let body = html! {
            p { (self.measured.method) " at " (self.settings()) "." }
            @for (title, note, table) in self.tables() {
                h2 { (title) }
                p.note { (note) }
                (table.html("", |_| false))
                @if title == LAYERS { (page::chart("curve", &self.layer_chart())) }
            }
            h2 { "With and without" }
            @for cost in &self.measured.costs { (pair(cost, folder)?) }
        };
        Ok(page::page(self, "What effects cost", body, &[], None))
    }
}

fn two(x: f64) -> String {
    format!("{x:.2}")
}

fn pair(cost: &Cost, folder: &Path) -> Result<Markup, EvalError> {
    let mut figures = Vec::new();
    for (on, word) in [(true, "with"), (false, "without")] {
        let path = picture_of(folder, &cost.scene, &cost.effect, on);
        let caption = format!("{word} {}", cost.effect);
        figures.extend(figure_of(&path, PICTURE_WIDTH, &caption)?);
    }
    Ok(html! {
        @if !figures.is_empty() {
            h3 { (cost.scene) ": " (cost.effect) ", " (two(cost.ratio)) " times the time" }
            div.gallery { @for figure in figures { (figure) } }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::testing::{machine, written};

    /// Ratios are those of the times, and the table of triangles counts from its first cell.
    #[test]
    fn tables_are_ratios() {
        let layer = |layers, ms_one: f64, ms_all| LayerCost {
            layers,
            ms_one,
            ms_all,
            ratio: ms_one / ms_all,
            ..LayerCost::default()
        };
        let fill = |filled, ms_one| Fill {
            filled,
            ms_one,
            ms_all: 4.0,
            ..Fill::default()
        };
        let effects = Effects {
            costs: vec![Cost {
                ratio: 1.5,
                bytes_with: 10.0,
                bytes_without: 8.0,
                ..Cost::default()
            }],
            parts: vec![Parts {
                ms_both: 4.0,
                ms_shading: 3.0,
                ms_transparency: 2.0,
                ..Parts::default()
            }],
            layers: vec![layer(3, 2.0, 4.0), layer(6, 3.0, 9.0)],
            fills: vec![fill(0.5, 2.0), fill(0.75, 3.0), fill(1.0, 4.0)],
            ..Effects::default()
        };
        let results = Results::new(machine(), "peelnet bench effects", effects);
        let tables = results.tables().into_iter().map(|(.., table)| table);
        let [effects, parts, layers, fills] = tables.collect::<Vec<_>>().try_into().unwrap();
        assert_eq!(effects.rows[0][4..], ["1.50", "10, without 8"]);
        assert_eq!(parts.rows[0][2..], ["0.75", "0.50"]);
        assert_eq!(layers.rows[1][4], "0.33");
        let filled = ["1.00", "1.50", "2.00", "0.50", "0.75", "1.00"];
        assert_eq!(fills.rows[0][2..], filled);
        let folder = tempfile::tempdir().unwrap();
        let page = written(folder.path(), &results);
        assert!(page.contains("0.33") && page.contains("one layer shaded"));
    }
}
