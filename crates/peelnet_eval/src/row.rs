use serde::{Deserialize, Serialize};

/// One method on one view of one scene: a row of `results.json`.
///
/// Errors are against the exact image of the same view, see [`crate::metrics`]. A value that was not measured is
/// `null`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The method's name with its parameters.
    pub method: String,
    /// The scene's name.
    pub scene: String,
    /// The view's number.
    pub view: u32,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Samples a pixel.
    #[serde(default = "one")]
    pub samples: u32,
    /// Transparent fragments of the view, of all samples.
    pub fragments: Option<u64>,
    /// The most fragments of one pixel.
    pub max_layers: Option<u32>,
    /// Fragments that the method did not composite: those beyond a cap on passes. `null` where it
    /// does not count them.
    #[serde(default)]
    pub lost: Option<u64>,
    /// Linear light, whole frame.
    pub mse_linear: f64,
    /// Linear light, covered pixels.
    pub mse_linear_covered: Option<f64>,
    /// Display-referred, 0–255, whole frame.
    pub mse255: f64,
    /// Display-referred, 0–255, covered pixels.
    pub mse255_covered: Option<f64>,
    /// dB, of 8-bit sRGB images; `null` where these are identical.
    pub psnr: Option<f64>,
    /// Mean structural similarity, see [`crate::perceptual`]; `null` for images under 8×8 pixels.
    #[serde(default)]
    pub ssim: Option<f64>,
    /// Mean ꟻLIP, see [`crate::perceptual`].
    #[serde(default)]
    pub flip: Option<f64>,
    /// Mean `|T̂ − T|` over fragments, see [`crate::transmittance`]; `null` for methods that estimate no transmittance.
    #[serde(default)]
    pub transmittance_error: Option<f64>,
    /// Share of contour pairs among the pairs of neighbours that show the same transparent surfaces, 0–1, see [`crate::contours`]; `null` of
    /// a view without such pairs, and where the surfaces need more memory than there is.
    #[serde(default)]
    pub contour_pairs: Option<f64>,
    /// 99th percentile of the pixel error, 0–255.
    pub p99_error: f64,
    /// The largest pixel error, 0–255.
    pub max_error: f64,
    /// Pixels that hold a transparent fragment.
    pub covered_pixels: u64,
    /// Pixels far darker than the exact ones, see [`crate::metrics::DARK`].
    pub dark_pixels: u64,
    /// Pixels with a component that is not finite.
    pub non_finite_pixels: u64,
    /// GPU time of the method's passes onto a 16-bit target, over its background (clock time of the whole frame where the adapter has no
    /// timestamps), milliseconds: the median of the timed frames, or of the 32-bit image that was compared where none were timed.
    pub time_ms: Option<f64>,
    /// The fastest timed frame.
    pub time_ms_min: Option<f64>,
    /// 90th percentile (nearest rank) of the timed frames.
    pub time_ms_p90: Option<f64>,
    /// Clock time from the first command to the last result, the median of the timed frames: what the CPU waits for as well.
    #[serde(default)]
    pub wall_ms: Option<f64>,
    /// Median time of each pass, in order, equal names summed: `moments=1.25 gather=2.5`, milliseconds. Empty where the
    /// adapter has no timestamps.
    #[serde(default)]
    pub time_by_pass: String,
    /// Geometry and full-screen passes; 0 of a method that was composited on the CPU.
    pub passes: u32,
    /// Bytes of the method's own targets and storage, per pixel; `null` of a method that was composited on the CPU, as its times are.
    pub bytes_per_pixel: Option<f64>,
    /// The adapter that drew it, or the exact image that it is compared with.
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

fn each_once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
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
