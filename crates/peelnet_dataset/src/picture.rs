//! A small picture of a scene for the dataset's card, of the rows of its first view: the transparent surfaces alone, before nothing.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use peelnet_core::srgb::encode8;

use crate::column::FragmentBatch;
use crate::manifest::Part;

/// Longer side at most, pixels.
const SIDE: u32 = 192;

/// Scenes that have pictures: the first ones.
pub(crate) const SCENES: u32 = 100;

/// Bytes of a PNG at most: those of the pixels and a header. More is no picture of ours.
const MAX_BYTES: usize = 5 * (SIDE * SIDE) as usize;

/// The name of a scene's picture.
pub(crate) fn name(scene: u32) -> String {
    format!("picture-{scene:05}.png")
}

/// Gathers what is seen of each fragment. Pixels of the picture are means over squares of the view's.
#[derive(Debug)]
pub(crate) struct Picture {
    /// Side of these squares.
    step: u32,
    size: [u32; 2],
    /// `Σ α T c` and `Σ α T`, linear.
    sums: Vec<[f32; 4]>,
    /// Expected number of the view's pixels in a square.
    pixels: f32,
}

impl Picture {
    /// Of a part that is the first of its scene; `None` of others. `fraction` of the pixels is there.
    pub(crate) fn of(part: &Part, fraction: f64) -> Option<Self> {
        if part.view > 0 || part.copy > 0 || part.scene >= SCENES {
            return None;
        }
        let step = part.width.max(part.height).div_ceil(SIDE).max(1);
        let size = [part.width, part.height].map(|side| side.div_ceil(step));
        Some(Self {
            step,
            size,
            sums: vec![[0.0; 4]; size[0] as usize * size[1] as usize],
            pixels: (step * step) as f32 * fraction as f32,
        })
    }

    /// Adds rows of the part.
    pub(crate) fn add(&mut self, rows: &FragmentBatch) {
        for k in 0..rows.len() {
            let [x, y] = [rows.x[k], rows.y[k]].map(|at| (at / self.step) as usize);
            let seen = (1.0 - rows.one_minus_alpha[k]) * rows.transmittance[k];
            // Both are below the view's sides: the rows were checked.
            let sum = &mut self.sums[y * self.size[0] as usize + x];
            for (sum, value) in sum.iter_mut().zip([rows.r[k], rows.g[k], rows.b[k], 1.0]) {
                *sum += seen * value;
            }
        }
    }

    /// The picture as PNG in base64; `None` of one that nothing is seen in.
    pub(crate) fn encode(&self) -> Option<String> {
        let coverage = |sum: &[f32; 4]| (sum[3] / self.pixels).min(1.0);
        let mut bytes = Vec::with_capacity(4 * self.sums.len());
        for sum in &self.sums {
            // Without rows 0 / 0, which is stored as 0.
            let color = |channel: f32| encode8(channel / sum[3]);
            let [r, g, b, _] = *sum;
            let alpha = (255.0 * coverage(sum)).round() as u8;
            bytes.extend([color(r), color(g), color(b), alpha]);
        }
        if bytes.iter().skip(3).step_by(4).all(|&alpha| alpha == 0) {
            return None;
        }
        let mut png = Vec::new();
        let [width, height] = self.size;
        let mut encoder = png::Encoder::new(&mut png, width, height);
        encoder.set_color(png::ColorType::Rgba);
        let written = encoder.write_header().and_then(|mut writer| {
            writer.write_image_data(&bytes)?;
            writer.finish()
        });
        // Into memory; and a picture is not worth a dataset.
        written.ok().map(|()| STANDARD.encode(png))
    }
}

/// Takes the pictures out of the records of parts, with the numbers of their scenes. What is none of ours is left out: records come from
/// outside.
pub(crate) fn take(parts: &mut [Part]) -> Vec<(u32, Vec<u8>)> {
    let pictures = parts.iter_mut().filter_map(|part| {
        let text = part.picture.take()?;
        let png = STANDARD.decode(text).ok()?;
        let is_ours = png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() <= MAX_BYTES;
        is_ours.then_some((part.scene, png))
    });
    let mut pictures: Vec<_> = pictures.collect();
    pictures.dedup_by_key(|(scene, _)| *scene);
    pictures
}
