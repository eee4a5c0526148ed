//! What is written to the files of results. `docs/results-files.md` says what each field is, and its unit.

use crate::designs::MOTIONS;
use peelnet_core::{
    files::{check_name, printable},
    methods::slabs::Kept,
};
use peelnet_model::PixelLoss;
use peelnet_render::Property;
use serde::{Deserialize, Deserializer, Serialize, de::Error as _};
use std::{collections::HashSet, fmt};

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    pub os: String,
    pub arch: String,
    pub cpu: String,
    pub cores: usize,
    #[serde(default)]
    pub memory: u64,
    pub adapter: String,
    pub adapter_kind: String,
    pub backend: String,
    pub driver: String,
    pub peelnet: String,
    pub build: String,
}

/// One method on one view of one scene: a row of `results.json`.
///
/// Errors are against the exact image of the same view, see [`crate::metrics`]. A value that was not measured is
/// `null`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub method: String,
    pub scene: String,
    pub view: u32,
    pub width: u32,
    pub height: u32,
    #[serde(default = "one")]
    pub samples: u32,
    pub fragments: Option<u64>,
    pub max_layers: Option<u32>,
    pub lost: Option<u64>,
    pub mse_linear: f64,
    pub mse_linear_covered: Option<f64>,
    pub mse255: f64,
    pub mse255_covered: Option<f64>,
    pub psnr: Option<f64>,
    pub ssim: Option<f64>,
    pub flip: Option<f64>,
    pub transmittance_error: Option<f64>,
    pub contour_pairs: Option<f64>,
    pub p99_error: f64,
    pub max_error: f64,
    pub covered_pixels: u64,
    pub dark_pixels: u64,
    pub non_finite_pixels: u64,
    pub time_ms: Option<f64>,
    pub time_ms_min: Option<f64>,
    pub time_ms_p90: Option<f64>,
    pub wall_ms: Option<f64>,
    #[serde(default)]
    pub time_by_pass: String,
    pub passes: u32,
    pub bytes_per_pixel: Option<f64>,
    pub adapter: String,
    /// Hash of what the scene shows, see [`Scene::content`](peelnet_scene::Scene::content); empty in rows of before there was one.
    #[serde(default)]
    pub scene_content: String,
    /// Hashes of all shaders of the program that drew it, and of the network's model file; empty in rows of before there were any.
    #[serde(default)]
    pub shaders: String,
    #[serde(default)]
    pub network: Option<String>,
    /// SHA-256 of the picture in `images/`, which is drawn of view 0.
    #[serde(default)]
    pub picture: Option<String>,
}

/// Characters of the times of a frame's passes: of hundreds of them.
const MOST_OF_PASSES: usize = 1 << 14;

/// Methods, and scenes.
const MOST_NAMES: usize = 1 << 10;

/// Pairs of a method and a scene.
const MOST_CELLS: usize = 1 << 18;

/// Largest value of a row: errors are squares of 32-bit numbers.
const LARGEST: f64 = 1e80;

impl Row {
    /// What a frame takes: the least of its times. What else a machine does, and a GPU whose clock has not risen yet, only add to it.
    pub fn frame_ms(&self) -> Option<f64> {
        self.time_ms_min
    }

    /// Whether a measurement can have these values; an error names the field that it cannot.
    fn check(&self) -> Result<(), String> {
        let fields =
            serde_json::to_value(self).expect("names are text, and floats serialise always");
        for (name, value) in fields.as_object().into_iter().flatten() {
            if let ("method" | "scene", Some(text)) = (&**name, value.as_str()) {
                check_name(text).map_err(|e| format!("`{name}` {e}"))?;
            }
            if name == "time_by_pass" && value.as_str().is_some_and(|t| t.len() > MOST_OF_PASSES) {
                return Err(format!(
                    "`{name}` is longer than {MOST_OF_PASSES} characters"
                ));
            }
            let least = if name == "ssim" { -1.0 } else { 0.0 };
            if let Some(x) = value.as_f64().filter(|x| !(least..=LARGEST).contains(x)) {
                return Err(format!(
                    "`{name}` is {x:?}, and lies from {least} to {LARGEST:e}"
                ));
            }
        }
        Ok(())
    }
}

/// Rows with values that a measurement can have, one for each method and view.
pub(crate) fn checked<'de, D: Deserializer<'de>>(rows: D) -> Result<Vec<Row>, D::Error> {
    let rows = Vec::<Row>::deserialize(rows)?;
    let methods = rows.iter().map(|r| &r.method).collect::<HashSet<_>>().len();
    let scenes = rows.iter().map(|r| &r.scene).collect::<HashSet<_>>().len();
    // A report has a cell for each, and takes time by the square of either.
    if methods.max(scenes) > MOST_NAMES || methods * scenes > MOST_CELLS {
        let why = format!(
            "{methods} methods and {scenes} scenes, of which at most {MOST_NAMES} of each and {MOST_CELLS} pairs are read"
        );
        return Err(D::Error::custom(why));
    }
    let mut known = HashSet::new();
    for (k, row) in rows.iter().enumerate() {
        let Row {
            method,
            scene,
            view,
            ..
        } = row;
        let checked = match known.insert((method, scene, view)) {
            true => row.check(),
            false => Err(format!(
                "is a second one of {} on view {view} of {}",
                printable(method),
                printable(scene)
            )),
        };
        checked.map_err(|why| D::Error::custom(format!("rows[{k}]: {why}")))?;
    }
    Ok(rows)
}

/// Of rows that were measured before there were more.
const fn one() -> u32 {
    1
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bench {
    #[serde(default)]
    pub load: [Option<f64>; 2],
    /// Hash of the settings that it was measured with, by which a run that is resumed finds that it has finished.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settings: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub trained_on: Vec<String>,
    #[serde(deserialize_with = "checked")]
    pub rows: Vec<Row>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PathRow {
    pub method: String,
    pub scene: String,
    pub frames: u32,
    pub mse_linear: f64,
    pub psnr: Option<f64>,
    pub flip: f64,
    pub error: f64,
    pub change: Option<f64>,
    pub change_max: Option<f64>,
    pub contour_pairs: Option<f64>,
    pub jod: Option<f64>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameRow {
    pub method: String,
    pub scene: String,
    pub frame: u32,
    pub mse_linear: f64,
    pub psnr: Option<f64>,
    pub flip: f64,
    pub error: f64,
    pub change: Option<f64>,
    pub contour_pairs: Option<f64>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Along {
    pub size: [u32; 2],
    pub samples: u32,
    pub frames: u32,
    pub fps: f32,
    pub display: String,
    pub rows: Vec<PathRow>,
    pub by_frame: Vec<FrameRow>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Growth {
    pub method: String,
    pub series: Series,
    pub value: u64,
    pub time_ms: f64,
    pub bytes_per_pixel: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    pub method: String,
    pub series: Series,
    pub value: u64,
    pub why: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Exponent {
    pub method: String,
    pub series: Series,
    pub time: Option<f64>,
    pub bytes: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    pub exponents: Vec<Exponent>,
    pub rows: Vec<Growth>,
    pub left_out: Vec<LeftOut>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    pub scene: String,
    pub effect: String,
    pub ms_with: f64,
    pub ms_without: f64,
    pub ratio: f64,
    #[serde(default)]
    pub passes_with: u32,
    #[serde(default)]
    pub passes_without: u32,
    pub bytes_with: f64,
    pub bytes_without: f64,
}

/// A scene as it is; every surface opaque, shaded with all effects ([`peelnet_scene::Scene::opaque`]); every surface transparent as before
/// and unlit ([`peelnet_scene::Scene::unlit`]).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Parts {
    pub scene: String,
    pub ms_both: f64,
    pub ms_shading: f64,
    pub ms_transparency: f64,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LayerCost {
    pub scene: String,
    pub layers: u32,
    pub ms_one: f64,
    pub ms_all: f64,
    pub ratio: f64,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fill {
    pub scene: String,
    pub triangles: u64,
    pub filled: f64,
    pub ms_one: f64,
    pub ms_all: f64,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Effects {
    pub method: String,
    pub size: [u32; 2],
    pub frames: u32,
    pub costs: Vec<Cost>,
    /// Of scenes that are shaded and transparent; none in a measurement of an older version.
    #[serde(default)]
    pub parts: Vec<Parts>,
    pub layers: Vec<LayerCost>,
    pub fills: Vec<Fill>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    Pass,
    /// It does not, as the method declares.
    Declared,
    /// It does not, or it does although the failure is known.
    Fail,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressRow {
    pub method: String,
    pub case: String,
    pub property: Property,
    pub result: Outcome,
    pub value: Option<f64>,
    pub limit: f64,
    pub place: String,
    pub reason: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stressed {
    pub rows: Vec<StressRow>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Score {
    pub to_moments: Option<f64>,
    pub to_kbuffer: Option<f64>,
    pub worst_scene: Option<String>,
    pub worst: Option<f64>,
    pub contour_pairs: Option<f64>,
    #[serde(default)]
    pub flicker: [Option<f64>; MOTIONS.len()],
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    pub method: String,
    #[serde(flatten)]
    pub score: Score,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DesignRow {
    pub design: String,
    pub slabs: Vec<Kept>,
    pub records: String,
    pub range: String,
    pub apart: bool,
    pub trained_apart: bool,
    pub bytes: u32,
    pub inputs: Vec<String>,
    pub topology: String,
    pub parameters: u64,
    pub loss: PixelLoss,
    pub seed: u64,
    pub examples: u64,
    pub seconds: f64,
    pub network: Score,
    pub middle: Score,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Designs {
    pub file: String,
    pub trained_on: Vec<String>,
    pub judged_on: Vec<String>,
    pub learning_rate: f64,
    pub epochs: u32,
    pub references: Vec<Reference>,
    pub rows: Vec<DesignRow>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Series {
    /// Fragments of every pixel, 1 … 256, at 256×192.
    Fragments,
    /// Pixels of the frame, 64×48 … 1024×768, with eight fragments each.
    Pixels,
    /// Triangles, 16 … 2²⁰, with eight fragments a pixel at 256×192.
    Triangles,
}

impl Series {
    pub const ALL: [Self; 3] = [Self::Fragments, Self::Pixels, Self::Triangles];
}

impl fmt::Display for Series {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(["fragments", "pixels", "triangles"][*self as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reports have a cell for each pair, and take time by the square of either number.
    #[test]
    fn methods_and_scenes_are_bounded() {
        let read = |methods: usize, scenes: usize| {
            let pairs = (0..methods.max(scenes)).map(|k| Row {
                method: format!("m{}", k % methods),
                scene: format!("s{}", k % scenes),
                ..Row::default()
            });
            let bench = Bench {
                rows: pairs.collect(),
                ..Bench::default()
            };
            let text = serde_json::to_string(&bench).expect("serialises");
            serde_json::from_str::<Bench>(&text).map_err(|e| e.to_string())
        };
        for (methods, scenes) in [(1024, 1), (1, 1024), (256, 1024)] {
            assert!(read(methods, scenes).is_ok(), "{methods} {scenes}");
        }
        for (methods, scenes) in [(1025, 1), (1, 1025), (1024, 257)] {
            let e = read(methods, scenes).expect_err("too many");
            let words = format!("{methods} methods and {scenes} scenes");
            assert!(e.contains(&words), "{e}");
        }
    }
}
