//! `peelnet bench`: the comparison of methods, and a command for everything else that is measured.

use super::OrAll;
use crate::values::{SAMPLES, methods, one_of, size, views};
use clap::builder::UnknownArgumentValueParser;
use clap::{Arg, ArgAction, Args, Subcommand};
use peelnet_render::MethodSpec;
use std::path::PathBuf;

#[derive(Clone, Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    args = old_flags(),
    after_help = "Examples:
  peelnet bench cups --out out/bench
  peelnet bench scene.toml --methods mboit4:overestimation=0.5 --models m.safetensors --out o
  peelnet bench data/scenes/*-held.toml --methods wboit-eq9,deep-medium --frames 10 --out o
  peelnet bench path cups --out out/path                see peelnet bench path --help

DIR gets report.html, pareto.svg, results.json, results.csv, table.md and images/. Learned methods
use the shipped models unless --models names another of the same recipe. The name of a command
stands before all flags of bench."
)]
pub struct BenchArgs {
    #[command(subcommand)]
    pub command: Option<BenchCommand>,
    #[command(flatten)]
    pub comparison: Option<CompareArgs>,
}

#[derive(Clone, Debug, Subcommand)]
pub enum BenchCommand {
    /// Draw every frame of a path of the camera and all objects: errors and how they change
    Path(PathArgs),
    /// Measure how time and memory grow with fragments per pixel, pixels and triangles
    Scaling(ScalingArgs),
    /// Measure what each effect costs, and what shading one layer of several saves
    Effects(EffectsArgs),
    /// Train the network of each design of slabs, and measure its error
    Designs(DesignsArgs),
    /// Measure nothing; write report, charts and tables again from DIR/results.json
    #[command(after_help = "Examples:\n  peelnet bench redraw --out out/bench")]
    Redraw {
        /// Folder of a comparison
        #[arg(long, value_name = "DIR")]
        out: PathBuf,

        /// Write nothing; an error if rows are of other shaders or networks than this program's
        #[arg(long)]
        check: bool,
    },
}

/// Flags of earlier versions that are commands now, with what to write before `--out`.
const OLD_FLAGS: [(&str, &str); 5] = [
    ("path", "path SCENE"),
    ("scaling", "scaling"),
    ("effects", "effects"),
    ("designs", "designs DATASET SCENE"),
    ("redraw", "redraw"),
];

/// Flags that are errors, and say so.
fn old_flags() -> impl Iterator<Item = Arg> {
    OLD_FLAGS.into_iter().map(|(flag, command)| {
        let tip = format!("--{flag} is a command now: peelnet bench {command} --out DIR");
        let flag = Arg::new(flag).long(flag).hide(true);
        let parser = UnknownArgumentValueParser::suggest(tip);
        flag.action(ArgAction::SetTrue).value_parser(parser)
    })
}

#[derive(Clone, Debug, Args)]
pub struct MethodsArgs {
    /// Output folder
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Methods to compare, separated by commas; parameters follow a colon
    #[arg(long, value_name = "all|A,B", default_value = "all", value_parser = methods)]
    pub methods: OrAll<Vec<MethodSpec>>,
    /// Model files of learned methods, separated by commas
    #[arg(long, value_name = "MODEL,MODEL", value_delimiter = ',')]
    pub models: Vec<PathBuf>,
}

/// What draws scenes with methods and compares pictures.
#[derive(Clone, Debug, Args)]
pub struct PicturesArgs {
    /// Scene files, or names of shipped scenes
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub compared: MethodsArgs,
    /// Frame size in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1024x768")]
    pub size: [u32; 2],
    /// Samples a pixel, 1 or 4, of all methods and of the exact image; a frame of 4 is drawn four times
    #[arg(long, value_name = "1|4", default_value_t = 1, value_parser = one_of(SAMPLES))]
    pub samples: u32,
}

#[derive(Clone, Debug, Args)]
#[group(args = ["scenes"])]
pub struct CompareArgs {
    #[command(flatten)]
    pub pictures: PicturesArgs,
    /// Timed frames per method and view, drawn method after method in turn; with 0 nothing is timed
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub frames: u32,
    /// Views of each scene
    #[arg(long, value_name = "N|all", default_value = "all", value_parser = views)]
    pub views: OrAll<u32>,
    /// Resume an interrupted run with the same settings; finished views are not drawn again
    #[arg(long)]
    pub resume: bool,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet bench path cups --size 512x384 --methods painter-object,deep-medium --out out/path

Measured are the error of every frame, its change from frame to frame, contour pairs (neighbouring
pixels with the same surfaces and different errors), and the visible difference of the video
(ColorVideoVDP). DIR gets report.html, path.json, path.csv, path-frames.csv, path.md, charts, images/.")]
pub struct PathArgs {
    #[command(flatten)]
    pub pictures: PicturesArgs,
    /// Frames of the path
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: u32,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet bench scaling --methods mboit4,abuffer --frames 3 --out out/scaling

The scenes are stacks of walls. DIR gets scaling.json, scaling.csv, scaling.md and a chart each.")]
pub struct ScalingArgs {
    #[command(flatten)]
    pub compared: MethodsArgs,
    /// Timed frames per method and step
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: u32,
}

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet bench effects --out out/effects
  peelnet bench effects vase --method mboit4 --size 512x384 --frames 9 --out out/effects

DIR gets report.html, effects.json, effects.md, effects-layers.svg and images/.")]
pub struct EffectsArgs {
    /// Scene files, or names of shipped scenes [default: the shipped scenes for effects]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// Output folder
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The method that draws with and without each effect
    #[arg(long, value_name = "METHOD", default_value = EFFECTS_METHOD)]
    pub method: MethodSpec,
    /// Timed frames with and without each effect, in turn
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: u32,
    /// Frame size in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1024x768")]
    pub size: [u32; 2],
}

/// One pass, and nothing that could hide what an effect costs.
pub const EFFECTS_METHOD: &str = peelnet_render::role::WEIGHTED_BLENDING;

#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet bench designs out/synthetic sixteen-050 --size 256x192 --out out/designs
  peelnet bench designs d1,d2 cups panes --file designs.toml --out out/designs

DIR gets designs.json and designs.md.")]
pub struct DesignsArgs {
    /// Datasets to train on, separated by commas; they must not hold the scenes
    #[arg(value_name = "DATASET,DATASET", required = true, num_args = 1)]
    #[arg(action = ArgAction::Set, value_delimiter = ',')]
    pub datasets: Vec<PathBuf>,
    /// Scene files, or names of shipped scenes
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    /// Output folder
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The designs, TOML [default: the shipped data/designs.toml]
    #[arg(long, value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// Rows of the datasets that are used at most, drawn by whole pixels; 33554432 need about 4 GiB
    #[arg(long, value_name = "N", default_value_t = peelnet_train::DEFAULT_MAX_ROWS)]
    pub max_rows: u64,
    /// Frame size in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1024x768")]
    pub size: [u32; 2],
    /// Views of each scene
    #[arg(long, value_name = "N|all", default_value = "all", value_parser = views)]
    pub views: OrAll<u32>,
}
