//! `peelnet bench --path`: methods along a camera path, with moving objects.

use super::{
    Context,
    bench::{Chosen, chosen, one_of_each, outputs},
};
use crate::cli::BenchArgs;
use crate::failure::Failure;
use crate::parse::{MethodList, command_line};
use crate::progress::Bar;
use peelnet_eval::{
    Machine,
    bench::Progress,
    path::{self, Along, Settings},
};
use peelnet_report::Results;
use serde_json::json;

pub(super) fn run(context: &Context<'_>, args: &BenchArgs) -> Result<(), Failure> {
    if args.frames == 0 {
        return Err(Failure::Usage(
            "--frames 0: a path has at least one frame".to_owned(),
        ));
    }
    let outputs = outputs(context, args, Results::<Along>::FILES)?;
    let scenes = context.scenes(&args.scenes)?;
    outputs.begin(&scenes)?;
    let gpu = context.gpu()?;
    // A path costs as much as sixty views.
    let Chosen {
        methods, learned, ..
    } = chosen(context, &gpu, &args.methods, &args.models, one_of_each)?;
    let images = args.out.join("images");
    let settings = Settings {
        size: args.size.0,
        samples: args.samples,
        frames: args.frames,
        methods: &methods,
        learned: &learned,
        lenient: matches!(args.methods, MethodList::All),
        images: Some(&images),
    };
    let bar = Bar::new(context.console, "path", 0);
    let mut show = |event: Progress<'_>| match event {
        Progress::Drawn {
            done,
            total,
            scene,
            method,
        } => bar.set(done, total, format!("{scene} with {method}")),
        Progress::LeftOut { scene, method, why } => context
            .console
            .warn(format!("{method} is left out of {scene}: {why}")),
    };
    let found = path::measure(&gpu, &scenes, &settings, context.stop, &mut show)?;
    drop(bar);
    context.warn_of_memory(&gpu);
    let results = Results::new(Machine::of(&gpu), command_line(), found);
    results.write(&args.out)?;
    context
        .console
        .result(|| results.table().plain(), || json!(results))
}
