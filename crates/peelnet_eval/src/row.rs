use serde::{Deserialize, Serialize};

/// One method on one view of one scene: a row of `results.json`.
///
/// Errors are against the exact image of the same view, see [`crate::metrics`]. A value that was not measured is
/// `null`.
#[allow(
    missing_docs,
    reason = "docs/results-files.md says what each field is, and its unit"
)]
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
    #[serde(default)]
    pub lost: Option<u64>,
    pub mse_linear: f64,
    pub mse_linear_covered: Option<f64>,
    pub mse255: f64,
    pub mse255_covered: Option<f64>,
    pub psnr: Option<f64>,
    #[serde(default)]
    pub ssim: Option<f64>,
    #[serde(default)]
    pub flip: Option<f64>,
    #[serde(default)]
    pub transmittance_error: Option<f64>,
    #[serde(default)]
    pub contour_pairs: Option<f64>,
    pub p99_error: f64,
    pub max_error: f64,
    pub covered_pixels: u64,
    pub dark_pixels: u64,
    pub non_finite_pixels: u64,
    pub time_ms: Option<f64>,
    pub time_ms_min: Option<f64>,
    pub time_ms_p90: Option<f64>,
    #[serde(default)]
    pub wall_ms: Option<f64>,
    #[serde(default)]
    pub time_by_pass: String,
    pub passes: u32,
    pub bytes_per_pixel: Option<f64>,
    pub adapter: String,
}

/// Of rows that were measured before there were more.
const fn one() -> u32 {
    1
}

/// The names of the rows' methods, each once, in the order of the rows.
pub fn methods_of<'a>(rows: impl IntoIterator<Item = &'a Row>) -> Vec<&'a str> {
    each_once(rows.into_iter().map(|r| r.method.as_str()))
}

/// The names of the rows' scenes, each once, in the order of the rows.
pub fn scenes_of<'a>(rows: impl IntoIterator<Item = &'a Row>) -> Vec<&'a str> {
    each_once(rows.into_iter().map(|r| r.scene.as_str()))
}

/// Each name once, in the order of the first.
pub fn each_once<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = Vec::new();
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A row with little but an error.
    pub(crate) fn row(scene: &str, view: u32, method: &str, mse255: f64) -> Row {
        Row {
            method: method.to_owned(),
            scene: scene.to_owned(),
            view,
            mse_linear: mse255 / 65025.0,
            mse255,
            bytes_per_pixel: Some(10.0),
            ..Row::default()
        }
    }
}
