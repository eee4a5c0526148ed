//! Every figure in the documents comes from a committed row, or stands beside the command that measures it.
//!
//! `0.16<!-- =error deep-medium / mboit4 -->` is a number and the query that gives it from `docs/results`. The tests compare them, and find
//! numbers that have neither a query nor a command in their paragraph. `PEELNET_UPDATE=1` writes the numbers anew.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_eval::{Row, bench::Bench, front::EXACT_MSE, geometric_mean, methods_of, scenes_of};
use peelnet_report::Results;
use peelnet_tests::results;
use std::{collections::BTreeSet, fs, path::PathBuf};

/// The pages that show figures.
const PAGES: [&str; 9] = [
    "README.md",
    "data/README.md",
    "models/README.md",
    "docs/benchmarks.md",
    "docs/effects.md",
    "docs/learned-weights.md",
    "docs/limits.md",
    "docs/numerics.md",
    "docs/robustness.md",
];

/// Paragraphs whose numbers are no measurements, by how they begin, and what their numbers are.
const DEFINITIONS: &[(&str, &str, &str)] = &[
    ("data/README.md", "| scene | what |", "opacities of scenes"),
    (
        "docs/benchmarks.md",
        "All figures come from two machines",
        "a version",
    ),
    (
        "docs/benchmarks.md",
        "| | α | T in front |",
        "computed by hand",
    ),
    (
        "docs/benchmarks.md",
        "The exact colour is",
        "computed by hand",
    ),
    (
        "docs/benchmarks.md",
        "| method | published or shipped |",
        "constants of methods",
    ),
    (
        "docs/benchmarks.md",
        "Papakostas (Ioannina 2022)",
        "the opacity of a scene",
    ),
    (
        "docs/effects.md",
        "The GGX distribution",
        "a constant of the shading",
    ),
    (
        "docs/learned-weights.md",
        "`anchored-small` and `anchored-medium` need",
        "a published constant",
    ),
    (
        "docs/learned-weights.md",
        "- Of the 21.5 million",
        "how much is trained on",
    ),
    (
        "docs/learned-weights.md",
        "- `nmt` divides zero",
        "a published constant",
    ),
    (
        "docs/learned-weights.md",
        "- Without the known ends",
        "networks that were not kept, as the page says",
    ),
    ("docs/limits.md", "SIGINT (Ctrl-C)", "a limit"),
    (
        "docs/numerics.md",
        "- **T in R8**",
        "from the formula beside it",
    ),
    (
        "docs/numerics.md",
        "- **T in R16F**",
        "from the formula beside it",
    ),
    (
        "docs/numerics.md",
        "- **Sums in RGBA16F**",
        "from the formula beside it",
    ),
    (
        "docs/numerics.md",
        "How many layers until",
        "from the formula beside it",
    ),
    (
        "docs/robustness.md",
        "Transparency code breaks",
        "an opacity",
    ),
];

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join(name)
}

fn read(name: &str) -> String {
    fs::read_to_string(path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// What queries read.
struct Committed {
    rows: Vec<Row>,
    stress: Vec<Vec<String>>,
}

impl Committed {
    fn load() -> Self {
        let held_out: Results<Bench> =
            serde_json::from_str(&read(&format!("{}/results.json", results("held-out")))).unwrap();
        let stress = read(&format!("{}/stress.csv", results("stress")));
        // A method's name may hold commas and is quoted then.
        let fields = |line: &str| -> Vec<String> {
            let quoted = line.strip_prefix('"').and_then(|l| l.split_once("\","));
            let (method, rest) = quoted.or_else(|| line.split_once(',')).unwrap();
            let rest = rest.split(',').map(str::to_owned);
            std::iter::once(method.to_owned()).chain(rest).collect()
        };
        Self {
            rows: held_out.measured.rows,
            stress: stress.lines().map(fields).collect(),
        }
    }

    /// The rows of a method, of one scene or all.
    fn of(&self, method: &str, scene: Option<&str>) -> Vec<&Row> {
        let rows: Vec<_> = self
            .rows
            .iter()
            .filter(|r| r.method == method && scene.is_none_or(|s| r.scene == s))
            .collect();
        assert!(!rows.is_empty(), "no rows of {method} on {scene:?}");
        rows
    }

    /// Geometric mean of a value over a method's rows.
    fn mean(&self, method: &str, scene: Option<&str>, value: impl Fn(&Row) -> f64) -> f64 {
        geometric_mean(self.of(method, scene).into_iter().map(value)).unwrap()
    }

    /// `A / B`, and the scene behind it where one stands there.
    fn ratio(&self, words: &[&str], value: impl Fn(&Row) -> f64) -> f64 {
        let &[a, "/", b, ref scene @ ..] = words else {
            panic!("{words:?}: expected A / B");
        };
        let scene = scene.first().copied();
        self.mean(a, scene, &value) / self.mean(b, scene, &value)
    }

    /// The largest ratio of the mean errors on one scene.
    fn worst(&self, words: &[&str]) -> f64 {
        let &[a, "/", b] = words else {
            panic!("{words:?}: expected A / B");
        };
        let error = |method: &str, scene: &str| {
            self.of(method, Some(scene))
                .iter()
                .map(|r| r.mse_linear)
                .sum::<f64>()
        };
        let ratios = scenes_of(&self.rows)
            .into_iter()
            .map(|s| error(a, s) / error(b, s));
        ratios.fold(0.0, f64::max)
    }

    fn stress(&self, what: &str) -> f64 {
        let header = &self.stress[0];
        let column = |name: &str| header.iter().position(|h| h == name).unwrap();
        let rows = &self.stress[1..];
        let with = |outcome: &str| {
            let place = column("result");
            rows.iter().filter(|r| r[place] == outcome).count()
        };
        let different = |name: &str| {
            let place = column(name);
            rows.iter()
                .map(|r| &r[place])
                .collect::<BTreeSet<_>>()
                .len()
        };
        let count = match what {
            "cases" => different("case"),
            "properties" => different("property"),
            "methods" => different("method"),
            outcome => with(outcome),
        };
        count as f64
    }

    fn value(&self, query: &str) -> f64 {
        let words: Vec<&str> = query.split_whitespace().collect();
        let time = |r: &Row| {
            r.time_ms
                .unwrap_or_else(|| panic!("{} is not timed", r.method))
        };
        let bytes = |method: &str| -> Vec<f64> {
            let mut all: Vec<f64> = self
                .of(method, None)
                .iter()
                .filter_map(|r| r.bytes_per_pixel)
                .collect();
            all.sort_by(f64::total_cmp);
            all
        };
        let error = |r: &Row| r.mse_linear.max(EXACT_MSE);
        match words[..] {
            ["error", method] => self.mean(method, None, error),
            ["error", ref rest @ ..] => self.ratio(rest, error),
            ["worst", ref rest @ ..] => self.worst(rest),
            ["time", ref rest @ ..] => self.ratio(rest, time),
            ["mse255", method, scene] => {
                let rows = self.of(method, Some(scene));
                rows.iter().map(|r| r.mse255).sum::<f64>() / rows.len() as f64
            }
            ["bytes", method] => bytes(method).last().copied().unwrap(),
            ["bytes", method, "mean"] => {
                let all = bytes(method);
                all.iter().sum::<f64>() / all.len() as f64
            }
            ["held-out", "scenes"] => scenes_of(&self.rows).len() as f64,
            ["held-out", "settings"] => methods_of(&self.rows).len() as f64,
            ["stress", what] => self.stress(what),
            ["path", field, method] => path_mean(method, field),
            ["path", field, method, "-", other] => {
                path_mean(method, field) - path_mean(other, field)
            }
            ["path", field, method, "/", other, below] => {
                path_mean(method, field) / path_mean(other, below)
            }
            ["json", file, pointer] => json(file, pointer),
            ["json", file, pointer, "/", other, below] => json(file, pointer) / json(other, below),
            _ => panic!("no such query: {query}"),
        }
    }
}

/// Mean over the scenes of a field along the committed path.
fn path_mean(method: &str, field: &str) -> f64 {
    let text = read(&format!("{}/path.json", results("path")));
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let rows = value["rows"].as_array().unwrap();
    let found: Vec<f64> = rows
        .iter()
        .filter(|r| r["method"] == method)
        .map(|r| r[field].as_f64().unwrap())
        .collect();
    assert!(!found.is_empty(), "no path of {method}");
    found.iter().sum::<f64>() / found.len() as f64
}

/// A number in a committed file.
fn json(file: &str, pointer: &str) -> f64 {
    let text = match file.split_once('/') {
        Some((step, name)) => read(&format!("{}/{name}", results(step))),
        None => read(&(results("") + file)),
    };
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let found = value.pointer(pointer).and_then(serde_json::Value::as_f64);
    found.unwrap_or_else(|| panic!("{file} has no number at {pointer}"))
}

/// A number as it stands in front of a query: the same decimals, and commas between thousands.
fn shown(value: f64, like: &str) -> String {
    let decimals = like.split_once('.').map_or(0, |(_, after)| after.len());
    let text = format!("{value:.decimals$}");
    let (whole, rest) = text.split_at(text.find('.').unwrap_or(text.len()));
    let mut grouped = String::new();
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i) % 3 == 0 {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped + rest
}

const OPEN: &str = "<!-- =";

/// A page with every queried number as the rows have it.
fn renewed(page: &str, committed: &Committed) -> String {
    let mut out = String::new();
    let mut rest = page;
    while let Some(at) = rest.find(OPEN) {
        let (before, after) = rest.split_at(at);
        let (query, behind) = after[OPEN.len()..]
            .split_once("-->")
            .expect("the end of a query");
        let is_number = |c: char| c.is_ascii_digit() || c == '.' || c == ',';
        let text = before.trim_end_matches(is_number);
        let number = &before[text.len()..];
        assert!(!number.is_empty(), "no number in front of {query}");
        out += text;
        out += &shown(committed.value(query.trim()), number);
        out += &format!("{OPEN}{query}-->");
        rest = behind;
    }
    out + rest
}

#[test]
fn figures_with_a_query_are_those_of_the_rows() {
    let committed = Committed::load();
    let mut queries = 0;
    for name in PAGES {
        let page = read(name);
        queries += page.matches(OPEN).count();
        let want = renewed(&page, &committed);
        if std::env::var_os("PEELNET_UPDATE").is_some() {
            fs::write(path(name), want).unwrap();
            continue;
        }
        for (is, should) in page.lines().zip(want.lines()) {
            assert_eq!(is, should, "{name}: PEELNET_UPDATE=1 writes it anew");
        }
    }
    assert!(queries > 10, "{queries}");
}

/// Paragraphs, list items and tables of a page, without code, generated blocks, and comments.
fn blocks(page: &str) -> Vec<String> {
    let mut blocks = vec![String::new()];
    let (mut code, mut generated) = (false, false);
    for line in page.lines() {
        if line.starts_with("```") {
            code = !code;
        }
        if line.ends_with(":begin -->") || line.starts_with("<!-- description of") {
            generated = true;
        }
        if line.ends_with(":end -->") || line == "<!-- end of description -->" {
            generated = false;
        }
        let ends = line.trim().is_empty() || line.starts_with('#') || line.starts_with("- ");
        if ends {
            blocks.push(String::new());
        }
        if !(code || generated || line.starts_with("    ")) {
            let last = blocks.last_mut().unwrap();
            *last += line;
            *last += "\n";
        }
    }
    blocks.retain(|b| !b.trim().is_empty());
    blocks
}

/// The numbers of a paragraph that read like measurements: with a decimal point, or before `times` and `%`; those with a query are none.
fn figures(block: &str) -> Vec<String> {
    let mut found = Vec::new();
    let bytes = block.as_bytes();
    let mut i = 0;
    // Names in backticks hold numbers too.
    let mut named = false;
    while i < bytes.len() {
        // Queries and marks.
        if bytes[i..].starts_with(b"<!--") {
            i += block[i..].find("-->").unwrap_or(0) + 3;
            continue;
        }
        if bytes[i] == b'`' {
            named = !named;
        }
        let starts = bytes[i].is_ascii_digit()
            && (i == 0
                || !(bytes[i - 1].is_ascii_alphanumeric() || b"._-(/".contains(&bytes[i - 1])));
        if named || !starts {
            i += 1;
            continue;
        }
        let length = block[i..]
            .find(|c: char| !(c.is_ascii_digit() || c == '.' || c == ','))
            .unwrap_or(block.len() - i);
        let number = block[i..i + length].trim_end_matches(['.', ',']);
        let after = &block[i + length..];
        let measured = number.contains('.')
            || [" times", " %", "%", " ×"]
                .iter()
                .any(|s| after.starts_with(s));
        if measured && !after.starts_with(OPEN) {
            found.push(number.to_owned());
        }
        i += length;
    }
    found
}

/// Whether a paragraph names the command that measures what it says, or the file of its rows.
fn names_its_source(block: &str) -> bool {
    let starts = [
        "`peelnet ",
        "`cargo ",
        "`python3 ",
        "`/usr/bin/time ",
        "`PROPTEST_CASES",
    ];
    starts.iter().any(|s| block.contains(s))
}

#[test]
fn figures_have_a_query_or_a_command() {
    let mut missing = String::new();
    for name in PAGES {
        let page = read(name);
        let all = blocks(&page);
        for (i, block) in all.iter().enumerate() {
            let figures = figures(block);
            let defined = DEFINITIONS
                .iter()
                .any(|(page, begins, _)| *page == name && block.trim_start().starts_with(begins));
            // A table's command may stand below it, a list's above.
            let beside = [i.checked_sub(1), Some(i), Some(i + 1)];
            let beside = beside.into_iter().flatten().filter_map(|i| all.get(i));
            let named = beside.into_iter().any(|b| names_its_source(b));
            if !(figures.is_empty() || defined || named) {
                let start: String = block.chars().take(70).collect();
                missing += &format!("{name}: {figures:?} in {start:?}\n");
            }
        }
    }
    assert!(
        missing.is_empty(),
        "figures without a query or a command:\n{missing}"
    );
}

/// Every exception is still one.
#[test]
fn definitions_begin_paragraphs_that_have_numbers() {
    for (name, begins, _) in DEFINITIONS {
        let page = read(name);
        let found = blocks(&page)
            .iter()
            .any(|b| b.trim_start().starts_with(begins) && !figures(b).is_empty());
        assert!(found, "{name}: {begins}");
    }
}

#[test]
fn figures_are_found() {
    assert_eq!(figures("takes 1.25 times as long"), ["1.25"]);
    assert_eq!(
        figures("12 % of `wboit-eq9:factor=0.5`, eq 9, 32 bytes"),
        ["12"]
    );
    assert!(figures("0.16<!-- =error deep-medium / mboit4 --> times").is_empty());
    assert!(figures("0.16<!-- =error deep-medium:scale=0.5 / mboit4 --> times").is_empty());
    assert_eq!(shown(5922.4, "1"), "5,922");
    assert_eq!(shown(0.1549, "0.16"), "0.15");
}
