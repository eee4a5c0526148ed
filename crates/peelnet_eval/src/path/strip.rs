//! A few frames of a path side by side, as a picture.

use super::mean_absolute;
use peelnet_core::srgb;
use peelnet_render::Image;

/// Frames of a strip.
const FRAMES: usize = 6;

/// The width of one frame in a strip, pixels, at most.
const WIDTH: u32 = 240;

/// Factor of errors and changes in a strip.
pub(crate) const MAGNIFIED: f32 = 8.0;

/// Frames at even distances: of the exact video the frames, of a method the error image and, below it, its change since the frame before,
/// both magnified by 8. Of a method, the frame of the largest change stands at the end: what pops does so between two frames.
#[derive(Debug)]
pub(crate) struct Strip {
    /// Size of a frame.
    size: [u32; 2],
    /// Pixels of a side that become one.
    shrunk: u32,
    /// Frames of the video.
    frames: usize,
    /// From left to right.
    columns: Vec<Column>,
    /// The largest change and its column.
    worst: Option<(f64, Column)>,
}

/// Rows from above: sRGB-encoded values, 0–255.
type Column = Vec<Vec<[f32; 3]>>;

impl Strip {
    pub fn new(size: [u32; 2], frames: usize) -> Self {
        Self {
            size,
            shrunk: size[0].div_ceil(WIDTH).max(1),
            frames,
            columns: Vec::new(),
            worst: None,
        }
    }

    /// Whether the frame with this number is shown.
    fn shows(&self, number: usize) -> bool {
        let shown = FRAMES.min(self.frames);
        (0..shown).any(|k| k * self.frames / shown == number)
    }

    /// Adds a frame as it is displayed.
    pub fn add_frame(&mut self, number: usize, image: &Image) {
        if self.shows(number) {
            let levels = image.pixels.iter();
            let levels: Vec<[f32; 3]> = levels
                .map(|p| [p[0], p[1], p[2]].map(|c| 255.0 * srgb::encode(c)))
                .collect();
            let small = self.small(&levels, |x| x);
            self.columns.push(vec![small]);
        }
    }

    /// Adds an error image and its change.
    pub fn add_errors(&mut self, number: usize, errors: &[[f32; 3]], change: Option<&[[f32; 3]]>) {
        let amount = change.map_or(0.0, mean_absolute);
        let is_worst = amount > self.worst.as_ref().map_or(0.0, |(most, _)| *most);
        if !(self.shows(number) || is_worst) {
            return;
        }
        let magnified = |x: f32| (x.abs() * MAGNIFIED).min(255.0);
        let none = vec![[0.0; 3]; errors.len()];
        let rows = [errors, change.unwrap_or(&none)];
        let column: Column = rows.map(|levels| self.small(levels, magnified)).into();
        if is_worst {
            self.worst = Some((amount, column.clone()));
        }
        if self.shows(number) {
            self.columns.push(column);
        }
    }

    /// Size of a frame in the strip.
    fn small_size(&self) -> [u32; 2] {
        self.size.map(|n| (n / self.shrunk).max(1))
    }

    /// Means of `value` over squares of pixels.
    fn small(&self, levels: &[[f32; 3]], value: impl Fn(f32) -> f32) -> Vec<[f32; 3]> {
        let [width, height] = self.small_size();
        let n = self.shrunk;
        let mean = |x: u32, y: u32| {
            let mut sum = [0.0f32; 3];
            let mut count = 0.0f32;
            for dy in 0..n.min(self.size[1]) {
                for dx in 0..n.min(self.size[0]) {
                    let place = (y * n + dy) * self.size[0] + x * n + dx;
                    let level = levels[place as usize];
                    for (s, l) in sum.iter_mut().zip(level) {
                        *s += value(l);
                    }
                    count += 1.0;
                }
            }
            sum.map(|s| s / count)
        };
        let rows = 0..height;
        rows.flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| mean(x, y))
            .collect()
    }

    /// The picture, with the same bytes as what was added.
    pub fn image(&self) -> Image {
        let [width, height] = self.small_size();
        let worst = self.worst.iter().map(|(_, column)| column);
        let columns: Vec<&Column> = self.columns.iter().chain(worst).collect();
        let rows = columns.first().map_or(0, |column| column.len());
        let mut pixels = Vec::new();
        for row in 0..rows {
            for y in 0..height as usize {
                for column in &columns {
                    let begin = y * width as usize;
                    let line = &column[row][begin..begin + width as usize];
                    let linear = |level: f32| srgb::decode(level / 255.0);
                    pixels.extend(line.iter().map(|p| {
                        let [r, g, b] = p.map(linear);
                        [r, g, b, 1.0]
                    }));
                }
            }
        }
        Image {
            width: width * columns.len() as u32,
            height: height * rows as u32,
            pixels,
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
