//! False contours: borders at which a method's error jumps although the surfaces stay the same.
//!
//! A *pair* is two pixels that share a side and show the same transparent surfaces in the same order, at least one. A *contour pair* is a
//! pair whose errors differ in some channel by more than [`THRESHOLD`]. `docs/results-files.md` says what counts as a surface, and what
//! else makes errors jump.

use crate::{EvalError, metrics::ERROR_ROUNDING, stage::Stage};
use peelnet_render::Image;
use peelnet_scene::Camera;

/// By how much the errors of a contour pair differ at least, on the 0–255 scale: more than two steps of an 8-bit display.
pub const THRESHOLD: f64 = 2.0;

/// What a difference of two errors must exceed: the threshold and the rounding of both errors, so that exactly two steps are no contour.
pub(crate) const LIMIT: f64 = THRESHOLD + 2.0 * ERROR_ROUNDING;

const RIGHT: u8 = 1;

const BELOW: u8 = 2;

/// The pairs of a frame, a byte a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pairs {
    width: usize,
    /// Which pairs begin at each pixel.
    begins: Vec<u8>,
}

impl Pairs {
    /// The pairs of an image of [`peelnet_render::Renderer::surfaces`].
    pub fn from_surfaces(surfaces: &Image) -> Self {
        let width = surfaces.width as usize;
        let pixels = &surfaces.pixels;
        let same = |a: usize, b: usize| pixels[a] == pixels[b] && pixels[a][3] > 0.0;
        let begins = (0..pixels.len()).map(|i| {
            let right = (i + 1) % width != 0 && same(i, i + 1);
            let below = i + width < pixels.len() && same(i, i + width);
            u8::from(right) * RIGHT + u8::from(below) * BELOW
        });
        Self {
            width,
            begins: begins.collect(),
        }
    }

    /// Those of a view; none where its surfaces need more memory than there is. What it takes is free again before methods draw.
    pub(crate) fn where_they_fit(
        stage: &Stage<'_>,
        size: [u32; 2],
        samples: u32,
        camera: &Camera,
    ) -> Result<Option<Self>, EvalError> {
        let surfaces = stage.surfaces(size, samples);
        match surfaces.and_then(|mut surfaces| stage.image(&mut surfaces, camera)) {
            Err(e) if e.is_of_method() => Ok(None),
            frame => Ok(Some(Self::from_surfaces(&frame?.image))),
        }
    }

    pub fn count(&self) -> u64 {
        self.begins.iter().map(|b| u64::from(b.count_ones())).sum()
    }

    /// The number of contour pairs of an error image of the same size.
    pub fn contours(&self, errors: &[[f32; 3]]) -> u64 {
        let jumps = |a: usize, b: usize| {
            let mut channels = errors[a].iter().zip(&errors[b]);
            channels.any(|(a, b)| (f64::from(*a) - f64::from(*b)).abs() > LIMIT)
        };
        let of_pixel = |(i, begins): (usize, &u8)| {
            let right = begins & RIGHT != 0 && jumps(i, i + 1);
            let below = begins & BELOW != 0 && jumps(i, i + self.width);
            u64::from(right) + u64::from(below)
        };
        self.begins.iter().enumerate().map(of_pixel).sum()
    }

    /// The share of contour pairs among all pairs, 0–1; `None` of a frame without pairs.
    pub fn share(&self, errors: &[[f32; 3]]) -> Option<f64> {
        let pairs = self.count();
        (pairs > 0).then(|| self.contours(errors) as f64 / pairs as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::error_image;
    use peelnet_core::srgb;

    /// The pairs of a frame whose pixels hold these lists of surfaces, by number; 0 is none.
    fn pairs(width: u32, surfaces: &[u32]) -> Pairs {
        let pixels = surfaces.iter();
        Pairs::from_surfaces(&Image {
            width,
            height: surfaces.len() as u32 / width,
            pixels: pixels.map(|&s| [s as f32, 0.0, 0.0, s as f32]).collect(),
        })
    }

    /// Rows do not run on into the next one, and pixels that hold nothing are no pair. An error that jumps by three levels inside a surface is
    /// a contour, across and down and in any channel; where the surfaces change it is none.
    #[test]
    fn pairs_share_surfaces_and_contours_jump_inside_them() {
        let inside = [0.0, 0.0, 3.0, 3.0];
        // Signs count: from 1.5 below to 1.5 above.
        let signs = [-1.5, 1.5, 1.5, -1.5];
        for (width, surfaces, levels, count, contours) in [
            (4, [1, 1, 1, 1], inside, 3, 1),
            (1, [1, 1, 1, 1], inside, 3, 1),
            (2, [1, 1, 1, 1], inside, 4, 2),
            (4, [1, 1, 2, 2], inside, 2, 0),
            (4, [0, 0, 0, 0], inside, 0, 0),
            (4, [1, 1, 1, 1], signs, 3, 2),
        ] {
            let pairs = pairs(width, &surfaces);
            assert_eq!(pairs.count(), count);
            let share = (count > 0).then(|| contours as f64 / count as f64);
            for channel in 0..3 {
                let error = |level| std::array::from_fn(|k| if k == channel { level } else { 0.0 });
                let errors = levels.map(error);
                assert_eq!(pairs.contours(&errors), contours);
                assert_eq!(pairs.share(&errors), share);
            }
        }
    }

    /// Exactly two levels are no contour, three are one: for every level of an 8-bit display, as its linear light is drawn.
    #[test]
    fn two_levels_are_no_contour_and_three_are_one() {
        let light = |level: u32| [srgb::decode(level as f32 / 255.0); 4];
        let two = pairs(2, &[1, 1]);
        for exact in 0..=252 {
            for (levels, want) in [(2, 0), (3, 1)] {
                let approximate = [light(exact), light(exact + levels)];
                let errors = error_image(&[light(exact); 2], &approximate);
                assert_eq!(two.contours(&errors), want, "{exact} + {levels}");
            }
        }
    }
}
