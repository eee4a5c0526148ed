//! A few frames of a path side by side, as a picture.

use super::mean_absolute;
use image::{Rgba, Rgba32FImage, imageops};
use peelnet_core::srgb;
use peelnet_render::Image;

const FRAMES: usize = 6;

/// The width of one frame in a strip, pixels, at most.
const WIDTH: u32 = 240;

/// Factor of errors and changes in a strip.
const MAGNIFIED: f32 = 8.0;

/// Frames at even distances: of the exact video the frames, of a method the error image and, below it, its change since the frame before,
/// both magnified by 8. Of a method, the frame of the largest change stands at the end: what pops does so between two frames.
pub(crate) struct Strip {
    size: [u32; 2],
    frames: usize,
    /// From left to right, in linear light.
    columns: Vec<Rgba32FImage>,
    worst: Option<(f64, Rgba32FImage)>,
}

impl Strip {
    pub fn new(size: [u32; 2], frames: usize) -> Self {
        Self {
            size,
            frames,
            columns: Vec::new(),
            worst: None,
        }
    }

    fn shows(&self, number: usize) -> bool {
        let shown = FRAMES.min(self.frames);
        (0..shown).any(|k| k * self.frames / shown == number)
    }

    pub fn add_frame(&mut self, number: usize, image: &Image) {
        if self.shows(number) {
            let level = |p: &[f32; 4]| [p[0], p[1], p[2]].map(|c| 255.0 * srgb::encode(c));
            let levels: Vec<[f32; 3]> = image.pixels.iter().map(level).collect();
            self.columns.push(self.shrunk(&[&levels], |x| x));
        }
    }

    pub fn add_errors(&mut self, number: usize, errors: &[[f32; 3]], change: Option<&[[f32; 3]]>) {
        let amount = change.map_or(0.0, mean_absolute);
        let is_worst = amount > self.worst.as_ref().map_or(0.0, |(most, _)| *most);
        if !(self.shows(number) || is_worst) {
            return;
        }
        let none = vec![[0.0; 3]; errors.len()];
        let magnified = |x: f32| (x.abs() * MAGNIFIED).min(255.0);
        let column = self.shrunk(&[errors, change.unwrap_or(&none)], magnified);
        if is_worst {
            self.worst = Some((amount, column.clone()));
        }
        if self.shows(number) {
            self.columns.push(column);
        }
    }

    /// Images one below the other, as means of `value` over squares of pixels; both are sRGB-encoded, 0–255.
    fn shrunk(&self, images: &[&[[f32; 3]]], value: impl Fn(f32) -> f32) -> Rgba32FImage {
        let [width, height] = self.size;
        let side = width.div_ceil(WIDTH).max(1);
        let [columns, rows] = self.size.map(|n| (n / side).max(1));
        Rgba32FImage::from_fn(columns, rows * images.len() as u32, |x, y| {
            let levels = images[(y / rows) as usize];
            let (mut sum, mut count) = ([0.0f32; 3], 0.0f32);
            for dy in 0..side.min(height) {
                for dx in 0..side.min(width) {
                    let place = (y % rows * side + dy) * width + x * side + dx;
                    for (s, &level) in sum.iter_mut().zip(&levels[place as usize]) {
                        *s += value(level);
                    }
                    count += 1.0;
                }
            }
            let [r, g, b] = sum.map(|s| srgb::decode(s / count / 255.0));
            Rgba([r, g, b, 1.0])
        })
    }

    /// The picture, with the same bytes as what was added.
    pub fn image(&self) -> Image {
        let worst = self.worst.iter().map(|(_, column)| column);
        let columns: Vec<_> = self.columns.iter().chain(worst).collect();
        let (width, height) = columns.first().map_or((0, 0), |c| c.dimensions());
        let mut strip = Rgba32FImage::new(width * columns.len() as u32, height);
        for (column, k) in columns.into_iter().zip(0..) {
            imageops::replace(&mut strip, column, k * i64::from(width), 0);
        }
        Image {
            width: strip.width(),
            height,
            pixels: strip.pixels().map(|p| p.0).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six of twelve frames stand side by side; an error of 5 levels is shown as 40 and its change of −3 as 24, by the shrunk frame. At the
    /// end stands the frame of the largest change, −4.
    #[test]
    fn frames_stand_side_by_side() {
        let size = [2 * WIDTH, 4];
        let mut strip = Strip::new(size, 12);
        let pixels = (size[0] * size[1]) as usize;
        for number in 0..12 {
            let change = if number == 7 { -4.0 } else { -3.0 };
            let errors = vec![[5.0; 3]; pixels];
            strip.add_errors(number, &errors, Some(&vec![[change; 3]; pixels]));
        }
        let image = strip.image();
        assert_eq!((image.width, image.height), (7 * WIDTH, 4));
        let bytes = image.to_srgb8();
        let (errors, changes) = bytes.split_at(bytes.len() / 2);
        assert!(errors.iter().all(|&b| b == 40));
        let row = 3 * image.width as usize;
        for row in changes.chunks_exact(row) {
            let (even, worst) = row.split_at(row.len() / 7 * 6);
            assert!(even.iter().all(|&b| b == 24) && worst.iter().all(|&b| b == 32));
        }
    }
}
