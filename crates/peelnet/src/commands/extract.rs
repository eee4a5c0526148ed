//! `peelnet extract`: scenes into a dataset.

use super::Context;
use crate::cli::ExtractArgs;
use crate::failure::Failure;
use crate::outputs::is_folder;
use crate::parse::{ViewCount, command_line, json_path, shown};
use crate::progress::Bar;
use peelnet_dataset::is_remote;
use peelnet_files::{counted, printable, thousands};
use peelnet_gpu::Gpu;
use peelnet_peel::{
    ExtractOptions, ExtractReport, Views, extract,
    synthetic::{SyntheticOptions, synthetic},
};
use peelnet_scene::Scene;
use serde_json::json;
use std::path::Path;

pub(super) fn run(context: &Context<'_>, args: &ExtractArgs) -> Result<(), Failure> {
    if !is_remote(&args.out) {
        is_folder("--out", &args.out)?;
    }
    if peelnet_dataset::replaces(&args.out, args.resume || args.shard.is_some())? {
        context
            .console
            .message(format!("replacing {} (a dataset)", shown(&args.out)));
    }
    let before = finished(&args.out);
    let report = report(context, args).inspect_err(|_| hint(context, &args.out, before))?;
    let folder = &args.out;
    context.console.result(
        || text(folder, &report),
        || {
            let m = &report.manifest;
            json!({
                "out": json_path(folder),
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
        },
    )
}

/// How many parts of a dataset that is not sealed are finished, and how many it will have.
fn finished(folder: &Path) -> (u32, u32) {
    let parts = peelnet_dataset::unsealed_parts(folder);
    parts.ok().flatten().unwrap_or_default()
}

/// Says what stays of a run that failed, if it finished anything.
fn hint(context: &Context<'_>, folder: &Path, before: (u32, u32)) {
    let (done, of) = finished(folder);
    if done > before.0 {
        context.console.message(format!(
            "{}: {done} of {} stay; the same command with --resume writes the others",
            shown(folder),
            counted(of.into(), "part")
        ));
    }
}

/// Peels, or makes lists up.
fn report(context: &Context<'_>, args: &ExtractArgs) -> Result<ExtractReport, Failure> {
    if let Some(lists) = args.synthetic {
        make_up(
            context,
            &SyntheticOptions {
                out: args.out.clone(),
                lists,
                format: args.format,
                seed: args.seed,
                resume: args.resume,
                command: command_line(),
            },
        )
    } else {
        let scenes = context.scenes(&args.scenes)?;
        let gpu = context.gpu()?;
        let options = ExtractOptions {
            out: args.out.clone(),
            size: args.size.0,
            views: match args.views {
                ViewCount::All => Views::All,
                ViewCount::First(n) => Views::First(n),
            },
            format: args.format,
            peel: args.peel,
            max_passes: args.max_passes,
            pixels: args.pixels,
            augment: args.augment,
            seed: args.seed,
            shard: args.shard,
            resume: args.resume,
            command: command_line(),
            budget: None,
        };
        peel(context, &gpu, &scenes, &options)
    }
}

/// Generates lists with a progress bar.
fn make_up(context: &Context<'_>, options: &SyntheticOptions) -> Result<ExtractReport, Failure> {
    let bar = Bar::new(context.console, "synthetic", 1);
    let report = synthetic(options, context.stop, &mut |p| show(&bar, p))?;
    drop(bar);
    Ok(report)
}

fn show(bar: &Bar, p: &peelnet_peel::Progress) {
    let rate = p.rows as f64 / p.seconds.max(1e-3);
    bar.set(
        p.items_done.into(),
        p.items.into(),
        format!(
            "{} rows, {} rows/s",
            thousands(p.rows),
            thousands(rate as u64)
        ),
    );
}

/// Peels with a progress bar, and warns of what peeling left out.
pub(super) fn peel(
    context: &Context<'_>,
    gpu: &Gpu,
    scenes: &[Scene],
    options: &ExtractOptions,
) -> Result<ExtractReport, Failure> {
    context.console.message(format!(
        "peeling {} at {}x{} on {}",
        names(scenes),
        options.size[0],
        options.size[1],
        gpu.info.name
    ));
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

/// What an extraction did, in one line.
pub(super) fn text(folder: &Path, report: &ExtractReport) -> String {
    let seconds = report.wall_micros / 1e6;
    let lost = if report.lost > 0 {
        format!(", LOST by peeling: {}", counted(report.lost, "fragment"))
    } else {
        String::new()
    };
    let m = &report.manifest;
    let whole = if m.is_whole() {
        String::new()
    } else {
        format!(" of {} (not all are there yet)", m.work_items)
    };
    let written = if (report.parts as usize) < m.parts.len() {
        format!(", {} written now", counted(report.parts.into(), "part"))
    } else {
        String::new()
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

/// The scenes for a message.
fn names(scenes: &[Scene]) -> String {
    match scenes {
        [one] => format!("scene {}", printable(&one.name)),
        many => counted(many.len() as u64, "scene"),
    }
}
