//! `peelnet bench --effects`: what effects cost.

use super::{Context, bench::outputs};
use crate::cli::BenchArgs;
use crate::failure::Failure;
use crate::parse::{MethodList, command_line};
use crate::progress::Bar;
use peelnet_eval::{
    Machine,
    effects::{self, Effects, Settings},
};
use peelnet_render::Role;
use peelnet_report::Results;
use peelnet_scene::suite;
use serde_json::json;

/// Drawn where no method is named: one pass, nothing that could hide what an effect costs.
pub(super) const METHOD: &str = Role::WeightedBlending.method();

pub(super) fn run(context: &Context<'_>, args: &BenchArgs) -> Result<(), Failure> {
    let outputs = outputs(context, args, Results::<Effects>::FILES)?;
    let scenes = if args.scenes.is_empty() {
        context.shipped(suite::EFFECTS)?
    } else {
        context.scenes(&args.scenes)?
    };
    outputs.begin(&scenes)?;
    let method = match &args.methods {
        MethodList::These(methods) => methods.first().cloned(),
        MethodList::All => None,
    };
    let settings = Settings {
        method: method.map_or_else(|| METHOD.parse(), Ok)?,
        size: args.size.0,
        frames: args.frames.max(1),
    };
    let gpu = context.gpu()?;
    let bar = Bar::new(context.console, "effects", 0);
    let mut done = 0;
    let found = effects::measure(&gpu, &scenes, &settings, &args.out, context.stop, |what| {
        done += 1;
        bar.set(done, 0, what.to_owned());
    })?;
    drop(bar);
    let results = Results::new(Machine::of(&gpu), command_line(), found);
    results.write(&args.out)?;
    context.console.result(
        || {
            let tables = results.tables();
            let tables: Vec<String> = tables.map(|(_, table)| table.plain()).collect();
            tables.join("\n")
        },
        || json!(results),
    )
}
