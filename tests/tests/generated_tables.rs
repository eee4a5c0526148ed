//! Tables in the documents are those of the committed results and of the code.
//!
//! `<!-- table of FILE | column; … | row; … -->` and `<!-- end of table -->` enclose columns of FILE's first table, in the order given,
//! and of its rows those whose first cell is listed, or all where the third part is absent. `column @ MACHINE` is that of the same file of
//! another machine. `PEELNET_UPDATE=1` writes them again.
//! `<!-- table of columns -->` and `<!-- end of table -->` enclose a list of the columns of [`peelnet_dataset::Column`];
//! with `effects` the table of [`peelnet_scene::EFFECTS`].

use peelnet_scene::{EFFECTS, Effect};
use std::{
    fs,
    path::{Path, PathBuf},
};

const PAGES: [&str; 4] = [
    "README.md",
    "docs/benchmarks.md",
    "docs/effects.md",
    "docs/python.md",
];
const BEGIN: &str = "<!-- table of ";
const END: &str = "<!-- end of table -->";

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
}

fn read(name: &str) -> String {
    fs::read_to_string(path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn cells(line: &str) -> Vec<&str> {
    let inner = line.trim().trim_matches('|');
    inner.split('|').map(str::trim).collect()
}

/// The table of effects.
fn effects() -> String {
    let row = |e: &Effect| format!("| `{}` | {} | {} |\n", e.name, e.needed_by, e.adds);
    let rows: String = EFFECTS.iter().map(row).collect();
    format!("| effect | needed by | adds |\n|---|---|---|\n{rows}")
}

/// The table that a marker's text, without its brackets, asks for.
fn table(marker: &str) -> String {
    if marker == "columns" {
        return format!("\n{}\n", peelnet_dataset::column_docs!());
    }
    if marker == "effects" {
        return effects();
    }
    let parts: Vec<&str> = marker.split(" | ").map(str::trim).collect();
    let file = parts[0];
    let columns: Vec<Column> = parts[1].split("; ").map(|c| column(file, c)).collect();
    let names: Vec<String> = match parts.get(2) {
        None => columns[0].cells[2..].iter().map(|c| c.0.clone()).collect(),
        Some(names) => names.split("; ").map(str::to_owned).collect(),
    };
    let line = |cell: &dyn Fn(&Column) -> String| {
        let cells: Vec<String> = columns.iter().map(cell).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let mut out = line(&|c| c.title.clone()) + &line(&|c| c.cells[1].1.clone());
    for name in names {
        out += &line(&|c| {
            let found = c.cells[2..].iter().find(|cell| cell.0 == name);
            let missing = || panic!("{file}, {}: no row {name:?}", c.title);
            found.unwrap_or_else(missing).1.clone()
        });
    }
    out
}

/// A column of a table: its title, and of every line the first cell and the column's, the heading and its rule among them.
struct Column {
    title: String,
    cells: Vec<(String, String)>,
}

fn column(file: &str, text: &str) -> Column {
    let (name, file) = match text.split_once(" @ ") {
        None => (text, file.to_owned()),
        Some((name, machine)) => {
            let own = file.split('/').nth(2).expect("docs/results/MACHINE/…");
            (name, file.replace(own, machine))
        }
    };
    let page = read(&file);
    let lines = page.lines().skip_while(|line| !line.starts_with('|'));
    let lines = lines.take_while(|line| line.starts_with('|')).map(cells);
    let lines: Vec<Vec<&str>> = lines.collect();
    let place = lines[0].iter().position(|cell| *cell == name);
    let place = place.unwrap_or_else(|| panic!("{file}: no column {name:?}"));
    let cell = |cells: &Vec<&str>| (cells[0].to_owned(), cells[place].to_owned());
    Column {
        title: text.replace(" @ ", ", "),
        cells: lines.iter().map(cell).collect(),
    }
}

/// A page with every table made again, and how many there are.
fn regenerate(page: &str) -> (String, usize) {
    let mut out = String::new();
    let mut rest = page;
    let mut tables = 0;
    while let Some((before, after)) = rest.split_once(BEGIN) {
        let (marker, after) = after.split_once(" -->\n").expect("the end of a marker");
        let (_, after) = after.split_once(END).expect("the end of a table");
        out += &format!("{before}{BEGIN}{marker} -->\n{}{END}", table(marker));
        rest = after;
        tables += 1;
    }
    (out + rest, tables)
}

#[test]
fn tables_of_pages_are_those_of_the_results() {
    for name in PAGES {
        let page = read(name);
        let (want, tables) = regenerate(&page);
        assert!(tables > 0, "{name} has no table");
        if std::env::var_os("PEELNET_UPDATE").is_some() {
            fs::write(path(name), want).unwrap();
        } else {
            let hint = "PEELNET_UPDATE=1 writes its tables again";
            assert!(page == want, "{name}: {hint}");
        }
    }
}
