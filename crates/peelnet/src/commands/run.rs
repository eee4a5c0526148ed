//! `peelnet run`: extract, train, export and compare in one go.

use super::{Context, extract, train};
use crate::cli::RunArgs;
use crate::failure::Failure;
use crate::parse::{Size, command_line};
use crate::progress::{Progress, thousands};
use crate::summary_text::summary_text;
use peelnet_dataset::{Dataset, Format, Summary};
use peelnet_eval::compare::{EXACT, Event, Plan, compare};
use peelnet_eval::report::Attachments;
use peelnet_eval::table::{Table, plain};
use peelnet_eval::{Machine, Record, Row, Stage, write_atomically};
use peelnet_gpu::Gpu;
use peelnet_model::Recipe;
use peelnet_peel::{ExtractOptions, Peel, Views};
use peelnet_render::{LearnedWeight, MethodSpec, Renderer};
use peelnet_scene::{Scene, suite};
use peelnet_train::{Config, RunOptions};
use serde_json::json;
use std::path::Path;
use std::time::Instant;

/// Shipped scenes whose names begin so are the thesis's family.
const FAMILY: &str = "sixteen-";

/// The sizes of a run.
struct Sizes {
    frame: Size,
    rows: u64,
    config: Config,
}

impl Sizes {
    /// The quick sizes end within minutes on two cores without a GPU; the full ones are the thesis's.
    fn of(args: &RunArgs) -> Result<Self, Failure> {
        let (frame, rows) = if args.full {
            (Size([1024, 768]), 1_500_000)
        } else {
            (Size([512, 384]), 300_000)
        };
        let mut config = Config::for_recipe(Recipe::Thesis);
        config.seed = args.seed;
        config.epochs = args.epochs.unwrap_or(config.epochs);
        Ok(Self {
            frame: args.size.unwrap_or(frame),
            rows: args.rows.unwrap_or(rows),
            config,
        })
    }
}

/// Stages with their times.
struct Clock<'a> {
    context: &'a Context<'a>,
    start: Instant,
    stages: Vec<Stage>,
}

impl Clock<'_> {
    /// Ends a stage and begins the next.
    fn done(&mut self, name: &str, note: String) -> Result<(), Failure> {
        let seconds = self.start.elapsed().as_secs_f64();
        self.context
            .console
            .message(format!("{name}: {note} ({seconds:.1} s)"));
        self.stages.push(Stage {
            name: name.to_owned(),
            seconds,
            note,
        });
        self.start = Instant::now();
        self.context.check_interrupt()
    }
}

pub(super) fn run(context: &Context<'_>, args: &RunArgs) -> Result<(), Failure> {
    let sizes = Sizes::of(args)?;
    let scenes = scenes(context, args)?;
    if scenes.iter().all(|s| s.held_out) {
        return Err(Failure::Usage(
            "every scene is marked held-out, so there is none to train on; add one that is not"
                .to_owned(),
        ));
    }
    let gpu = context.gpu()?;
    let mut clock = Clock {
        context,
        start: Instant::now(),
        stages: Vec::new(),
    };

    // Count, so that about as many rows are sampled as were asked for.
    let fragments = count(&gpu, &scenes, sizes.frame)?;
    if fragments == 0 {
        return Err(Failure::Failed(
            "the scenes have no transparent fragment in view 0, so there is nothing to learn from; check cameras and alphas"
                .to_owned(),
        ));
    }
    let share = (sizes.rows as f64 / fragments as f64).min(1.0);
    clock.done(
        "count",
        format!(
            "about {} fragments in the training scenes at {}",
            thousands(fragments),
            sizes.frame
        ),
    )?;

    let folder = args.out.join("dataset");
    let report = extract::peel(
        context,
        &gpu,
        &scenes,
        &ExtractOptions {
            out: folder.clone(),
            size: sizes.frame.0,
            views: Views::All,
            format: Format::Parquet,
            peel: Peel::SBuffer,
            max_passes: None,
            pixels: share,
            augment: 0,
            seed: args.seed,
            shard: None,
            command: command_line(),
            budget: None,
        },
    )?;
    clock.done("extract", extract::text(&folder, &report))?;

    let dataset = Dataset::open(&folder)?;
    let summary = Summary::of(&dataset)?;
    let summary_text = summary_text(&summary);
    let summary_json = format!("{:#}\n", json!(summary));
    write_atomically(
        &args.out.join("dataset-summary.json"),
        summary_json.as_bytes(),
    )?;
    write_atomically(
        &args.out.join("dataset-summary.txt"),
        summary_text.as_bytes(),
    )?;
    if !summary.passes() {
        return Err(Failure::Failed(format!(
            "{}: rows of the dataset disagree with one another, see dataset-summary.txt",
            folder.display()
        )));
    }
    clock.done("summary", format!("{} checks hold", summary.checks.len()))?;

    let model_path = args.out.join("model.safetensors");
    let mut options = RunOptions::new(&model_path, context.stop);
    let svg_path = args.out.join("loss.svg");
    options.loss_curve = vec![args.out.join("loss.csv"), svg_path.clone()];
    let outcome = train::fit(
        context,
        &sizes.config,
        std::slice::from_ref(&dataset),
        &options,
    )?;
    clock.done(
        "train",
        train::text(&model_path, &outcome).replace('\n', "; "),
    )?;

    let wgsl_path = args.out.join("model.wgsl");
    let verification = peelnet_export::export(
        &gpu,
        &outcome.model,
        &wgsl_path,
        &peelnet_export::Options::default(),
    )?;
    // The comparison draws with the very text that was written.
    let learned = LearnedWeight {
        recipe: outcome.model.meta.recipe,
        wgsl: std::fs::read_to_string(&wgsl_path)
            .map_err(|e| Failure::Failed(format!("{}: {e}", wgsl_path.display())))?,
    };
    clock.done("export", format!("{}: {verification}", wgsl_path.display()))?;

    let images = args.out.join("images");
    let rows = compare_all(context, &gpu, &scenes, sizes.frame, learned, &images)?;
    clock.done(
        "compare",
        format!("{} frames at {}", thousands(rows.len() as u64), sizes.frame),
    )?;

    let mut record = Record::new(Machine::of(&gpu), command_line(), rows);
    record.stages = clock.stages;
    record.settings = settings(args, &sizes, &scenes, share, &outcome.model);
    let svg = std::fs::read_to_string(&svg_path).ok();
    record.write(
        &args.out,
        &Attachments {
            images: Some(&images),
            loss_svg: svg.as_deref(),
            dataset_summary: Some(&summary_text),
        },
    )?;
    context.console.message(format!(
        "the report is {}",
        args.out.join("report.html").display()
    ));
    context.console.result(|| text(&record), || json!(record))
}

/// The scenes to work on: those named, or the shipped family.
fn scenes(context: &Context<'_>, args: &RunArgs) -> Result<Vec<Scene>, Failure> {
    if !args.scenes.is_empty() {
        return context.scenes(&args.scenes);
    }
    let all = suite::SCENES.iter();
    context.shipped(all.filter(|file| file.name.starts_with(FAMILY)))
}

/// Fragments of the training scenes' views, estimated from view 0 of each.
fn count(gpu: &Gpu, scenes: &[Scene], frame: Size) -> Result<u64, Failure> {
    let exact: MethodSpec = EXACT.parse()?;
    let mut fragments = 0;
    for scene in scenes.iter().filter(|s| !s.held_out) {
        let Some(camera) = scene.views.first() else {
            continue;
        };
        let renderer = Renderer::new(gpu, scene)?;
        let mut prepared = renderer.prepare(&exact, frame.0, None)?;
        let stats = renderer.draw(&mut prepared, camera)?.stats;
        fragments += stats.fragments.unwrap_or(0) * scene.views.len() as u64;
    }
    Ok(fragments)
}

/// Every method that there is, and the learned one, on every view of every scene.
fn compare_all(
    context: &Context<'_>,
    gpu: &Gpu,
    scenes: &[Scene],
    frame: Size,
    learned: LearnedWeight,
    images: &Path,
) -> Result<Vec<Row>, Failure> {
    let mut methods = MethodSpec::all();
    methods.push(learned.recipe.method_name().parse()?);
    let learned = [learned];
    let plan = Plan {
        size: frame.0,
        methods: &methods,
        learned: &learned,
        models: &[],
        lenient: true,
        views: None,
        frames: 0,
        images: Some(images),
    };
    let views: usize = scenes.iter().map(|s| s.views.len()).sum();
    let frames = (views * methods.len()) as u64;
    context.console.message(format!(
        "comparing {} methods on {views} views of {} scenes",
        methods.len(),
        scenes.len()
    ));
    let bar = Progress::new(context.console, "compare", frames);
    let mut done = 0;
    let mut rows = Vec::new();
    for scene in scenes {
        compare(gpu, scene, &plan, &[], context.stop, &mut |event| {
            match event {
                Event::Drawn(method) => {
                    done += 1;
                    bar.set(done, frames, format!("{} with {method}", scene.name));
                }
                Event::LeftOut(method, why) => context
                    .console
                    .warn(format!("{method} is left out of {}: {why}", scene.name)),
                Event::View(of_view) => rows.extend(of_view),
            }
            Ok(())
        })?;
    }
    Ok(rows)
}

/// What the report says about the run beside the machine.
fn settings(
    args: &RunArgs,
    sizes: &Sizes,
    scenes: &[Scene],
    share: f64,
    model: &peelnet_model::Model,
) -> Vec<(String, String)> {
    let names = |held_out: bool| -> String {
        let names: Vec<&str> = scenes
            .iter()
            .filter(|s| s.held_out == held_out)
            .map(|s| s.name.as_str())
            .collect();
        if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        }
    };
    let c = &sizes.config;
    [
        ("sizes", if args.full { "full" } else { "quick" }.to_owned()),
        ("frame", sizes.frame.to_string()),
        ("scenes trained on", names(false)),
        ("scenes held out", names(true)),
        ("share of pixels sampled", format!("{share:.4}")),
        (
            "training",
            format!(
                "recipe {}, {}, {} epochs, batch {}, rate {}, {:.0} % of the rows held out, seed {}",
                c.recipe,
                model.mlp.topology(),
                c.epochs,
                c.batch,
                c.learning_rate,
                c.held_out * 100.0,
                c.seed
            ),
        ),
        (
            "loss",
            [
                ("training", model.meta.losses.train),
                ("validation", model.meta.losses.validation),
                ("test", model.meta.losses.test),
            ]
            .into_iter()
            .filter_map(|(name, loss)| loss.map(|l| format!("{name} {l:.6}")))
            .collect::<Vec<_>>()
            .join(", "),
        ),
    ]
    .map(|(k, v)| (k.to_owned(), v))
    .to_vec()
}

/// The table and the findings.
fn text(record: &Record) -> String {
    let table = Table::of(&record.rows);
    let findings: String = record.findings.iter().map(|f| format!("- {f}\n")).collect();
    format!(
        "{}\nmean squared error, 0–255 scale, against the exact image\n\n{findings}",
        plain(&table.headings(), &table.cells())
    )
}
