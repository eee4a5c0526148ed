/// Where in its pixels a frame takes its samples, or which pixel of a larger frame it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplePoint {
    /// From the middle of the pixel, to the right and down, as shares of the width and height of the frame.
    offset: [f32; 2],
    /// Pixels of the frame that is looked at over those that are drawn.
    zoom: [f32; 2],
}

impl SamplePoint {
    pub const MIDDLE: Self = Self {
        offset: [0.0; 2],
        zoom: [1.0; 2],
    };

    /// The four samples of a pixel of a frame of this size, where WebGPU's multisampling has them ("standard sample patterns" of the
    /// specification, as in Direct3D): sixteenths of a pixel from its middle.
    pub fn of_four(size: [u32; 2]) -> [Self; 4] {
        const SIXTEENTHS: [[f32; 2]; 4] = [[-2.0, -6.0], [6.0, -2.0], [-6.0, 2.0], [2.0, 6.0]];
        let [width, height] = size.map(|n| 16.0 * n as f32);
        SIXTEENTHS.map(|[x, y]| Self {
            offset: [x / width, y / height],
            ..Self::MIDDLE
        })
    }

    /// One pixel of a frame of this size, counted from the upper left corner: a frame of one pixel that has the larger one's aspect shows it.
    pub fn of_pixel(size: [u32; 2], pixel: [u32; 2]) -> Self {
        let share = |k: usize| (pixel[k] as f32 + 0.5) / size[k] as f32 - 0.5;
        Self {
            offset: [share(0), share(1)],
            zoom: size.map(|n| n as f32),
        }
    }

    /// Moves what lies at the sample into the middle of the pixel, in clip space.
    pub(crate) fn shift(self) -> glam::Mat4 {
        let [x, y] = self.offset;
        let [wide, high] = self.zoom;
        // A frame is 2 wide and 2 high in normalised device coordinates, y up; w makes it independent of the distance.
        let moved = glam::Mat4::from_translation(glam::Vec3::new(-2.0 * x, 2.0 * y, 0.0));
        glam::Mat4::from_scale(glam::Vec3::new(wide, high, 1.0)) * moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    /// Where a place in a frame of 8 x 4 pixels, counted from the upper left corner, comes to lie in normalised device coordinates, at
    /// two distances.
    fn moved(point: SamplePoint, [x, y]: [f32; 2]) -> [[f32; 2]; 2] {
        let ndc = [x / 4.0 - 1.0, 1.0 - y / 2.0];
        [0.5, 7.0].map(|w| {
            let moved = point.shift() * Vec4::new(ndc[0] * w, ndc[1] * w, 0.3, w);
            assert_eq!((moved.z, moved.w), (0.3, w));
            [moved.x / w, moved.y / w]
        })
    }

    /// A sample's place in a pixel comes to lie in that pixel's middle; the corners of a pixel, in those of the frame.
    #[test]
    fn samples_move_to_the_middle_and_a_pixel_fills_the_frame() {
        let near = |a: [f32; 2], b: [f32; 2]| (0..2).all(|k| (a[k] - b[k]).abs() < 1e-5);
        let four = SamplePoint::of_four([8, 4]).into_iter();
        let expected = [[-2.0, -6.0], [6.0, -2.0], [-6.0, 2.0], [2.0, 6.0]];
        for (point, [x, y]) in four.zip(expected) {
            let middle = [5.5 / 4.0 - 1.0, 1.0 - 1.5 / 2.0];
            for place in moved(point, [5.5 + x / 16.0, 1.5 + y / 16.0]) {
                assert!(near(place, middle), "{place:?}");
            }
        }
        let point = SamplePoint::of_pixel([8, 4], [5, 1]);
        for (corner, want) in [([5.0, 1.0], [-1.0, 1.0]), ([6.0, 2.0], [1.0, -1.0])] {
            for place in moved(point, corner) {
                assert!(near(place, want), "{place:?}");
            }
        }
        assert_eq!(SamplePoint::MIDDLE.shift(), glam::Mat4::IDENTITY);
    }
}
