//! What becomes of a frame: its image, its times and what the method reports.

use crate::{image::Image, methods::compositor::FrameStats};
use peelnet_files::counted;
use peelnet_gpu::{record::PassTime, wgpu};
use peelnet_raster::BACKGROUND_PASS;

/// A finished frame.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Linear colour and coverage.
    pub image: Image,
    /// GPU time of every pass, where the adapter measures it.
    pub times: Vec<PassTime>,
    /// What the method reports.
    pub stats: FrameStats,
    /// Clock time from the first command to the last result, read-back of the image not included.
    pub wall_micros: f64,
}

impl Frame {
    /// What is wrong with the picture.
    pub fn warnings(&self) -> Vec<String> {
        let lost = counted(self.stats.lost, "fragment");
        let not_finite = self.image.non_finite() as u64;
        let odd = counted(not_finite, "pixel");
        [
            (self.stats.lost, format!("not in the image: {lost}")),
            (not_finite, format!("not finite: {odd}")),
        ]
        .into_iter()
        .filter_map(|(count, text)| (count > 0).then_some(text))
        .collect()
    }
}

/// A frame that was drawn for its time alone.
#[derive(Clone, Debug)]
pub struct Profile {
    /// GPU time of every pass, where the adapter measures it.
    pub times: Vec<PassTime>,
    /// What the method reports.
    pub stats: FrameStats,
    /// Clock time from the first command to the last result, microseconds.
    pub wall_micros: f64,
}

/// The passes of the method itself, with its work on the CPU: without the first pass of that name that draws the background and the opaque
/// surfaces, whatever the method.
pub fn of_method(times: &[PassTime]) -> Vec<PassTime> {
    let mut times = times.to_vec();
    if let Some(place) = times.iter().position(|t| t.label == BACKGROUND_PASS) {
        times.remove(place);
    }
    times
}

/// GPU time of passes; none without timestamps.
pub fn milliseconds(times: &[PassTime]) -> Option<f64> {
    let micros: f64 = times.iter().map(|t| t.micros).sum();
    (micros > 0.0).then_some(micros / 1e3)
}

/// Format of the target of a [`crate::Renderer::profile`], as engines draw transparency onto before they map tones.
pub(crate) const PROFILED: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

#[cfg(test)]
mod tests {
    use super::*;

    /// Work on the CPU comes before all passes. The first pass of the background is none of the method's; one at a lower resolution is.
    #[test]
    fn the_background_is_not_the_methods() {
        let times: Vec<PassTime> = ["sort", BACKGROUND_PASS, BACKGROUND_PASS, "blend"]
            .iter()
            .zip([8.0, 4.0, 2.0, 1.0])
            .map(|(label, micros)| PassTime {
                label: (*label).to_owned(),
                micros,
            })
            .collect();
        let left: f64 = of_method(&times).iter().map(|t| t.micros).sum();
        assert_eq!(left, 8.0 + 2.0 + 1.0);
        assert_eq!(of_method(&times[3..]), times[3..]);
    }
}
