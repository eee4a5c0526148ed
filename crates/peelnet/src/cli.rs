//! The commands and their flags. The names are fixed: scripts call them.

mod bench;
#[cfg(test)]
mod tests;

pub use bench::*;

use crate::values::{SAMPLES, fraction, methods, one_of, positive, size, views};
use clap::{Args, Parser, Subcommand};
use peelnet::{LANGUAGES, PRECISIONS, SCHEDULES, SPLITS};
use peelnet_bench::stress::{CASES, Case};
use peelnet_dataset::{Format, Shard, SplitBy};
use peelnet_export::{Language, Precision};
use peelnet_model::Recipe;
use peelnet_peel::Peel;
use peelnet_render::gpu::AdapterRequest;
use peelnet_render::{LayerFormula, MethodSpec};
use peelnet_train::{PixelLoss, Schedule};
use std::path::PathBuf;

/// A value that may be absent although its flag always has one, such as `all`.
type OrAll<T> = Option<T>;

/// Learned order-independent transparency: peel scenes, train a network on their fragments, export it as shader
/// code, and draw with it.
#[derive(Debug, Parser)]
#[command(
    name = "peelnet",
    version,
    subcommand_required = true,
    arg_required_else_help = true,
    after_help = "Examples:
  peelnet doctor                                        what will be used, and why
  peelnet run --out out/demo                            everything, on the shipped scenes
  peelnet extract sixteen-050 --out d                   peel a scene
  peelnet train d --out m.safetensors                   train a network on it
  peelnet export m.safetensors --out w.wgsl             export it as shader code
  peelnet render sixteen-050 --method deep-medium --model m.safetensors --out a.png
  peelnet recommend cups --budget-ms 30                 which method to use

Results go to stdout, messages to stderr. Exit codes: 0 done, 1 failed, 2 wrong usage, 130 and 143 interrupted.
An output replaces only a file of its own kind that may be written, any file with --force, never a link (one to a folder on the way is followed), a device or a pipe; - is stdout. A folder of a dataset replaces only a dataset.
NO_COLOR switches colours off."
)]
pub struct Cli {
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Clone, Debug, Args)]
pub struct Global {
    /// The GPU to use: part of an adapter's name, or "software"
    #[arg(
        long,
        global = true,
        value_name = "NAME|software",
        default_value = "auto",
        hide_default_value = true
    )]
    pub adapter: AdapterRequest,
    /// No messages and no progress on stderr, only warnings and errors
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// The result as JSON
    #[arg(long, global = true)]
    pub json: bool,
    /// Let outputs replace any file, also what peelnet did not write and what the command reads
    #[arg(long, global = true)]
    pub force: bool,
    /// A folder in which mesh files may name textures and buffers, beside their own and the scene's; may be repeated
    #[arg(long, global = true, value_name = "DIR", hide_short_help = true)]
    pub files_from: Vec<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Extract, train, export and compare in one command
    Run(RunArgs),
    /// Peel scenes on the GPU and write per-fragment features
    Extract(ExtractArgs),
    /// Seal a dataset that several writers finished
    Seal(SealArgs),
    /// Train a network on a dataset
    Train(TrainArgs),
    /// Export a network as shader code
    Export(ExportArgs),
    /// Draw a scene with one method
    Render(RenderArgs),
    /// Open the viewer: every method live, with its error
    View(ViewArgs),
    /// Compare many methods: error against time
    Bench(BenchArgs),
    /// Draw the cases where transparency is known to break, and report what holds
    Stress(StressArgs),
    /// Recommend the method for a budget of time, error or memory
    Recommend(RecommendArgs),
    /// Describe a scene, a dataset or a model
    Inspect(InspectArgs),
    /// List the adapters, which one is used, and why
    Doctor,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet run --out out/demo              the shipped sixteen-model scenes, in minutes without a GPU
  peelnet run --out out/full --full       the thesis's recipe in full: 1024x768, 1.5 million rows, 150 epochs
  peelnet run my.toml --out out/mine      the same for a scene of your own

DIR gets dataset/, dataset-summary.json and .txt, loss.csv, loss.svg, model.safetensors, model.wgsl, model.json, images/,
table.md, results.json and report.html. Scenes that are marked held-out are compared but never trained on.")]
pub struct RunArgs {
    /// Scene files, or names of shipped scenes; by default the shipped sixteen-model scenes
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// Output folder
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The thesis's full-size recipe instead of the quick one
    #[arg(long)]
    pub full: bool,
    /// Frame size [default: 512x384, with --full 1024x768]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Approximate number of rows to train on; pixels are sampled to reach it [default: 300000, with --full 1500000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub rows: Option<u64>,
    /// Passes over the training rows [default: the recipe's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub epochs: Option<u32>,
    /// Seed of sampling and training
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet extract sixteen-050 --out d
  peelnet extract data/scenes/*.toml --out d --views all --pixels 0.1 --augment 4 --seed 7
  peelnet extract scene.toml --out d --format csv --size 640x480
  peelnet extract scene.toml --out d --shard 2/8        part 2 of 8, for any scheduler; all write into d
  peelnet extract scene.toml --out d --resume           what a run that was stopped left to do
  peelnet extract --synthetic 300000 --out d            no scene: synthetic fragment lists, from the seed
  peelnet extract scene.toml --out p --preview          what it would write: p/preview.html, and no dataset

DATASET is a folder: the fragment files, README.md and croissant.json, which describe them to others, and _peelnet/ with manifest.json, which
has statistics of every column. The same seed gives the same rows and the same manifest.")]
pub struct ExtractArgs {
    /// Scene files, or names of shipped scenes
    #[arg(value_name = "SCENE", required_unless_present = "synthetic")]
    pub scenes: Vec<PathBuf>,
    /// Generate N synthetic fragment lists instead of peeling scenes
    #[arg(
        long,
        value_name = "N",
        conflicts_with_all = ["scenes", "size", "views", "peel", "max_passes", "pixels", "augment", "shard"],
        value_parser = clap::value_parser!(u64).range(1..)
    )]
    pub synthetic: Option<u64>,
    /// Folder of the dataset, or its address: s3://, gs:// or az://BUCKET/PREFIX
    #[arg(long, value_name = "DATASET")]
    pub out: PathBuf,
    /// Write no dataset, but a page into the folder --out, another one than the dataset's: preview.html, with pictures of the views, exact
    /// numbers of rows, histograms, and about how many bytes. It takes as long as peeling
    #[arg(long, conflicts_with_all = ["synthetic", "shard", "resume"])]
    pub preview: bool,
    /// Frame size in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1024x768")]
    pub size: [u32; 2],
    /// Views of each scene
    #[arg(long, value_name = "N|all", default_value = "all", value_parser = views)]
    pub views: OrAll<u32>,
    /// File format: csv, parquet or npy
    #[arg(long, value_name = "FORMAT", default_value = "parquet")]
    pub format: Format,
    /// How to peel: sbuffer, dual or single
    #[arg(long, value_name = "METHOD", default_value = "sbuffer")]
    pub peel: Peel,
    /// With dual or single: stop peeling after N passes and report what was left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub max_passes: Option<u32>,
    /// Fraction of the pixels to keep
    #[arg(long, value_name = "FRACTION", default_value = "1", value_parser = fraction)]
    pub pixels: f64,
    /// Varied copies of each scene, in addition to the scene itself
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub augment: u32,
    /// Seed of sampling and variation
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Write only part I of N, beside the other parts, and only what is missing of it
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
    /// Write only what is missing of the dataset that is there
    #[arg(long)]
    pub resume: bool,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet seal d
  peelnet seal d --json | jq .hash

Parts are written by peelnet extract --shard and --resume; whoever writes the last one seals the dataset. This command does it where that
writer was stopped, reads all parts of a folder again, and reports what is missing or wrong, with the part and its worker. A sealed dataset
stays as it is.")]
pub struct SealArgs {
    /// The dataset
    #[arg(value_name = "DATASET")]
    pub dataset: PathBuf,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet train d --out m.safetensors
  peelnet train d1 d2 --out m.safetensors --epochs 40 --loss-curve loss.csv --loss-curve loss.svg
  peelnet train d --out m.safetensors --resume          resume after Ctrl-C, with the same result

On a terminal both losses are drawn while it trains; MODEL.checkpoint/loss.csv has them, too, up to five seconds ago.

Rows of scenes that are marked held-out are never trained on.")]
pub struct TrainArgs {
    /// Dataset folders or addresses (s3://, gs://, az://)
    #[arg(value_name = "DATASET", required = true)]
    pub datasets: Vec<PathBuf>,
    /// The model file to write, or its address; the checkpoint of a file is the folder MODEL.checkpoint
    #[arg(long, value_name = "MODEL")]
    pub out: PathBuf,
    /// What to train: thesis, small, medium, large, one, one-wide, anchored-small, anchored-medium, nmt or dfaoit
    #[arg(long, value_name = "RECIPE", default_value = "medium")]
    pub recipe: Recipe,
    /// Passes over the training rows [default: the recipe's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub epochs: Option<u32>,
    /// Widths of the hidden layers [default: the recipe's]
    #[arg(long, value_name = "N,N", value_delimiter = ',')]
    pub hidden: Option<Vec<usize>>,
    /// Fragments per step (pixels, for recipes that learn from whole pixels) [default: the recipe's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub batch: Option<u32>,
    /// Learning rate [default: the recipe's]
    #[arg(long, value_name = "X", value_parser = positive)]
    pub lr: Option<f64>,
    /// Learning rate over the run: constant, or one cycle that rises for a fifth of the steps and falls to nothing [default: the recipe's]
    #[arg(long, value_name = "SCHEDULE", value_parser = one_of(SCHEDULES.to_vec()))]
    pub schedule: Option<Schedule>,
    /// What recipes that learn from whole pixels minimise: image, contributions, weighted-transmittance or transmittance [default: the recipe's]
    #[arg(long, value_name = "LOSS")]
    pub loss: Option<PixelLoss>,
    /// Seed of initial weights, order and split
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Continue from MODEL.checkpoint
    #[arg(long)]
    pub resume: bool,
    /// Also write the loss of every epoch: .csv or .svg; may be repeated
    #[arg(long, value_name = "FILE")]
    pub loss_curve: Vec<PathBuf>,
    /// Rows of the datasets that are used at most; of more, whole pixels are drawn from the seed
    #[arg(long, value_name = "N", default_value_t = peelnet_train::DEFAULT_MAX_ROWS)]
    pub max_rows: u64,
    /// Train on all rows with bounded memory: the examples go to a scratch file in MODEL.checkpoint, and every epoch reads it in an order
    /// drawn from the seed
    #[arg(long, conflicts_with = "max_rows")]
    pub stream: bool,
    /// Rows in memory at once with --stream; the weights depend on it, because they depend on the order of the examples
    #[arg(long, value_name = "N", requires = "stream", conflicts_with = "max_rows", default_value_t = peelnet_train::DEFAULT_BUFFER_ROWS)]
    pub buffer_rows: u64,
    /// What stays together when rows are set aside for testing: scenes (one scene alone is split by pixel), or pixels of all scenes alike
    #[arg(long, value_name = "BY", default_value = "scene", value_parser = one_of(SPLITS.to_vec()))]
    pub split: SplitBy,
    /// Stop after N epochs without a lower held-out loss and keep the best
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub patience: Option<u32>,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet export m.safetensors --out weight.wgsl
  peelnet export m.safetensors --out weight.glsl        .wgsl, .es.glsl, .glsl, .hlsl or .metal

The functions are run on the GPU and compared with the network before a file is written. What a renderer does around them is described
in the text's first lines, and for programs in a file of the same name that ends in .json.")]
pub struct ExportArgs {
    /// The model file
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// The shader file to write
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Shading language: WebGPU's WGSL, GLSL ES 3.00 (WebGL 2), GLSL 4.50 (OpenGL, Vulkan), HLSL (shader model 6.0) or MSL (Metal 2.4)
    /// [default: FILE's ending says it; WGSL where it does not]
    #[arg(long, value_parser = one_of(LANGUAGES.to_vec()))]
    pub lang: Option<Language>,
    /// Arithmetic of the function, 32-bit or 16-bit floats
    #[arg(long, default_value = "f32", value_parser = one_of(PRECISIONS.to_vec()))]
    pub precision: Precision,
}

const RENDER_EXAMPLES: &str = "Examples:
  peelnet render scene.toml --out exact.png
  peelnet render scene.toml --method wboit-eq9:targets=f32 --out a.exr
  peelnet render scene.toml --method deep-medium --model m.safetensors --view 2 --out b.npy
  peelnet render vase --time 40 --highlight 1 --out glaze.png

IMAGE by its ending: .png (sRGB), .exr (linear f32), .npy (linear f32, H x W x 4 with coverage).
A learned method without --model uses the shipped model.";

const LAYER_FORMULAS: [(&str, LayerFormula); 2] = [
    ("front", LayerFormula::Front),
    ("printed", LayerFormula::Printed),
];

#[derive(Clone, Debug, Args)]
#[command(after_help = RENDER_EXAMPLES, after_long_help = format!("{RENDER_EXAMPLES}\n\n{}", crate::methods_text::methods()))]
pub struct RenderArgs {
    /// Scene file, or name of a shipped scene
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// The image to write
    #[arg(long, value_name = "IMAGE")]
    pub out: PathBuf,
    /// How to draw; parameters follow a colon, as in mboit4:targets=f16. --help lists the methods
    #[arg(long, value_name = "METHOD", default_value = "abuffer")]
    pub method: MethodSpec,
    /// Model file of a learned method
    #[arg(long, value_name = "MODEL")]
    pub model: Option<PathBuf>,
    /// Which view of the scene, from 0
    #[arg(long, value_name = "K", default_value_t = 0)]
    pub view: u32,
    /// Frame size in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1024x768")]
    pub size: [u32; 2],
    /// Samples a pixel: 1, or 4 where multisampling has them; each is composited by itself. A frame of 4 is drawn four times
    #[arg(long, value_name = "1|4", default_value_t = 1, value_parser = one_of(SAMPLES), conflicts_with = "highlight")]
    pub samples: u32,
    /// Time in the scene's timeline; material values are interpolated between its states
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub time: Option<f32>,
    /// Highlight one layer of a nested object, 0 is the outermost: only it is shaded, the others cover it with their base colour
    #[arg(long, value_name = "LAYER", conflicts_with_all = ["method", "model"])]
    pub highlight: Option<u32>,
    /// With --highlight: omit surfaces whose layer is not deeper than that of the surface in front, such as an object's far side
    #[arg(long, requires = "highlight", conflicts_with_all = ["method", "model", "samples"])]
    pub increasing: bool,
    /// With --highlight: which other surfaces are seen: those in front of it, which share half of the pixel, or all of them, by the formula
    /// of the ageing renderer (2018) as it is printed
    #[arg(long, value_name = "FORMULA", default_value = "front", value_parser = one_of(LAYER_FORMULAS), requires = "highlight", conflicts_with_all = ["method", "model", "samples"])]
    pub layers: LayerFormula,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet view                                           a shipped scene; drop files of your own onto the window
  peelnet view mesh.glb --method deep-large
  peelnet view boxes-held --method deep-medium --model m.safetensors     reads the file again while it is trained
  peelnet view cups --method mboit4 --size 1280x800 --frames 10 --screenshot window.png
  peelnet view cups --method mboit4 --size 640x480 --bare --screenshot picture.png
  peelnet view foliage-held --method wboit-eq9 --compare error --against deep-medium

The program has a viewer where it was built with it: cargo build --release --package peelnet --features view")]
pub struct ViewArgs {
    /// Scene file, mesh file, or name of a shipped scene
    #[arg(value_name = "SCENE", default_value = "cups")]
    pub scene: PathBuf,
    /// How to draw at first; see render --help
    #[arg(long, value_name = "METHOD", default_value = "deep-medium")]
    pub method: MethodSpec,
    /// Model file of a learned method; read again whenever it changes
    #[arg(long, value_name = "MODEL")]
    pub model: Option<PathBuf>,
    /// Which view of the scene, from 0
    #[arg(long, value_name = "K", default_value_t = 0)]
    pub view: u32,
    /// Eye and target, and the field of view in degrees, in place of the view's own
    #[arg(long, value_name = "X,Y,Z,X,Y,Z[,DEGREES]", allow_hyphen_values = true)]
    pub camera: Option<String>,
    /// Time in the scene's timeline
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub time: Option<f32>,
    /// How two methods are compared at first: one, split, beside, flicker, error or layers
    #[arg(long, value_name = "MODE", default_value = "one", value_parser = ["one", "split", "beside", "flicker", "error", "layers"])]
    pub compare: String,
    /// What the method is compared with
    #[arg(long, value_name = "METHOD", default_value = "abuffer")]
    pub against: MethodSpec,
    /// Size of the window's content in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1280x800")]
    pub size: [u32; 2],
    /// The picture alone, without panels
    #[arg(long)]
    pub bare: bool,
    /// Look into this dataset beside the picture; --train trains on it
    #[arg(long, value_name = "DATASET")]
    pub dataset: Option<PathBuf>,
    /// Train this network on the scene, or on the dataset, as the button does; a script without --frames ends once it is trained
    #[arg(long, value_name = "RECIPE")]
    pub train: Option<Recipe>,
    /// For scripts: draw N frames and end
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub frames: Option<u64>,
    /// For scripts: save what the window shows after the last frame, and end
    #[arg(long, value_name = "FILE.png")]
    pub screenshot: Option<PathBuf>,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet stress                                        every method, with the shipped networks
  peelnet stress --model m.safetensors --out out/mine   a network of your own, before it ships
  peelnet stress --methods mboit4,deep-medium --cases deep,coplanar
  peelnet stress --json | jq '.rows[] | select(.result == \"fail\")'

Exit code 1 if a property fails that is not a known failure on this adapter, or if a known failure no longer occurs. DIR gets stress.json,
stress.csv, stress.md, stress.html, and pictures of what fails in images/.")]
pub struct StressArgs {
    /// Methods, separated by commas; all means every method in every precision
    #[arg(long, value_name = "all|A,B", default_value = "all", value_parser = methods)]
    pub methods: OrAll<Vec<MethodSpec>>,
    /// Model files of learned methods, separated by commas; without --methods only these are checked
    #[arg(
        long,
        visible_alias = "model",
        value_name = "MODEL,MODEL",
        value_delimiter = ','
    )]
    pub models: Vec<PathBuf>,
    /// Names of cases, separated by commas [default: all]
    #[arg(long, value_name = "CASE,CASE", value_delimiter = ',', value_parser = one_of(CASES.iter().map(|case| (case.id, case))))]
    pub cases: Vec<&'static Case>,
    /// Folder for the results and for pictures of failures
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet recommend cups --budget-ms 30 --results out/bench
  peelnet recommend scene.toml --max-error 1e-4
  peelnet recommend scene.toml --budget-ms 2 --max-bytes 40 --json | jq -r .method

With --max-error the fastest method within that error is recommended, otherwise the most accurate one within the other bounds. Without
any bound, the fastest exact method.")]
pub struct RecommendArgs {
    /// Scene file, or name of a shipped scene
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Longest frame time, milliseconds, in the scene's slowest view
    #[arg(long, value_name = "T", value_parser = positive)]
    pub budget_ms: Option<f64>,
    /// Largest mean squared error against the exact image, linear light, in the scene's worst view
    #[arg(long, value_name = "E", value_parser = positive)]
    pub max_error: Option<f64>,
    /// Most bytes per pixel, in addition to the colour target
    #[arg(long, value_name = "B", value_parser = positive)]
    pub max_bytes: Option<f64>,
    /// Folder or results.json of a bench; without it all methods are measured now
    #[arg(long, value_name = "DIR|FILE")]
    pub results: Option<PathBuf>,
    /// Frame size in pixels, if measured now
    #[arg(
        long,
        value_name = "WxH", value_parser = size,
        default_value = "1024x768",
        conflicts_with = "results"
    )]
    pub size: [u32; 2],
    /// Timed frames per method and view, if measured now
    #[arg(
        long,
        value_name = "N",
        default_value_t = 3,
        conflicts_with = "results"
    )]
    pub frames: u32,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet inspect sixteen-050
  peelnet inspect d --json | jq .rows
  peelnet inspect d --html d.html                       also a page: statistics, views, the rows of a pixel beside its picture
  peelnet inspect m.safetensors

A dataset is read completely: values that follow from other rows are recomputed, and the exit code is 1 if they disagree.")]
pub struct InspectArgs {
    /// A scene (.toml, .gltf, .glb, .obj, .ply, .stl, .splat, .spz or the name of a shipped one), a dataset (a folder) or a model (.safetensors)
    #[arg(value_name = "SCENE|DATASET|MODEL")]
    pub what: PathBuf,
    /// For a scene: also measure what each of its effects costs on this machine
    #[arg(long)]
    pub time: bool,
    /// For a dataset: also write a page, one file that needs no other
    #[arg(long, value_name = "PAGE")]
    pub html: Option<PathBuf>,
}
