//! What documents say about the project, held against the project.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_eval::{bench::Bench, effects::Effects};
use peelnet_model::{Model, Recipe};
use peelnet_report::Results;
use peelnet_tests::results;
use std::{
    fs,
    path::{Path, PathBuf},
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_owned()
}

fn read(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn every_crate_stands_in_the_architecture() {
    let text = read("ARCHITECTURE.md");
    for entry in fs::read_dir(root().join("crates")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(
            text.contains(&format!("| `{name}` |")),
            "{name} is missing from ARCHITECTURE.md"
        );
    }
}

/// Every constant that bounds what a file or a flag may ask for stands in the list of limits, and nothing else does.
#[test]
fn limits_are_listed() {
    let list = read("docs/limits.md");
    let mut names = std::collections::BTreeSet::new();
    let mut folders = vec![root().join("crates")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let inside = path.strip_prefix(root().join("crates")).unwrap();
            let mut parts = inside.iter().map(|part| part.to_str().unwrap());
            let (krate, source) = (parts.next().unwrap(), parts.next());
            if source != Some("src") || path.extension().is_none_or(|e| e != "rs") {
                continue;
            }
            for line in fs::read_to_string(&path).unwrap().lines() {
                let declared = line
                    .split_once("const ")
                    .and_then(|(_, rest)| rest.split_once(':'));
                let name = declared
                    .map(|(name, _)| name)
                    .filter(|name| name.starts_with("MAX_") || name.starts_with("DEFAULT_MAX_"));
                names.extend(name.map(|name| format!("{krate}::{name}")));
            }
        }
    }
    assert!(names.len() > 20, "{names:?}");
    for name in &names {
        assert!(
            list.contains(&format!("`{name}`")),
            "{name} is not in docs/limits.md"
        );
    }
    for named in list.split('`').filter(|part| part.contains("::MAX_")) {
        assert!(
            names.contains(named),
            "docs/limits.md names {named}, which is gone"
        );
    }
}

/// No source file is over 600 lines.
#[test]
fn files_are_short() {
    let mut folders = vec![root()];
    let mut seen = 0;
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir()
                && !name.starts_with('.')
                && !["target", "out", "node_modules"].contains(&name.as_str())
            {
                folders.push(path);
            } else if [".rs", ".wgsl", ".py"].iter().any(|e| name.ends_with(e)) {
                let lines = fs::read_to_string(&path).unwrap().lines().count();
                assert!(lines <= 600, "{}: {lines} lines", path.display());
                seen += 1;
            }
        }
    }
    assert!(seen > 100, "{seen} files");
}

/// Every shader is described: a method's passes at the head of their files, all others in the list of shaders.
#[test]
fn every_shader_is_described() {
    let list = read("shaders/README.md");
    for (path, text) in peelnet_shaders::SOURCES {
        let mut parts: Vec<_> = path.split("::").collect();
        let file = format!("{}.wgsl", parts.pop().unwrap());
        let described = match parts[..] {
            ["methods", _] => {
                let first = text.lines().next().unwrap_or_default();
                first.starts_with("// ") && first.len() > 20
            }
            _ => list.contains(&file),
        };
        assert!(
            described,
            "{path}: say what it does, in shaders/README.md or in its first line"
        );
    }
}

/// The scene in docs/scene-files.md loads, and the page names every shape.
#[test]
fn the_documented_scene_loads() {
    let page = read("docs/scene-files.md");
    let (_, rest) = page.split_once("```toml\n").unwrap();
    let (scene, _) = rest.split_once("```").unwrap();
    let scene = peelnet_scene::Scene::from_bytes("room.toml", |path| match path.to_str() {
        Some("room.toml") => Ok(scene.into()),
        Some("meshes/pot.obj") => Ok(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec()),
        _ => Err(std::io::ErrorKind::NotFound.into()),
    })
    .unwrap();
    assert_eq!(
        (scene.objects.len(), scene.views.len(), scene.timeline.len()),
        (18, 4, 2)
    );
    let shapes = read("crates/peelnet_scene/src/shapes.rs");
    for shape in shapes.split("=> \"").skip(1) {
        let name = shape.split('"').next().unwrap();
        assert!(page.contains(&format!("| `{name}` |")), "{name}");
    }
}

#[test]
fn every_shipped_scene_stands_in_its_readme() {
    let text = read("data/README.md");
    for entry in fs::read_dir(root().join("data/scenes")).unwrap() {
        let file = entry.unwrap().file_name().into_string().unwrap();
        let name = file.trim_end_matches(".toml");
        let ranged = name.strip_prefix("sixteen-0").is_some();
        assert!(
            ranged || text.contains(&format!("`{name}`")),
            "{name} is missing from data/README.md"
        );
    }
}

/// One version of wgpu and of naga in the tree.
#[test]
fn one_version_of_the_gpu_stack() {
    let lock = read("Cargo.lock");
    for name in ["wgpu", "wgpu-core", "wgpu-hal", "naga"] {
        let count = lock.matches(&format!("name = \"{name}\"\n")).count();
        assert_eq!(count, 1, "{name}");
    }
}

/// Relative links in the documents lead somewhere.
#[test]
fn links_lead_somewhere() {
    let mut documents = vec![
        "README.md".to_owned(),
        "ARCHITECTURE.md".into(),
        "CONTRIBUTING.md".into(),
    ];
    for entry in fs::read_dir(root().join("docs")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".md") {
            documents.push(format!("docs/{name}"));
        }
    }
    for document in documents {
        let text = read(&document);
        let folder = root().join(&document).parent().unwrap().to_owned();
        for target in text.split("](").skip(1).filter_map(|t| t.split(')').next()) {
            if target.starts_with("http") || target.starts_with('#') {
                continue;
            }
            let path = target.split('#').next().unwrap();
            assert!(folder.join(path).exists(), "{document} links to {target}");
        }
    }
}

/// The methods that the table of docs/benchmarks.md shows of it.
const SHOWN: [&str; 34] = [
    "abuffer",
    "linked-list",
    "painter-triangle",
    "wboit-eq7",
    "wboit-eq8",
    "wboit-eq9",
    "mboit4",
    "mboit4:overestimation=0.5",
    "mboit4:own=out",
    "mboit6",
    "mboit8",
    "mboit-trig-3",
    "wavelet-3",
    "wavelet-3:bounds=pixel",
    "bins-8",
    "bins-16",
    "avboit",
    "kbuffer-4",
    "hybrid-8",
    "mlab-4",
    "nmt",
    "dfaoit",
    "deep-thesis",
    "slabs",
    "deep-small",
    "deep-medium",
    "deep-medium:range=frame",
    "deep-medium:scale=0.5",
    "deep-large",
    "deep-large:range=frame",
    "deep-anchored-small",
    "deep-anchored-small:targets=f32",
    "deep-anchored-medium",
    "deep-anchored-medium:targets=f32",
];

/// The part of a page between its marks.
fn block_of(text: &str, name: &str) -> String {
    let begin = format!("<!-- {name}:begin -->\n");
    let (_, block) = text.split_once(&begin).unwrap();
    let end = format!("<!-- {name}:end -->");
    block.split_once(&end).unwrap().0.to_owned()
}

/// The part of a page between its marks is this. `PEELNET_UPDATE=1` writes it anew.
fn generated(page: &str, name: &str, want: &str) {
    let text = read(page);
    let block = block_of(&text, name);
    if std::env::var_os("PEELNET_UPDATE").is_some() {
        let mark = format!("<!-- {name}:begin -->\n");
        let text = text.replace(&format!("{mark}{block}"), &format!("{mark}{want}"));
        fs::write(root().join(page), text).unwrap();
        return;
    }
    assert_eq!(block, want, "{page}: PEELNET_UPDATE=1 writes it anew");
}

fn held_out_run() -> Results<Bench> {
    serde_json::from_str(&read(&format!("{}/results.json", results("held-out")))).unwrap()
}

/// The table of docs/benchmarks.md is the one that the committed rows give.
#[test]
fn benchmarks_show_the_committed_run() {
    let run = held_out_run();
    let table = run.markdown();
    assert_eq!(read(&format!("{}/table.md", results("held-out"))), table);
    let rows = &run.measured.rows;
    let is_left_out = |line: &str| {
        let method = line.split(" | ").next().unwrap().trim_start_matches("| ");
        rows.iter().any(|r| r.method == method) && !SHOWN.contains(&method)
    };
    let want: String = table
        .lines()
        .filter(|line| !is_left_out(line))
        .map(|line| format!("{line}\n"))
        .collect();
    generated("docs/benchmarks.md", "methods", &want);
}

/// The committed rows are sound: finite, and exact methods are exact. Whether any are missing is checked by
/// `cargo xtask results --check`.
#[test]
fn the_committed_rows_are_sound() {
    let run = held_out_run();
    // Exact methods show no error where they lose no fragment; only dual peeling may lose some, coplanar ones, and counts them.
    for row in &run.measured.rows {
        let at = format!("{} on {}", row.method, row.scene);
        assert_eq!(row.non_finite_pixels, 0, "{at}");
        let spec: peelnet_render::MethodSpec = row.method.parse().unwrap();
        if spec.promises().exact {
            let lost = row.lost.unwrap_or_default();
            // Exact but for a declared flaw.
            assert!(lost == 0 || !spec.method().flaws.is_empty(), "{at}");
            let limit = peelnet_core::tolerance::EXACT;
            assert!(
                row.mse_linear.sqrt() <= limit || lost > 0,
                "{at}: {}",
                row.mse_linear
            );
        }
    }
}

/// The table of the errors along a path is the committed one.
#[test]
fn the_path_is_the_committed_one() {
    let want = read(&format!("{}/path.md", results("path")));
    generated("docs/benchmarks.md", "path", &want);
}

/// Nothing failed in the committed run over the hard cases.
#[test]
fn nothing_failed_in_the_committed_stress() {
    let rows = read(&format!("{}/stress.csv", results("stress")));
    assert!(rows.lines().count() > 1000 && !rows.contains(",fail,"));
    assert!(read(&format!("{}/stress.md", results("stress"))).contains(" 0 failures"));
}

/// The thesis's scenes in docs/benchmarks.md are the rows of the committed run.
#[test]
fn the_thesis_table_is_the_committed_one() {
    let measured = read(&format!("{}/table.md", results("thesis-full")));
    let mut want = "| scene | its analytic weight | learned | ratio | best published weight (eq 8) | thesis: its figures | thesis: ratio |\n\
                    |---|---:|---:|---:|---:|---:|---:|\n"
        .to_owned();
    let mut rows = 0;
    for line in measured.lines().filter(|l| l.starts_with("| sixteen-")) {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        let &[
            _,
            scene,
            weight,
            _,
            best,
            learned,
            ratio,
            _,
            figures,
            factor,
            _,
        ] = &cells[..]
        else {
            break;
        };
        let figures = figures.replace("not measured", "–");
        want += &format!(
            "| {scene} | {weight} | {learned} | {ratio} | {best} | {figures} | {factor} |\n"
        );
        rows += 1;
    }
    assert_eq!(rows, 7);
    generated("docs/benchmarks.md", "thesis", &want);
}

/// The table of shading and transparency, each alone; nothing where the committed run is older than these rows.
fn parts(measured: &Effects) -> String {
    if measured.parts.is_empty() {
        return String::new();
    }
    let mut text = "Frame times relative to those of both together, from the same run:\n\n\
                    | scene | shading alone | transparency alone |\n|---|---:|---:|\n"
        .to_owned();
    for p in &measured.parts {
        let [shading, transparency] = [p.ms_shading, p.ms_transparency].map(|ms| ms / p.ms_both);
        text += &format!("| `{}` | {shading:.2} | {transparency:.2} |\n", p.scene);
    }
    text
}

/// What docs/effects.md says of costs is what the committed run measured.
#[test]
fn costs_of_effects_are_those_measured() {
    let page = "docs/effects.md";
    let measured = read(&format!("{}/effects.json", results("effects")));
    let measured: Results<Effects> = serde_json::from_str(&measured).unwrap();
    let measured = measured.measured;
    let mut shown = 0;
    // The pictures stay, the last column is measured.
    let mut with_cost = |line: &str| {
        let effect = line.split('`').nth(1)?;
        let dim = matches!(effect, "monochrome" | "low-resolution");
        let scene = if dim { "mist" } else { "still-life" };
        let mut all = measured.costs.iter();
        let cost = all.find(|c| c.scene == scene && c.effect == effect)?;
        let (before, _) = line.trim_end_matches(" |").rsplit_once("| ")?;
        shown += 1;
        Some(format!("{before}| {:.2} |\n", cost.ratio))
    };
    let costs = block_of(&read(page), "costs");
    let costs: String = costs
        .lines()
        .map(|line| with_cost(line).unwrap_or_else(|| format!("{line}\n")))
        .collect();
    generated(page, "costs", &costs);
    assert!(shown > 10, "{shown}");
    let mut layers = "| layers | one shaded / all shaded |\n|---:|---:|\n".to_owned();
    for l in &measured.layers {
        layers += &format!("| {} | {:.2} |\n", l.layers, l.ratio);
    }
    generated(page, "layers", &layers);
    generated(page, "parts", &parts(&measured));
    let old = block_of(&read(page), "fills");
    let mut fills: String = old.lines().take(2).map(|l| format!("{l}\n")).collect();
    let first = measured.fills[0].ms_one;
    for (row, line) in measured.fills.chunks(3).zip(old.lines().skip(2)) {
        let triangles = line.split('|').nth(1).unwrap();
        fills += &format!("|{triangles}|");
        for f in row {
            fills += &format!(" {:.2} |", f.ms_one / first);
        }
        fills += "\n";
    }
    generated(page, "fills", &fills);
}

/// Every shipped network is trained with the budget that the committed search chose for it, by the least loss on its validation data: its
/// model file says so.
#[test]
fn budgets_of_training_are_those_of_the_search() {
    let json = read(&format!("{}/search.json", results("search")));
    let search: serde_json::Value = serde_json::from_str(&json).unwrap();
    let recipes = search["recipes"].as_array().unwrap();
    assert_eq!(recipes.len(), Recipe::ALL.len());
    for found in recipes {
        let recipe: Recipe = found["recipe"].as_str().unwrap().parse().unwrap();
        let points = found["points"].as_array().unwrap();
        let loss = |p: &serde_json::Value| p["validation_loss"].as_f64().unwrap_or(f64::INFINITY);
        let least = points.iter().min_by(|a, b| loss(a).total_cmp(&loss(b)));
        let chosen = &points[found["chosen"].as_u64().unwrap() as usize];
        assert_eq!(Some(chosen), least, "{recipe}");
        let trained = Model::shipped(recipe).unwrap().meta.config;
        for setting in ["epochs", "learning_rate"] {
            assert_eq!(trained[setting], chosen[setting], "{recipe}");
        }
        // The thesis's published settings are its recipe's, for `peelnet run`; ours train for a minute unless asked to train longer.
        if recipe != Recipe::THESIS && recipe.loss.is_none() {
            assert_eq!(
                Some(u64::from(recipe.budget.epochs)),
                chosen["epochs"].as_u64()
            );
            assert_eq!(
                Some(recipe.budget.learning_rate),
                chosen["learning_rate"].as_f64()
            );
        }
    }
}
