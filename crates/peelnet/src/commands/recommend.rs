//! `peelnet recommend`: the best method within a budget.

use super::{Context, bench};
use crate::cli::{BenchArgs, RecommendArgs};
use crate::failure::Failure;
use crate::parse::{MethodList, ViewCount};
use peelnet_eval::{
    front::{Mean, Point, points, untimed},
    recommend::Budget,
};
use serde_json::json;

pub(super) fn run(context: &Context<'_>, args: &RecommendArgs) -> Result<(), Failure> {
    let scenes = context.scenes(std::slice::from_ref(&args.scene))?;
    let scene = &scenes[0];
    let results = match &args.results {
        Some(path) => bench::read(path)?,
        None => {
            let args = BenchArgs {
                scenes: vec![args.scene.clone()],
                // Nothing is written.
                out: std::path::PathBuf::new(),
                scaling: false,
                effects: false,
                designs: Vec::new(),
                designs_file: None,
                max_rows: None,
                redraw: false,
                path: false,
                samples: 1,
                methods: MethodList::All,
                models: Vec::new(),
                frames: args.frames,
                size: args.size,
                views: ViewCount::All,
                resume: false,
            };
            bench::measure(context, &args, &scenes, None)?
        }
    };
    let own = points(&results.measured.rows, Some(&scene.name), Mean::Geometric);
    let (from, points) = if own.is_empty() {
        let message = format!(
            "scene '{}' is not among the results: judged by the geometric means over all scenes of them",
            scene.name
        );
        context.console.warn(message);
        (
            "all scenes of the results",
            points(&results.measured.rows, None, Mean::Geometric),
        )
    } else {
        ("this scene", own)
    };
    let budget = Budget {
        ms: args.budget_ms,
        error: args.max_error,
        bytes: args.max_bytes,
    };
    let chosen = budget.choose(&points).map_err(Failure::Failed)?;
    let untimed = untimed(&results.measured.rows);
    let line = |p: &Point| {
        format!(
            "{}: {:.2} ms ({:.2} x hardware blending), {}, {:.0} bytes a pixel",
            p.method,
            p.time_ms,
            p.time,
            if p.is_exact() {
                "exact".to_owned()
            } else {
                format!("MSE {:.2e}", p.error)
            },
            p.bytes.most
        )
    };
    context.console.result(
        || {
            let mut text = format!("{}\n  {}\n", line(chosen.best), chosen.why);
            if let Some(next) = chosen.runner_up {
                text.push_str(&format!("runner-up\n  {}\n", line(next)));
            }
            for (method, why) in &untimed {
                text.push_str(&format!("{method} is not among them: {why}\n"));
            }
            text.push_str(&format!("measured on {} with {from}\n", results.machine.adapter));
            text
        },
        || {
            let point = |p: &Point| {
                json!({"method": p.method, "time_ms": p.time_ms, "mse_linear": p.mse(), "bytes_per_pixel": p.bytes.most})
            };
            json!({
                "method": chosen.best.method,
                "best": point(chosen.best),
                "runner_up": chosen.runner_up.map(point),
                "why": chosen.why,
                "without_time": untimed.iter().map(|(method, why)| json!({"method": method, "why": why})).collect::<Vec<_>>(),
                "adapter": results.machine.adapter,
            })
        },
    )
}
