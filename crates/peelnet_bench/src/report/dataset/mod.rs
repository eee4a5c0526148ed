//! The page of `peelnet inspect DATASET --html`: what the manifest says, statistics, pictures made of the rows, and the rows of a pixel.

mod grid;

use crate::EvalError;
use crate::report::{Table, page, picture::data_uri};
pub use grid::{Grid, Pixel};
use grid::{MOST_READ, SIDE};
use image::DynamicImage;
use maud::{Markup, PreEscaped, html};
use peelnet_core::files::{counted, one_line, printable, thousands};
use peelnet_dataset::{
    Column, ColumnKind, ColumnStatistics, Dataset, Manifest, Part, Summary, rounded, summary::Bin,
};

/// Views with a picture; among them, first views of scenes with their pixels' rows, and the rows of all those together.
const MOST_PICTURES: usize = 24;
const MOST_POINTED: usize = 4;
const MOST_ROWS: usize = 120_000;

/// Scenes that are listed.
const MOST_SCENES: usize = 200;

/// Pointing at a picture shows its pixel's rows.
const SCRIPT: &str = include_str!("pixels.js");

/// A page about a dataset, of which `summary` was read. Of the rows it reads only those of some views.
///
/// # Errors
/// Rows that cannot be read.
pub fn dataset_page(dataset: &Dataset, summary: &Summary) -> Result<String, EvalError> {
    let m = dataset.manifest();
    // First views of scenes, then the others: a stable sort keeps their order.
    let mut parts: Vec<&Part> = m.parts.iter().filter(|part| part.rows > 0).collect();
    parts.sort_by_key(|part| (part.copy, part.view));
    let (with_rows, shown) = (parts.len(), parts.len().min(MOST_PICTURES));
    let is_pointed = |part: &&&Part| part.copy == 0 && part.view == 0;
    let pointed = parts.iter().take(MOST_POINTED).take_while(is_pointed);
    // Of scenes that are seen in later views only, the first one.
    let pointed = pointed.count().max(1).min(shown);
    let (mut tables, mut others, mut cut) = (Vec::new(), Vec::new(), 0);
    for (k, part) in parts.into_iter().take(shown).enumerate() {
        let mut grid = Grid::read(dataset, part)?;
        cut += u64::from(grid.rows_read < part.rows);
        let name = caption(m, part);
        if k < pointed {
            grid.reduce(MOST_ROWS / pointed);
            tables.push(with_pixels(&grid, &name)?);
        } else {
            let uri = uri_of(&grid)?;
            others.push(
                html! { figure { img.cells src=(uri) alt=(name); figcaption { (name) } } "\n" },
            );
        }
    }
    let body = html! {
        p {
            (counted(m.rows, "row")) " of " (counted(m.pixels, "pixel")) " in " (counted(m.parts.len() as u64, "part")) ". A row is one fragment: \
            a transparent surface at one pixel of one view."
        }
        h2 { "Pixels and their rows" }
        p.note {
            "Pictures are composited from the rows over white, because a dataset has neither background nor opaque surfaces. They have at most "
            (SIDE) " by " (SIDE) " cells; a cell shows one pixel of the dataset, the first one in it that has rows. Pictures: " (shown) " of "
            (with_rows) " views that have rows. "
            @if m.pixels_fraction < 1.0 { "The dataset has " (rounded(100.0 * m.pixels_fraction)) " % of the pixels. " }
            @if cut > 0 { "Of " (counted(cut, "view")) " only the first " (thousands(MOST_READ)) " rows were read. " }
            @if pointed > 0 {
                "This page has rows of " (counted(pointed as u64, "picture")) ", at most " (thousands(MOST_ROWS as u64)) " in all; with more, cells are larger. \
                 Point at such a picture to see the rows of a pixel, from the nearest to the farthest, and click to keep them."
            }
        }
        @for table in tables { (table) }
        @if !others.is_empty() { h3 { "Other views" } div.gallery { @for figure in others { (figure) } } }
        h2 { "Scenes" }
        (scenes(m).html("text", |_| false))
        @if m.scenes.len() > MOST_SCENES { p.note { "The first " (MOST_SCENES) " of " (m.scenes.len()) "." } }
        h2 { "Columns" }
        (columns(m, summary).html("text", |_| false))
        h2 { "Histograms" }
        div.gallery {
            (page::histogram("pixels by their number of fragments", &summary.fragments_per_pixel, "pixels"))
            (page::histogram("rows by alpha", &summary.alpha, "rows"))
            @for s in m.statistics.iter().take(Column::ALL.len()) { (page::histogram(&printable(&s.name), &bins(s), "rows")) }
        }
        p.note {
            @if m.statistics.is_empty() { "This dataset has no statistics of its columns: it is empty or of an earlier version." }
            @else { "Of all rows, held-out scenes among them. Bins of columns from 0 to 1 have equal widths, edges of the others are powers of two." }
        }
        h2 { "Checks" }
        p.note { "All rows were read, and what follows from other rows was computed again." }
        (checks(summary).html("text", |_| false))
        h2 { "How it was made" }
        p { code { (one_line(&m.command)) } }
        (made(m).html("text", |_| false))
    };
    let title = "A dataset of fragments";
    Ok(page::plain_page(title, body, Some(SCRIPT)))
}

/// A view in words.
pub fn caption(m: &Manifest, part: &Part) -> String {
    let scene = printable(&m.scenes[part.scene as usize].name);
    let copy = match part.copy {
        0 => String::new(),
        copy => format!(", varied copy {copy}"),
    };
    let rows = counted(part.rows, "row");
    format!(
        "{scene}, view {}{copy}: {rows}, {}x{}",
        part.view, part.width, part.height
    )
}

fn uri_of(grid: &Grid) -> Result<String, EvalError> {
    let image = DynamicImage::ImageRgb8(grid.image());
    data_uri("in memory".as_ref(), &image, SIDE)
}

/// A picture beside the rows of its deepest pixel; with the script, of the one that is pointed at.
fn with_pixels(grid: &Grid, name: &str) -> Result<Markup, EvalError> {
    let uri = uri_of(grid)?;
    let (table, title) = match grid.deepest() {
        Some(pixel) => (pixel.table(), pixel.title()),
        None => Default::default(),
    };
    Ok(html! {
        h3 { (name) }
        div.pixels {
            div.picture { img src=(uri) alt=(name); div.mark hidden {} }
            div.rows {
                p { b.which { (title) } span.note { " (the most of those shown)" } }
                (table.html("", |_| false))
            }
            // Numbers alone.
            script type="application/json" { (PreEscaped(grid.json())) }
        }
        "\n"
    })
}

fn scenes(m: &Manifest) -> Table {
    let (rows, scene) = (m.rows_by_scene(), |k: &usize| &m.scenes[*k]);
    let shown: Vec<usize> = (0..m.scenes.len().min(MOST_SCENES)).collect();
    Table::from_rows(
        &shown,
        &[
            ("scene", &|k| printable(&scene(k).name).into_owned()),
            ("parts", &|k| {
                let parts = m.parts.iter().filter(|part| part.scene as usize == *k);
                thousands(parts.count() as u64)
            }),
            ("rows", &|k| {
                thousands(rows.get(&*scene(k).name).copied().unwrap_or(0))
            }),
            ("held out", &|k| {
                ["no", "yes"][usize::from(scene(k).held_out)].to_owned()
            }),
            ("effects", &|k| scene(k).effects.join(", ")),
            ("file", &|k| scene(k).file.clone()),
        ],
    )
}

fn columns(m: &Manifest, summary: &Summary) -> Table {
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), rounded);
    let range = |c: &Column| summary.columns.get(*c as usize);
    let of_all = |c: &Column| m.statistics.get(*c as usize);
    Table::from_rows(
        &Column::ALL,
        &[
            ("column", &|c| c.to_string()),
            ("unit", &|c| c.unit().to_owned()),
            ("meaning", &|c| c.meaning().to_owned()),
            ("minimum", &|c| number(range(c).map(|r| r.min))),
            ("maximum", &|c| number(range(c).map(|r| r.max))),
            ("mean", &|c| number(of_all(c).map(|s| s.mean))),
            ("standard deviation", &|c| {
                number(of_all(c).map(|s| s.deviation))
            }),
        ],
    )
}

/// The bins of a column, for integers without those between 0 and 1. A manifest can hold any edges and counts.
fn bins(s: &ColumnStatistics) -> Vec<Bin> {
    let column = Column::from_name(&s.name).map(Column::kind);
    let is_integer = column == Some(ColumnKind::U32);
    let bins = s.edges.windows(2).zip(&s.counts);
    let bin = |(edges, &count): (&[f64], &u64)| Bin {
        from: edges[0],
        to: edges[1].max(if is_integer { 1.0 } else { edges[1] }),
        count,
    };
    let is_between = |bin: &Bin| is_integer && bin.from > 0.0 && bin.from < 1.0;
    bins.map(bin).filter(|bin| !is_between(bin)).collect()
}

fn checks(summary: &Summary) -> Table {
    Table::from_rows(
        &summary.checks,
        &[
            ("column", &|check| check.name.clone()),
            ("property", &|check| check.formula.clone()),
            ("result", &|check| match check.violations {
                0 => "holds".to_owned(),
                n => format!("violated by {}", counted(n, "row")),
            }),
        ],
    )
}

fn made(m: &Manifest) -> Table {
    let files = m.parts.iter().flat_map(|part| &part.files);
    let bytes = files.fold(0u64, |sum, file| sum.saturating_add(file.bytes));
    let known = [
        ("version", m.tool_version.clone()),
        ("adapter", m.adapter.clone()),
        ("peeling", m.peel.clone()),
        ("seed", m.seed.to_string()),
        ("fraction of the pixels", m.pixels_fraction.to_string()),
        ("varied copies of each scene", m.augment.to_string()),
        (
            "format",
            format!("{}, {}", m.format, counted(bytes, "byte")),
        ),
        ("left out by peeling", counted(m.lost_fragments, "fragment")),
        ("at one depth", counted(m.coplanar_ties, "pair")),
        ("hash of the rows", m.hash.clone()),
    ];
    let settings = m.settings.iter();
    let settings = settings.map(|(name, value)| (name.as_str(), value.clone()));
    let lines = known.into_iter().chain(settings);
    let lines = lines.map(|line| {
        [line.0, &line.1]
            .map(|text| printable(text).into_owned())
            .to_vec()
    });
    Table::new(["property", "value"], lines)
}
