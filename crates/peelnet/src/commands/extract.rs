use super::{Context, bench::report, command_line, few, json_path};
use crate::cli::{ExtractArgs, SealArgs};
use crate::progress::Bar;
use peelnet::Failure;
use peelnet_bench::preview;
use peelnet_bench::report::kind_of;
use peelnet_core::files::{check_is_folder, counted, printable, shown, thousands};
use peelnet_dataset::is_remote;
use peelnet_peel::{ExtractOptions, ExtractReport, Progress, extract, synthetic::synthetic};
use peelnet_render::gpu::Gpu;
use peelnet_scene::Scene;
use serde_json::json;
use std::path::Path;

/// The page of `--preview`.
const PREVIEW: &str = "preview.html";

pub(super) fn run(context: &Context<'_>, args: &ExtractArgs) -> Result<(), Failure> {
    if args.preview {
        return preview(context, args);
    }
    let out = &args.out;
    if !is_remote(out) {
        check_is_folder("--out", out)?;
    }
    let replaces = peelnet_dataset::replaces(out, args.resume || args.shard.is_some())?;
    let (before, _) = finished(out);
    let report = write(context, args);
    // Where the new one failed, the older one may still be there.
    if replaces && (report.is_ok() || peelnet_dataset::Dataset::open(out).is_err()) {
        let message = format!("replaced {} (a dataset)", shown(out));
        context.console.message(message);
    }
    let report = report.inspect_err(|_| {
        // What stays of a run that failed, if it finished anything.
        let (done, of) = finished(out);
        if done > before {
            context.console.message(format!(
                "{}: {done} of {} stay; the same command with --resume writes the others",
                shown(out),
                counted(of.into(), "part")
            ));
        }
    })?;
    let m = &report.manifest;
    warn_of_empty(context, &report);
    if m.is_whole() {
        warn_of_foreign_card(context, out)?;
    }
    let text = || text(out, &report);
    context.console.result(text, || {
        json!({
            "out": json_path(out),
            "rows": m.rows,
            "pixels": m.pixels,
            "parts": m.parts.len(),
            "hash": m.hash,
            "sealed": m.is_whole(),
            "work_items": m.work_items,
            "parts_written": report.parts,
            "rows_written": report.rows,
            "lost_fragments": report.lost,
            "coplanar_ties": report.coplanar,
            "tiles": report.tiles,
            "gpu_ms": report.gpu_micros / 1e3,
            "wall_ms": report.wall_micros / 1e3,
            "rows_by_scene": m.rows_by_scene(),
            "adapter": m.adapter,
        })
    })
}

/// Counts the rows that an extraction writes, and writes a page about them.
fn preview(context: &Context<'_>, args: &ExtractArgs) -> Result<(), Failure> {
    let mut outputs = context.outputs(&args.scenes);
    outputs.folder("--out", &args.out, [(PREVIEW, kind_of(PREVIEW))])?;
    let scenes = context.scenes(&args.scenes)?;
    let _begun = context.begin(outputs, &scenes)?;
    let gpu = context.gpu()?;
    let bar = Bar::new(context.console, "preview", 1);
    let mut show = |done, total| bar.set(done, total, "views".to_owned());
    let options = options(args);
    let preview = preview::measure(&gpu, &scenes, &options, context.stop, &mut show)?;
    drop(bar);
    context.warn_of_memory(&gpu);
    let page = args.out.join(PREVIEW);
    report(context, &gpu, &args.out, preview, |results| {
        let (table, text) = (results.table().plain(), results.text());
        format!("{table}\n{}: {text}", shown(&page))
    })
}

pub(super) fn seal(context: &Context<'_>, args: &SealArgs) -> Result<(), Failure> {
    let m = peelnet_dataset::seal(&args.dataset)?;
    warn_of_foreign_card(context, &args.dataset)?;
    let text = || {
        format!(
            "{}: sealed, {} of {} in {}, hash {}",
            shown(&args.dataset),
            counted(m.rows, "row"),
            counted(m.pixels, "pixel"),
            counted(m.parts.len() as u64, "part"),
            m.hash
        )
    };
    context.console.result(text, || {
        json!({
            "dataset": json_path(&args.dataset),
            "rows": m.rows,
            "pixels": m.pixels,
            "parts": m.parts.len(),
            "hash": m.hash,
            "plan": m.plan,
            "lost_fragments": m.lost_fragments,
            "coplanar_ties": m.coplanar_ties,
            "rows_by_scene": m.rows_by_scene(),
            "adapter": m.adapter,
        })
    })
}

/// Warns of files in a sealed dataset that stand where its card would, but are not the card.
fn warn_of_foreign_card(context: &Context<'_>, dataset: &Path) -> Result<(), Failure> {
    for path in peelnet_dataset::foreign_card(dataset)? {
        let note = peelnet_dataset::FOREIGN_CARD;
        context.console.warn(format!("{} {note}", shown(&path)));
    }
    Ok(())
}

/// How many parts of a dataset that is not sealed are finished, and how many it will have.
fn finished(folder: &Path) -> (u32, u32) {
    let parts = peelnet_dataset::unsealed_parts(folder);
    parts.ok().flatten().unwrap_or_default()
}

fn options(args: &ExtractArgs) -> ExtractOptions {
    ExtractOptions {
        size: args.size,
        views: args.views,
        format: args.format,
        peel: args.peel,
        max_passes: args.max_passes,
        pixels: args.pixels,
        augment: args.augment,
        seed: args.seed,
        shard: args.shard,
        resume: args.resume,
        command: command_line(),
        ..ExtractOptions::new(&args.out)
    }
}

/// Peels, or makes lists up.
fn write(context: &Context<'_>, args: &ExtractArgs) -> Result<ExtractReport, Failure> {
    let options = options(args);
    if let Some(lists) = args.synthetic {
        let bar = Bar::new(context.console, "synthetic", 1);
        let mut show = |p: &Progress| show(&bar, p);
        return Ok(synthetic(lists, &options, context.stop, &mut show)?);
    }
    let scenes = context.scenes(&args.scenes)?;
    let gpu = context.gpu()?;
    peel(context, &gpu, &scenes, &options)
}

fn show(bar: &Bar, p: &Progress) {
    bar.set(p.items_done.into(), p.items.into(), p.text());
}

/// Peels with a progress bar, and warns of what peeling left out.
pub(super) fn peel(
    context: &Context<'_>,
    gpu: &Gpu,
    scenes: &[Scene],
    options: &ExtractOptions,
) -> Result<ExtractReport, Failure> {
    let names = match scenes {
        [one] => format!("scene {}", printable(&one.name)),
        many => counted(many.len() as u64, "scene"),
    };
    let [width, height] = options.size;
    let adapter = &gpu.info.name;
    let message = format!("peeling {names} at {width}x{height} on {adapter}");
    context.console.message(message);
    let bar = Bar::new(context.console, "extract", 1);
    let report = extract(gpu, scenes, options, context.stop, &mut |p| show(&bar, p));
    drop(bar);
    let report = report?;
    context.warn_of_memory(gpu);
    if report.lost > 0 {
        context.console.warn(format!(
            "left out by {1} peeling: {0}; --peel sbuffer without --max-passes keeps all",
            counted(report.lost, "fragment"),
            options.peel
        ));
    }
    Ok(report)
}

/// Warns of scenes of a whole dataset in which nothing transparent was seen.
pub(super) fn warn_of_empty(context: &Context<'_>, report: &ExtractReport) {
    let m = &report.manifest;
    let rows = m.rows_by_scene();
    let empty = m.scenes.iter().filter(|s| rows.get(&*s.name) == Some(&0));
    let empty: Vec<String> = empty.map(|s| s.name.clone()).collect();
    if m.is_whole() && !empty.is_empty() {
        let or = if m.pixels_fraction < 1.0 {
            ", or keep more with --pixels"
        } else {
            ""
        };
        context.console.warn(format!(
            "no rows: nothing transparent is seen in {}; look at its materials' alpha and its cameras{or}",
            few(&empty, 6)
        ));
    }
    let copies = m.parts.iter().filter(|p| p.copy > 0 && p.rows == 0);
    let of_seen = copies.filter(|p| rows.get(&*m.scenes[p.scene as usize].name) != Some(&0));
    let number = of_seen.count() as u64;
    if number > 0 {
        context.console.warn(format!(
            "no rows in {} of varied copies: nothing transparent is seen there",
            counted(number, "view")
        ));
    }
}

pub(super) fn text(folder: &Path, report: &ExtractReport) -> String {
    let seconds = report.wall_micros / 1e6;
    let m = &report.manifest;
    let whole = match m.is_whole() {
        true => String::new(),
        false => format!(" of {} (not all are there yet)", m.work_items),
    };
    let written = match (report.parts as usize) < m.parts.len() {
        true => format!(", {} written now", counted(report.parts.into(), "part")),
        false => String::new(),
    };
    let lost = match report.lost {
        0 => String::new(),
        n => format!(", LOST by peeling: {}", counted(n, "fragment")),
    };
    format!(
        "{}: {} of {} in {}{whole}{written}, {seconds:.1} s ({} rows/s, {:.1} s of GPU time), {}{lost}",
        shown(folder),
        counted(m.rows, "row"),
        counted(m.pixels, "pixel"),
        counted(m.parts.len() as u64, "part"),
        thousands((report.rows as f64 / seconds.max(1e-6)) as u64),
        report.gpu_micros / 1e6,
        counted(report.coplanar, "coplanar pair"),
    )
}
