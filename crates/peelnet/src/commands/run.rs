//! `peelnet run`: extract, train, export and compare in one go.

use super::{Context, extract, train};
use crate::cli::RunArgs;
use crate::failure::Failure;
use crate::learned;
use crate::outputs::Outputs;
use crate::parse::{Size, command_line, shown};
use crate::progress::Bar;
use crate::summary_text::{self, summary_text};
use peelnet_chart::Svg;
use peelnet_dataset::{Dataset, Format, SplitBy, Summary};
use peelnet_eval::bench::{self, bench_watched, trained_on};
use peelnet_eval::compare::{EXACT, Plan};
use peelnet_eval::front;
use peelnet_eval::{Machine, Partial, Row};
use peelnet_files::counted;
use peelnet_gpu::Gpu;
use peelnet_model::{Model, Recipe};
use peelnet_peel::{ExtractOptions, Peel, Views};
use peelnet_render::{LearnedWeight, MethodOptions, MethodSpec, Renderer, Role};
use peelnet_report::{Attachments, Results, Stage, ThesisRun, write_file};
use peelnet_scene::{Scene, suite};
use peelnet_train::{Config, CurveFormat, Outcome, RunOptions, curve_chart};
use serde_json::json;
use std::path::Path;
use std::time::Instant;

/// Shipped scenes whose names begin so are the thesis's family.
const FAMILY: &str = "sixteen-";

/// Beside each other on the first screen of the report, with [`SHOWN_NETWORKS`]: the base of the times, the exact image,
/// sorting, weighted blending, moments, and the networks.
const SHOWN: [&str; 8] = [
    front::BASE,
    EXACT,
    "painter-triangle",
    Role::WeightedBlending.method(),
    Role::MomentBlending.method(),
    Role::ThesisNetwork.method(),
    "deep-medium",
    "deep-large",
];

/// Of these the shipped networks are drawn, beside the one that the run trains.
const SHOWN_NETWORKS: [Recipe; 2] = [Recipe::MEDIUM, Recipe::LARGE];

/// The scene of it: held out, and of another kind than those of the run.
const SHOWN_SCENE: &str = "foliage-held";

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
        let mut config = Config::for_recipe(Recipe::THESIS);
        // The thesis tests on a third of the rows of the scenes that it trains on.
        config.split = SplitBy::Pixel;
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

/// The summary of the dataset, for programs and for people.
const SUMMARY: [&str; 2] = ["dataset-summary.json", "dataset-summary.txt"];

/// Everything that a run writes but its dataset, which has its own way.
fn outputs<'a>(context: &'a Context<'a>, args: &RunArgs) -> Result<Outputs<'a>, Failure> {
    let mut outputs = Outputs::new(context, &args.scenes);
    outputs.results("--out", &args.out, Results::<ThesisRun>::FILES)?;
    outputs.pictures("--out", &args.out.join("images"))?;
    peelnet_dataset::replaces(&args.out.join("dataset"), false)?;
    let summaries = SUMMARY.map(|name| (name, summary_text::KIND));
    let networks = [
        ("model.safetensors", peelnet_model::KIND),
        ("model.wgsl", peelnet_export::KIND),
        ("model.json", peelnet_export::JSON_KIND),
        ("loss.csv", CurveFormat::Csv.kind()),
        ("loss.svg", CurveFormat::Svg.kind()),
    ];
    outputs.folder("--out", &args.out, summaries.into_iter().chain(networks))?;
    Ok(outputs)
}

pub(super) fn run(context: &Context<'_>, args: &RunArgs) -> Result<(), Failure> {
    let outputs = outputs(context, args)?;
    let sizes = Sizes::of(args)?;
    let scenes = scenes(context, args)?;
    outputs.begin(&scenes)?;
    if scenes.iter().all(|s| s.held_out) {
        return Err(Failure::Usage(
            "every scene is marked held-out, so there is none to train on; add one that is not"
                .to_owned(),
        ));
    }
    let gpu = context.gpu()?;
    let clock = Clock {
        context,
        start: Instant::now(),
        stages: Vec::new(),
    };
    let mut run = Run {
        context,
        args,
        sizes,
        scenes,
        gpu,
        clock,
    };
    let share = run.count()?;
    let (dataset, summary) = run.extract(share)?;
    let (outcome, loss) = run.train(&dataset)?;
    let learned = run.export(&outcome.model)?;
    let images = args.out.join("images");
    let showcase = run.showcase(&learned, &images)?;
    let rows = run.compare(learned, &images)?;
    let mut results = Results::of_rows(Machine::of(&run.gpu), command_line(), rows);
    results.measured.settings = run.settings(share, &outcome.model);
    results.measured.trained_on = trained_on(&run.scenes, [&outcome.model]);
    results.measured.stages = run.clock.stages;
    results.measured.showcase = showcase;
    results.write(
        &args.out,
        &Attachments {
            images: Some(&images),
            loss: Some(&loss),
            dataset_summary: Some(&summary),
        },
    )?;
    context.console.message(format!(
        "the report is {}",
        shown(&args.out.join("report.html"))
    ));
    context.console.result(|| text(&results), || json!(results))
}

/// A run in progress: a method for each stage.
struct Run<'a> {
    context: &'a Context<'a>,
    args: &'a RunArgs,
    sizes: Sizes,
    scenes: Vec<Scene>,
    gpu: Gpu,
    clock: Clock<'a>,
}

impl Run<'_> {
    /// Counts, and returns the share of the pixels that has about as many rows as were asked for.
    fn count(&mut self) -> Result<f64, Failure> {
        let frame = self.sizes.frame;
        let fragments = count(&self.gpu, &self.scenes, frame)?;
        if fragments == 0 {
            return Err(Failure::Failed(
                "the scenes have no transparent fragment in view 0, so there is nothing to learn from; check cameras and alphas"
                    .to_owned(),
            ));
        }
        let note = format!(
            "about {} in the training scenes at {frame}",
            counted(fragments, "fragment")
        );
        self.clock.done("count", note)?;
        Ok((self.sizes.rows as f64 / fragments as f64).min(1.0))
    }

    /// Peels, and writes the dataset with its summary.
    fn extract(&mut self, share: f64) -> Result<(Dataset, String), Failure> {
        let out = &self.args.out;
        let folder = out.join("dataset");
        let report = extract::peel(
            self.context,
            &self.gpu,
            &self.scenes,
            &ExtractOptions {
                out: folder.clone(),
                size: self.sizes.frame.0,
                views: Views::All,
                format: Format::Parquet,
                peel: Peel::SBuffer,
                max_passes: None,
                pixels: share,
                augment: 0,
                seed: self.args.seed,
                shard: None,
                resume: false,
                command: command_line(),
                budget: None,
            },
        )?;
        self.clock
            .done("extract", extract::text(&folder, &report))?;
        let dataset = Dataset::open(&folder)?;
        let summary = Summary::of(&dataset)?;
        let text = summary_text(&summary);
        let json = format!("{:#}\n", json!(summary));
        write_file(&out.join(SUMMARY[0]), json)?;
        write_file(&out.join(SUMMARY[1]), &text)?;
        if !summary.passes() {
            return Err(Failure::Failed(format!(
                "{}: rows of the dataset disagree with one another, see dataset-summary.txt",
                shown(&folder)
            )));
        }
        self.clock
            .done("summary", format!("{} checks hold", summary.checks.len()))?;
        Ok((dataset, text))
    }

    /// Trains, and writes the model and the loss curve.
    fn train(&mut self, dataset: &Dataset) -> Result<(Outcome, Svg), Failure> {
        let out = &self.args.out;
        let model = out.join("model.safetensors");
        let mut options = RunOptions::new(&model, self.context.stop);
        options.loss_curve = vec![out.join("loss.csv"), out.join("loss.svg")];
        let datasets = std::slice::from_ref(dataset);
        let outcome = train::fit(self.context, &self.sizes.config, datasets, &options)?;
        let note = train::text(&model, &outcome).replace('\n', "; ");
        self.clock.done("train", note)?;
        let loss = curve_chart(&outcome.history);
        Ok((outcome, loss))
    }

    /// Exports the model as shader text, which the comparison draws with.
    fn export(&mut self, model: &Model) -> Result<LearnedWeight, Failure> {
        let path = self.args.out.join("model.wgsl");
        let options = peelnet_export::Options::default();
        let verification = peelnet_export::export(&self.gpu, model, &path, &options)?;
        let note = format!("{}: {verification}", shown(&path));
        self.clock.done("export", note)?;
        Ok(LearnedWeight {
            recipe: model.meta.recipe,
            wgsl: std::fs::read_to_string(&path)
                .map_err(|e| Failure::Failed(format!("{}: {e}", shown(&path))))?,
        })
    }

    /// The shipped networks beside the trained one and what they compete with, timed, on a scene that none of them saw; where scenes
    /// were named, on the first of them that is held out.
    fn showcase(&mut self, trained: &LearnedWeight, images: &Path) -> Result<Vec<Row>, Failure> {
        let scene = if self.args.scenes.is_empty() {
            suite::load(SHOWN_SCENE)?
        } else {
            let held_out = self.scenes.iter().find(|s| s.held_out);
            match held_out {
                Some(scene) => scene.clone(),
                None => return Ok(Vec::new()),
            }
        };
        let mut learned = vec![trained.clone()];
        for recipe in SHOWN_NETWORKS {
            learned.push(learned::text_of(&self.gpu, &Model::shipped(recipe)?)?);
        }
        let methods: Vec<MethodSpec> = SHOWN.iter().map(|m| m.parse()).collect::<Result<_, _>>()?;
        let plan = Plan {
            learned: &learned,
            lenient: true,
            images: Some(images),
            ..Plan::new(self.sizes.frame.0, &methods)
        };
        self.draw("showcase", std::slice::from_ref(&scene), &plan)
    }

    /// Every method that there is, and the learned one, on every view of every scene.
    fn compare(&mut self, learned: LearnedWeight, images: &Path) -> Result<Vec<Row>, Failure> {
        let mut methods = MethodSpec::all();
        methods.push(learned.recipe.method.parse()?);
        let learned = [learned];
        let plan = Plan {
            learned: &learned,
            lenient: true,
            frames: 0,
            images: Some(images),
            ..Plan::new(self.sizes.frame.0, &methods)
        };
        let scenes = std::mem::take(&mut self.scenes);
        let rows = self.draw("compare", &scenes, &plan);
        self.scenes = scenes;
        rows
    }

    /// Draws the scenes by a plan, with a progress bar.
    fn draw(
        &mut self,
        stage: &'static str,
        scenes: &[Scene],
        plan: &Plan<'_>,
    ) -> Result<Vec<Row>, Failure> {
        let frame = self.sizes.frame;
        let console = self.context.console;
        let views: usize = scenes.iter().map(|s| s.views.len()).sum();
        let names: Vec<&str> = scenes.iter().map(|s| s.name.as_str()).collect();
        console.message(format!(
            "{stage}: {} on {} of {}",
            counted(plan.methods.len() as u64, "method"),
            counted(views as u64, "view"),
            names.join(", ")
        ));
        let bar = Bar::new(console, stage, 0);
        let mut show = |event: bench::Progress<'_>| match event {
            bench::Progress::Drawn {
                done,
                total,
                scene,
                method,
            } => bar.set(done, total, format!("{scene} with {method}")),
            bench::Progress::LeftOut { scene, method, why } => {
                console.warn(format!("{method} is left out of {scene}: {why}"));
            }
        };
        let partial = Partial::new(None, serde_json::Value::Null);
        let stop = self.context.stop;
        let bench = bench_watched(&self.gpu, scenes, plan, partial, stop, &mut show)?;
        drop(bar);
        let frames = counted(bench.rows.len() as u64, "frame");
        self.clock.done(stage, format!("{frames} at {frame}"))?;
        Ok(bench.rows)
    }

    /// What the report says about the run beside the machine.
    fn settings(&self, share: f64, model: &Model) -> Vec<(String, String)> {
        let names = |held_out: bool| {
            let scenes = self.scenes.iter().filter(|s| s.held_out == held_out);
            let names: Vec<&str> = scenes.map(|s| s.name.as_str()).collect();
            if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            }
        };
        let sizes = if self.args.full { "full" } else { "quick" };
        let c = &self.sizes.config;
        let training = format!(
            "recipe {}, {}, {} epochs, batch {}, rate {}, {:.0} % of the pixels of the same scenes held out, seed {}",
            c.recipe,
            model.mlp.topology(),
            c.epochs,
            c.batch,
            c.learning_rate,
            c.held_out * 100.0,
            c.seed
        );
        let losses = &model.meta.losses;
        let losses: Vec<String> = [
            ("training", losses.train),
            ("validation", losses.validation),
            ("test", losses.test),
        ]
        .into_iter()
        .filter_map(|(name, loss)| loss.map(|l| format!("{name} {l:.6}")))
        .collect();
        [
            ("sizes", sizes.to_owned()),
            ("frame", self.sizes.frame.to_string()),
            ("scenes trained on", names(false)),
            ("scenes held out", names(true)),
            ("share of pixels sampled", format!("{share:.4}")),
            ("training", training),
            ("loss", losses.join(", ")),
        ]
        .map(|(k, v)| (k.to_owned(), v))
        .to_vec()
    }
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
        let mut prepared = renderer.method(&exact, MethodOptions::sized(frame.0))?;
        let stats = renderer.image(&mut prepared, camera)?.stats;
        fragments += stats.fragments.unwrap_or(0) * scene.views.len() as u64;
    }
    Ok(fragments)
}

/// The table and the findings.
fn text(results: &Results<ThesisRun>) -> String {
    let findings = results.measured.findings.iter();
    let findings: String = findings.map(|f| format!("- {f}\n")).collect();
    format!(
        "{}\nmean squared error, 0–255 scale, against the exact image\n\n{findings}",
        results.table().plain()
    )
}
