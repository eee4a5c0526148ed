use super::{Context, bench};
use crate::cli::RecommendArgs;
use peelnet::Failure;
use peelnet_bench::{
    compare::Plan,
    front::{Point, untimed},
    recommend::{Budget, Candidates, points_for},
    rows::Rows,
};
use serde_json::json;

pub(super) fn run(context: &Context<'_>, args: &RecommendArgs) -> Result<(), Failure> {
    let scene = context.scene(&args.scene, None)?;
    let results = match &args.results {
        Some(path) => bench::read(path)?,
        None => {
            let plan = Plan {
                frames: args.frames,
                ..Plan::new(args.size, &[])
            };
            let scene = std::slice::from_ref(&scene);
            bench::measure(context, scene, None, &[], plan, None)?
        }
    };
    bench::warn_of_opaque(context, &results);
    let rows = &results.measured.rows;
    let Candidates {
        points,
        of_scene,
        warning,
    } = points_for(rows, &scene);
    warning.iter().for_each(|text| context.console.warn(text));
    let from = match of_scene {
        true => "this scene",
        false => "all scenes of the results",
    };
    let budget = Budget {
        ms: args.budget_ms,
        error: args.max_error,
        bytes: args.max_bytes,
    };
    let chosen = budget.choose(&points).map_err(Failure::failed)?;
    let untimed = untimed(&Rows::new(rows));
    let adapter = &results.machine.adapter;
    // A point is of a row, and all rows are of one size.
    let (size, samples) = (rows.first()).map_or(([0; 2], 0), |r| ([r.width, r.height], r.samples));
    let line = |p: &Point| {
        let ratio = p.time.map(|_| format!(" ({})", p.time_text()));
        format!(
            "{}: {:.2} ms{}, {}, {:.0} bytes a pixel",
            p.method,
            p.time_ms,
            ratio.unwrap_or_default(),
            p.error_text(),
            p.bytes.most
        )
    };
    let text = || {
        let mut text = format!("{}\n  {}\n", line(chosen.best), chosen.why);
        if let Some(next) = chosen.runner_up {
            text.push_str(&format!("runner-up\n  {}\n", line(next)));
        }
        for (method, why) in &untimed {
            text.push_str(&format!("{method} is not among them: {why}\n"));
        }
        let [width, height] = size;
        text + &format!(
            "measured on {adapter} with {from}, at {width}x{height} with {samples} sample{} a pixel\n",
            if samples == 1 { "" } else { "s" }
        )
    };
    let point = |p: &Point| json!({"method": p.method, "time_ms": p.time_ms, "mse_linear": p.mse(), "bytes_per_pixel": p.bytes.most});
    let left_out = untimed
        .iter()
        .map(|(method, why)| json!({"method": method, "why": why}));
    context.console.result(text, || {
        json!({
            "method": chosen.best.method,
            "best": point(chosen.best),
            "runner_up": chosen.runner_up.map(point),
            "why": chosen.why,
            "without_time": left_out.collect::<Vec<_>>(),
            "adapter": adapter,
            "size": size,
            "samples": samples,
        })
    })
}
