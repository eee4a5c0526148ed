//! How visible the difference between two videos is: ColorVideoVDP.

use crate::{EvalError, perceptual::Displayed};
use colorvideovdp::{Color, Cvvdp, DisplayModel, Image, Options};

pub(super) const FPS: f32 = 30.0;

/// The display that it is shown on: one of the metric's own models, and what that is.
const DISPLAY: &str = "standard_fhd";
pub(super) const DISPLAY_ABOUT: &str =
    "24-inch 1920x1080 monitor, 200 cd/m², in an office of 250 lux, seen from 0.6 m";

/// The smallest side that the metric takes, pixels.
const LEAST_SIDE: u32 = 4;

/// What the metric sees of a frame: 8-bit sRGB. `None` of a frame that is too small for it.
pub(super) fn frame(shown: &Displayed) -> Result<Option<Image>, EvalError> {
    let (size, bytes) = shown.rgb8();
    if size.iter().any(|&n| n < LEAST_SIDE) {
        return Ok(None);
    }
    let values = bytes.iter().map(|&b| f32::from(b) / 255.0).collect();
    let [width, height] = size.map(|n| n as usize);
    Ok(Some(Image::new(width, height, 3, values)?))
}

/// The metric (Mantiuk et al. 2024) on its display, with all settings as published.
pub(super) fn metric() -> Result<Cvvdp, EvalError> {
    let display = DisplayModel::from_name(DISPLAY)?;
    Ok(Cvvdp::new(display, Options::default())?)
}

/// Just-objectionable differences between a video and the exact one, 10 for no visible difference and less for worse.
pub(super) fn jod(metric: &Cvvdp, video: &[Image], exact: &[Image]) -> Result<f64, EvalError> {
    let found = metric.predict_video(video, exact, FPS, Color::Srgb)?;
    Ok(f64::from(found.jod))
}
