//! Where in a pixel a frame is sampled.

/// Where in its pixel a frame takes its one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplePoint {
    /// From the middle of the pixel, to the right and down, as shares of the width and height of the frame.
    offset: [f32; 2],
}

impl SamplePoint {
    /// The middle of the pixel.
    pub const MIDDLE: Self = Self { offset: [0.0; 2] };

    /// The four samples of a pixel of a frame of this size, where WebGPU's multisampling has them ("standard sample patterns" of the
    /// specification, as in Direct3D): sixteenths of a pixel from its middle.
    pub fn of_four(size: [u32; 2]) -> [Self; 4] {
        const SIXTEENTHS: [[f32; 2]; 4] = [[-2.0, -6.0], [6.0, -2.0], [-6.0, 2.0], [2.0, 6.0]];
        let [width, height] = size.map(|n| 16.0 * n as f32);
        SIXTEENTHS.map(|[x, y]| Self {
            offset: [x / width, y / height],
        })
    }

    /// Moves what lies at the sample into the middle of the pixel, in clip space.
    pub(crate) fn shift(self) -> glam::Mat4 {
        let [x, y] = self.offset;
        // A frame is 2 wide and 2 high in normalised device coordinates, y up; w makes it independent of the distance.
        glam::Mat4::from_translation(glam::Vec3::new(-2.0 * x, 2.0 * y, 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    /// A point at a sample's place in a pixel comes to lie in that pixel's middle, whatever its distance.
    #[test]
    fn samples_move_to_the_middle() {
        let size = [8, 4];
        let expected = [[-2.0, -6.0], [6.0, -2.0], [-6.0, 2.0], [2.0, 6.0]];
        for (point, [x, y]) in SamplePoint::of_four(size).into_iter().zip(expected) {
            // Pixel (5, 1), in pixels from the upper left corner.
            let at = [5.5 + x / 16.0, 1.5 + y / 16.0];
            for w in [0.5, 7.0] {
                let ndc = [at[0] / 4.0 - 1.0, 1.0 - at[1] / 2.0];
                let moved = point.shift() * Vec4::new(ndc[0] * w, ndc[1] * w, 0.3, w);
                let pixel = [(moved.x / w + 1.0) * 4.0, (1.0 - moved.y / w) * 2.0];
                assert!((pixel[0] - 5.5).abs() < 1e-5 && (pixel[1] - 1.5).abs() < 1e-5);
                assert_eq!((moved.z, moved.w), (0.3, w));
            }
        }
        assert_eq!(SamplePoint::MIDDLE.shift(), glam::Mat4::IDENTITY);
    }
}
