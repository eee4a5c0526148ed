//! `peelnet run`: extract, train, export and compare in one go.

use super::{Context, bench, command_line, count, extract, losses, train};
use crate::cli::RunArgs;
use crate::summary_text::{self, summary_text};
use peelnet::Failure;
use peelnet::loss_curve::{curve_chart, curve_kind};
use peelnet_bench::bench::{bench_watched, trained_on};
use peelnet_bench::chart::Svg;
use peelnet_bench::compare::{EXACT, Plan};
use peelnet_bench::front;
use peelnet_bench::report::{Results, Stage, ThesisRun, write_file};
use peelnet_bench::{Machine, Partial, Row};
use peelnet_core::files::{counted, one_line, shown};
use peelnet_dataset::{Dataset, SplitBy, Summary};
use peelnet_model::{Model, Recipe};
use peelnet_peel::ExtractOptions;
use peelnet_render::gpu::Gpu;
use peelnet_render::{LearnedWeight, MethodSpec, role};
use peelnet_scene::{Scene, suite};
use peelnet_train::{Config, Outcome, OutputLock, RunOptions};
use serde_json::json;
use std::time::Instant;

/// Shipped scenes whose names begin so are the thesis's family.
const FAMILY: &str = "sixteen-";

/// Beside each other on the first screen of the report: the base of the times, the exact image, sorting, weighted blending, moments, the
/// network that the run trains, and shipped ones.
const SHOWN: [&str; 8] = [
    front::BASE,
    EXACT,
    "painter-triangle",
    role::WEIGHTED_BLENDING,
    role::MOMENT_BLENDING,
    role::THESIS_NETWORK,
    "deep-medium",
    "deep-large",
];

/// The scene of it: held out, and of another kind than those of the run.
const SHOWN_SCENE: &str = "foliage-held";

const MODEL: &str = "model.safetensors";

pub(super) fn run(context: &Context<'_>, args: &RunArgs) -> Result<(), Failure> {
    let mut outputs = context.results::<ThesisRun>(&args.scenes, &args.out)?;
    peelnet_dataset::replaces(&args.out.join("dataset"), false)?;
    let files = [
        ("dataset-summary.json", summary_text::KIND),
        ("dataset-summary.txt", summary_text::KIND),
        (MODEL, peelnet_model::KIND),
        ("model.wgsl", peelnet_export::KIND),
        ("model.json", peelnet_export::JSON_KIND),
        ("loss.csv", curve_kind("loss.csv".as_ref())?),
        ("loss.svg", curve_kind("loss.svg".as_ref())?),
    ];
    outputs.folder("--out", &args.out, files)?;
    let scenes = if args.scenes.is_empty() {
        let family = suite::SCENES.iter().filter(|f| f.name.starts_with(FAMILY));
        let family = family.map(|file| suite::load_file(file, None));
        family.collect::<Result<_, _>>()?
    } else {
        context.scenes(&args.scenes)?
    };
    let _begun = context.begin_in(&args.out, outputs, &scenes)?;
    if scenes.iter().all(|s| s.held_out) {
        return Err(Failure::wrong(
            "every scene is marked held-out, so there is none to train on; add one that is not",
        ));
    }
    // The quick sizes end within minutes on two cores without a GPU; the full ones are the thesis's.
    let (frame, rows) = match args.full {
        true => ([1024, 768], 1_500_000),
        false => ([512, 384], 300_000),
    };
    let recipe = Config::for_recipe(Recipe::THESIS);
    let config = Config {
        // The thesis tests on a third of the rows of the scenes that it trains on.
        split: SplitBy::Pixel,
        seed: args.seed,
        epochs: args.epochs.unwrap_or(recipe.epochs),
        ..recipe
    };
    config.check()?;
    let mut run = Run {
        context,
        args,
        frame: args.size.unwrap_or(frame),
        rows: args.rows.unwrap_or(rows),
        config,
        scenes: &scenes,
        gpu: context.gpu()?,
        lock: OutputLock::take(&args.out.join(MODEL))?,
        start: Instant::now(),
        stages: Vec::new(),
    };
    let share = run.count()?;
    let (dataset, summary) = run.extract(share)?;
    // The dataset and the model are new from now on: what is reported of older ones must not stay beside them if this run ends early.
    for name in Results::<ThesisRun>::files() {
        let file = args.out.join(name);
        peelnet_core::files::remove_replaced(&file)
            .map_err(|e| Failure::failed(format!("{}: {e}", shown(&file))))?;
    }
    let (outcome, loss) = run.train(&dataset)?;
    let learned = run.export(&outcome.model)?;
    let showcase = run.showcase(&learned)?;
    // Every method that there is, and the learned one, on every view of every scene.
    let mut methods = MethodSpec::all();
    methods.push(learned.recipe.method.parse()?);
    let rows = run.draw("compare", &scenes, &methods, &learned, 0)?;
    let mut results = Results::of_rows(Machine::describe(&run.gpu), command_line(), rows);
    results.measured.settings = run.settings(share, &outcome.model);
    results.measured.trained_on = trained_on(&scenes, [&outcome.model]);
    results.measured.stages = run.stages;
    results.measured.showcase = showcase;
    results.measured.loss = Some(loss);
    results.measured.dataset_summary = Some(summary);
    results.write(&args.out)?;
    let report = shown(&args.out.join("report.html"));
    context.console.message(format!("the report is {report}"));
    context.console.result(|| text(&results), || json!(results))
}

/// A run in progress: a method for each stage.
struct Run<'a> {
    context: &'a Context<'a>,
    args: &'a RunArgs,
    frame: [u32; 2],
    /// To train on, about.
    rows: u64,
    config: Config,
    /// Of the network: a second run into the folder is refused.
    lock: OutputLock,
    scenes: &'a [Scene],
    gpu: Gpu,
    /// Of the stage.
    start: Instant,
    stages: Vec<Stage>,
}

impl Run<'_> {
    /// Ends a stage and begins the next.
    fn done(&mut self, name: &str, note: String) -> Result<(), Failure> {
        let seconds = self.start.elapsed().as_secs_f64();
        let message = format!("{name}: {note} ({seconds:.1} s)");
        self.context.console.message(message);
        self.stages.push(Stage {
            name: name.to_owned(),
            seconds,
            note,
        });
        self.start = Instant::now();
        self.context.check_interrupt()
    }

    fn size(&self) -> String {
        format!("{}x{}", self.frame[0], self.frame[1])
    }

    /// Counts the fragments of the training scenes' views, estimated from view 0 of each, and returns the share of the pixels that has
    /// about as many rows as were asked for.
    fn count(&mut self) -> Result<f64, Failure> {
        let mut fragments = 0;
        let seen = |scene: &&Scene| !scene.held_out && !scene.views.is_empty();
        for scene in self.scenes.iter().filter(seen) {
            let of_view = count(&self.gpu, scene, self.frame)?.fragments;
            fragments += of_view.unwrap_or(0) * scene.views.len() as u64;
        }
        if fragments == 0 {
            return Err(Failure::failed(
                "the scenes have no transparent fragment in view 0, so there is nothing to learn from; check cameras and alphas",
            ));
        }
        let (counted, size) = (counted(fragments, "fragment"), self.size());
        let note = format!("about {counted} in the training scenes at {size}");
        self.done("count", note)?;
        Ok((self.rows as f64 / fragments as f64).min(1.0))
    }

    /// Peels, and writes the dataset with its summary.
    fn extract(&mut self, share: f64) -> Result<(Dataset, String), Failure> {
        let out = &self.args.out;
        let folder = out.join("dataset");
        let options = ExtractOptions {
            size: self.frame,
            pixels: share,
            seed: self.args.seed,
            command: command_line(),
            ..ExtractOptions::new(&folder)
        };
        let report = extract::peel(self.context, &self.gpu, self.scenes, &options)?;
        self.done("extract", extract::text(&folder, &report))?;
        let dataset = Dataset::open(&folder)?;
        let summary = Summary::from_dataset(&dataset)?;
        let text = summary_text(&summary);
        let json = format!("{:#}\n", json!(summary));
        write_file(&out.join("dataset-summary.json"), json)?;
        write_file(&out.join("dataset-summary.txt"), &text)?;
        if !summary.passes() {
            return Err(Failure::failed(format!(
                "{}: rows of the dataset disagree with one another, see dataset-summary.txt",
                shown(&folder)
            )));
        }
        self.done("summary", format!("{} checks hold", summary.checks.len()))?;
        Ok((dataset, text))
    }

    /// Trains, and writes the model and the loss curve.
    fn train(&mut self, dataset: &Dataset) -> Result<(Outcome, Svg), Failure> {
        let out = &self.args.out;
        let model = out.join(MODEL);
        let options = RunOptions {
            lock: Some(&self.lock),
            ..RunOptions::new(&model, self.context.stop)
        };
        let curves = [out.join("loss.csv"), out.join("loss.svg")];
        let datasets = std::slice::from_ref(dataset);
        let (context, config, anew) = (self.context, &self.config, train::Continues::Anew);
        let outcome = train::fit(context, config, datasets, &options, &curves, anew)?;
        let note = train::text(&model, &outcome).replace('\n', "; ");
        self.done("train", note)?;
        let loss = curve_chart(&outcome.history);
        Ok((outcome, loss))
    }

    fn export(&mut self, model: &Model) -> Result<LearnedWeight, Failure> {
        let path = self.args.out.join("model.wgsl");
        let options = peelnet_export::Options::default();
        let verification = peelnet_export::export(&self.gpu, model, &path, &options)?;
        let note = format!("{}: {verification}", shown(&path));
        self.done("export", note)?;
        Ok(LearnedWeight {
            recipe: model.meta.recipe,
            wgsl: std::fs::read_to_string(&path)
                .map_err(|e| Failure::from(e).about(&shown(&path)))?,
        })
    }

    /// The shipped networks beside the trained one and what they compete with, timed, on a scene that none of them saw; where scenes
    /// were named, on the first of them that is held out.
    fn showcase(&mut self, trained: &LearnedWeight) -> Result<Vec<Row>, Failure> {
        let scene = if self.args.scenes.is_empty() {
            suite::load(SHOWN_SCENE)?
        } else {
            match self.scenes.iter().find(|s| s.held_out) {
                Some(scene) => scene.clone(),
                None => return Ok(Vec::new()),
            }
        };
        let methods: Vec<MethodSpec> = SHOWN.iter().map(|m| m.parse()).collect::<Result<_, _>>()?;
        let scenes = std::slice::from_ref(&scene);
        self.draw("showcase", scenes, &methods, trained, 5)
    }

    /// Draws the scenes with methods, so many timed frames of each, with a progress bar.
    fn draw(
        &mut self,
        stage: &'static str,
        scenes: &[Scene],
        methods: &[MethodSpec],
        learned: &LearnedWeight,
        frames: u32,
    ) -> Result<Vec<Row>, Failure> {
        let context = self.context;
        let images = self.args.out.join("images");
        let plan = Plan {
            learned: std::slice::from_ref(learned),
            lenient: true,
            frames,
            images: Some(&images),
            ..Plan::new(self.frame, methods)
        };
        let views: usize = scenes.iter().map(|s| s.views.len()).sum();
        let names: Vec<&str> = scenes.iter().map(|s| s.name.as_str()).collect();
        context.console.message(format!(
            "{stage}: {} on {} of {}",
            counted(plan.methods.len() as u64, "method"),
            counted(views as u64, "view"),
            names.join(", ")
        ));
        let partial = Partial::new(None, serde_json::Value::Null);
        let bench = {
            let show = &mut bench::show(context, stage);
            bench_watched(&self.gpu, scenes, &plan, partial, context.stop, show)?
        };
        let frames = counted(bench.rows.len() as u64, "frame");
        let note = format!("{frames} at {}", self.size());
        self.done(stage, note)?;
        Ok(bench.rows)
    }

    /// What the report says about the run beside the machine.
    fn settings(&self, share: f64, model: &Model) -> Vec<(String, String)> {
        let names = |held_out: bool| {
            let scenes = self.scenes.iter().filter(|s| s.held_out == held_out);
            let mut names: Vec<&str> = scenes.map(|s| s.name.as_str()).collect();
            if names.is_empty() {
                names.push("none");
            }
            names.join(", ")
        };
        let sizes = if self.args.full { "full" } else { "quick" };
        let c = &self.config;
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
        let losses = losses(model).into_iter();
        let losses: Vec<String> = losses.map(|(name, l)| format!("{name} {l:.6}")).collect();
        [
            ("sizes", sizes.to_owned()),
            ("frame", self.size()),
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

fn text(results: &Results<ThesisRun>) -> String {
    let findings = results.measured.findings.iter();
    let findings: String = findings.map(|f| format!("- {}\n", one_line(f))).collect();
    format!(
        "{}\nmean squared error, 0–255 scale, against the exact image\n\n{findings}",
        results.table().plain()
    )
}
