//! Every committed result of a machine, by one command.

use crate::{
    Outcome, apart,
    product::{Program, files_in, scene_file, scene_files},
    root, run,
};
use std::{fs, path::Path, time::Instant};

/// Scenes that choose which setting stands for a family of methods; none of them is in a table.
const VALIDATION_SCENES: [&str; 3] = ["intersecting", "sixteen-050", "sixteen-random-color"];

/// One or two of each family: sixty frames of sixty settings would take an hour.
const PATH_METHODS: &str = "abuffer,painter-object,painter-triangle,wboit-eq9,mboit4,mboit6,wavelet-3:bounds=pixel,bins-8,avboit,kbuffer-4,stochastic-16,deep-thesis,nmt,dfaoit,deep-anchored-medium,deep-small,deep-medium,deep-large,one,deep-one,deep-one:range=last,deep-one-wide";

/// What draws the geometry once, and what it is compared with.
const ONE_PASS_METHODS: &str = "abuffer,painter-object:sort=off,wboit-eq7,wboit-eq8,wboit-eq9,wboit-eq10,wboit-inverse-power,mboit4,deep-anchored-small,deep-small,deep-medium,deep-medium:range=frame,one,one:range=last,one:range=frame,one-wide,one-wide:range=last,one-wide:range=frame,deep-one,deep-one:range=last,deep-one:range=frame,deep-one-wide,deep-one-wide:range=last,deep-one-wide:range=frame";

/// One or two settings of each family, and all that is learned.
const COMPARED_METHODS: &str = "abuffer,linked-list,painter-triangle,wboit-eq9,wboit-inverse-power,mboit4,mboit4:own=out,mboit6,mboit8,mboit-trig-2,mboit-trig-3,wavelet-3:bounds=pixel,bins-8,bins-16,avboit,kbuffer-4,kbuffer-4:colors=u8,hybrid-8:colors=u8,stochastic-16,deep-thesis,nmt:targets=f16,dfaoit,slabs:keep=small,deep-small,deep-small:range=frame,slabs:keep=medium,deep-medium,slabs,deep-large,deep-anchored-small,deep-anchored-medium,one,deep-one,deep-one:range=last,one-wide,deep-one-wide";

/// What is judged with a surface apart from all others.
const APART_METHODS: &str = "abuffer,wboit-eq9,mboit4,mboit6,wavelet-3:bounds=pixel,bins-8,bins-16,avboit,kbuffer-4,slabs:keep=small,slabs:keep=medium,slabs,deep-anchored-medium,deep-small,deep-medium,deep-large,deep-medium:range=boxes,deep-medium:range=frame,one,one-wide,deep-one,deep-one-wide,deep-one:range=last,deep-one-wide:range=last,deep-one:range=frame,deep-one-wide:range=frame";

/// What splats are drawn with: exactly, sorted, by moments, by bins, by networks for surfaces, and by the method for splats.
const SPLAT_METHODS: &str = "abuffer,painter-object,painter-triangle,painter-object:sort=off,wboit-eq9,mboit4,bins-16,kbuffer-8,stochastic-16,deep-medium,deep-large,splat";

/// Commands of peelnet whose results are kept: the name, the command without `--out`, in which names in angle brackets stand for what
/// [`filled`] puts there, and the files of its output that are kept; where none are, what it prints is, as JSON.
///
/// The thesis's recipe runs at a quarter of its pixels, with as many rows: the whole takes twenty minutes.
const STEPS: &str = "
    stress | stress | stress.csv.xz stress.md
    held-out-all | bench <held-out> --size 512x384 --views 1 --frames 3 | results.json.xz table.md pareto.svg pareto-mean.svg
    held-out | bench <held-out> --size 512x384 --views 1 --frames 3 --methods <compared> | results.json.xz table.md pareto.svg pareto-mean.svg
    fresh | bench <fresh> --size 512x384 --views 1 --frames 3 --methods <compared> | results.json.xz table.md
    fresh-meshes | bench <fresh-meshes> --size 512x384 --views 1 --frames 3 --methods <compared> | results.json.xz table.md
    validation | bench <validation> --size 512x384 --views 1 --frames 3 | results.json.xz table.md
    one-pass | bench <held-out> --size 512x384 --views 1 --frames 5 --methods <one-pass> | results.json.xz table.md pareto-mean.svg
    apart-none | bench <apart none> --size 256x192 --views 1 --frames 0 --methods <apart> | table.md
    apart-near | bench <apart near> --size 256x192 --views 1 --frames 0 --methods <apart> | table.md
    apart-quarter | bench <apart quarter> --size 256x192 --views 1 --frames 0 --methods <apart> | table.md
    apart-backdrop | bench <apart backdrop> --size 256x192 --views 1 --frames 0 --methods <apart> | table.md
    path | bench path sixteen-held smoke-held --size 256x192 --methods <path> | path.csv path.md path-error.svg path-change.svg
    samples | bench cups-held foliage-held --samples 4 --size 256x192 --views 1 --frames 3 --methods <path> | table.md
    splats | bench data/splats/cloud.toml --size 640x480 --frames 3 --methods <splats>,painter-triangle:sort=gpu | results.json.xz table.md
    splats-cards | bench data/splats/cloud-cards.toml --size 640x480 --frames 3 --methods <splats> | results.json.xz table.md
    splats-small | bench data/splats/cloud.toml data/splats/cloud-cards.toml --size 256x192 --frames 0 --methods <splats> | results.json.xz table.md
    splats-path | bench path data/splats/cloud.toml data/splats/cloud-cards.toml --size 256x192 --frames 24 --methods painter-triangle,mboit4,deep-large,splat | path.csv path.md path-change.svg
    effects | bench effects --size 512x384 --frames 9 | effects.md effects-layers.svg
    scaling | bench scaling --frames 3 | scaling.md scaling-fragments.svg scaling-pixels.svg scaling-triangles.svg
    thesis-full | run --full --size 512x384 | results.json.xz table.md
    extract-sbuffer | <extract> |
    extract-dual | <extract> --peel dual |
    extract-single | <extract> --peel single |";

fn steps() -> Vec<[&'static str; 3]> {
    let steps = STEPS.trim().lines().map(|line| {
        let mut fields = line.split('|').map(str::trim);
        [(); 3].map(|()| fields.next().unwrap_or_default())
    });
    steps.collect()
}

/// The scenes that no network learns from.
fn held_out() -> Result<Vec<String>, String> {
    scene_files(|name| name.ends_with("-held"))
}

/// A step's command with scenes and methods in their places.
fn filled(line: &str) -> Result<String, String> {
    let extract = "extract data/scenes/sixteen-050.toml --size 1024x768 --json";
    let mut line = line.replace("<apart>", APART_METHODS);
    line = line.replace("<compared>", COMPARED_METHODS);
    for (kind, ..) in apart::KINDS {
        let name = format!("<apart {kind}>");
        if line.contains(&name) {
            line = line.replace(&name, &apart::scenes(kind, held_out()?)?.join(" "));
        }
    }
    if line.contains("<fresh-meshes>") {
        let found = files_in("out/meshes", |name| name.ends_with("-fresh"));
        let found = found.map_err(|e| format!("{e}; cargo xtask meshes fetches them"))?;
        line = line.replace("<fresh-meshes>", &found.join(" "));
    }
    Ok(line
        .replace("<held-out>", &held_out()?.join(" "))
        .replace("<fresh>", &files_in("data/fresh", |_| true)?.join(" "))
        .replace("<validation>", &VALIDATION_SCENES.map(scene_file).join(" "))
        .replace("<path>", PATH_METHODS)
        .replace("<splats>", SPLAT_METHODS)
        .replace("<one-pass>", ONE_PASS_METHODS)
        .replace("<extract>", extract))
}

/// Runs the steps of these names, or every step, and puts what they keep into a folder of the machine's name. PEELNET_BINARY is a program that
/// is built already.
pub fn measure(machine: &str, names: &[&str]) -> Outcome {
    let steps = steps();
    let known: Vec<&str> = steps.iter().map(|[name, ..]| *name).collect();
    if let Some(unknown) = names.iter().find(|name| !known.contains(name)) {
        let known = known.join(", ");
        return Err(format!("measure has no step {unknown}: {known}"));
    }
    let program = Program::given_or_built("")?;
    let is_asked = |[name, ..]: &[&str; 3]| names.is_empty() || names.contains(name);
    let into = root().join("docs/results").join(machine);
    let io = |path: &Path, e: std::io::Error| format!("{}: {e}", path.display());
    let mut times = String::new();
    let all = Instant::now();
    // What is missing is said before hours of others.
    let asked = steps.into_iter().filter(is_asked);
    let asked = asked.map(|[name, line, keep]| Ok((name, filled(line)?, keep)));
    for (name, line, keep) in asked.collect::<Result<Vec<_>, String>>()? {
        let begin = Instant::now();
        let out = root().join("out/measure").join(name);
        let _ = fs::remove_dir_all(&out);
        let line = format!("{line} --out out/measure/{name} --quiet");
        let kept = into.join(if keep.is_empty() { "" } else { name });
        fs::create_dir_all(&kept).map_err(|e| io(&kept, e))?;
        if keep.is_empty() {
            let file = kept.join(format!("{name}.json"));
            fs::write(&file, program.captured(&line)?).map_err(|e| io(&file, e))?;
        } else {
            program.run(&line)?;
        }
        for file in keep.split_terminator(' ') {
            // Rows are kept packed: a name of that kind stands for the file that was written.
            let plain = file.trim_end_matches(".xz");
            let (from, to) = (out.join(plain), kept.join(plain));
            fs::copy(&from, &to).map_err(|e| io(&from, e))?;
            if plain != file {
                run(&format!("xz -9 --force {}", to.display()))?;
            }
        }
        times += &format!("{:>7.1} s  {name}\n", begin.elapsed().as_secs_f64());
    }
    let tables = apart::KINDS.map(|(kind, ..)| into.join(format!("apart-{kind}/table.md")));
    if let Ok(tables) = tables
        .iter()
        .map(fs::read_to_string)
        .collect::<Result<Vec<_>, _>>()
    {
        let file = into.join("apart.md");
        fs::write(&file, apart::table(&tables)?).map_err(|e| io(&file, e))?;
    }
    let together = all.elapsed().as_secs_f64();
    println!(
        "\n{times}{together:>7.1} s  together; results are in {}",
        into.display()
    );
    println!(
        "next: PEELNET_UPDATE=1 cargo nextest run -p peelnet_tests generated_tables puts them into the documents"
    );
    match stale(&program, &into)?.join(" ") {
        none if none.is_empty() => Ok(()),
        stale => Err(format!(
            "of other shaders or networks than this program's, measure them again: {stale}"
        )),
    }
}

/// Steps whose kept rows are of other shaders or networks than this program's.
fn stale(program: &Program, into: &Path) -> Result<Vec<&'static str>, String> {
    let mut found = Vec::new();
    // Of other commands there are other results.
    for [name, ..] in steps()
        .into_iter()
        .filter(|[_, line, _]| line.starts_with("bench "))
    {
        let packed = into.join(name).join("results.json.xz");
        if !packed.exists() {
            continue;
        }
        let folder = format!("out/measure/{name}");
        let io = |e: std::io::Error| format!("{folder}: {e}");
        fs::create_dir_all(root().join(&folder)).map_err(io)?;
        let plain = root().join(&folder).join("results.json.xz");
        fs::copy(&packed, &plain).map_err(io)?;
        run(&format!("xz --decompress --force {}", plain.display()))?;
        let check = format!("bench redraw --check --out {folder} --quiet --json");
        if program.captured(&check).is_err() {
            found.push(name);
        }
    }
    Ok(found)
}
