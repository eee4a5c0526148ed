//! The flags of `peelnet view`.

use crate::parse::Size;
use clap::Args;
use peelnet_render::MethodSpec;
use std::path::PathBuf;

/// `peelnet view`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  peelnet view                                           a shipped scene; drop files of your own onto the window
  peelnet view mesh.glb --method deep-large
  peelnet view boxes-held --method deep-thesis --model m.safetensors     reads the file again while it is trained
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
    #[arg(long, value_name = "WxH", default_value = "1280x800")]
    pub size: Size,
    /// The picture alone, without panels
    #[arg(long)]
    pub bare: bool,
    /// For scripts: draw N frames and end
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub frames: Option<u64>,
    /// For scripts: save what the window shows after the last frame, and end
    #[arg(long, value_name = "FILE.png")]
    pub screenshot: Option<PathBuf>,
}
