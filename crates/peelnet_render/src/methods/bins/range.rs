//! The range of depths that a method with few intervals of depth spreads them over: the view's, or a pixel's own. The shader is
//! `helpers/range_of_pixel.wgsl`.

/// Whose depths the range spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bounds {
    /// The transparent objects of the view, as the depth warp has it.
    Frame,
    /// The pixel's own fragments, which takes a pass of its own.
    Pixel,
}

/// Ranges of warped depth below this are one depth: 32-bit floats near 1 have 17 values in it.
pub const LEAST_EXTENT: f64 = 1e-6;

/// A range of warped depths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    near: f64,
    extent: f64,
}

impl Range {
    /// The range of a pixel whose fragments have these warped depths.
    pub fn from_depths(bounds: Bounds, zetas: impl Iterator<Item = f64> + Clone) -> Self {
        match bounds {
            Bounds::Frame => Self {
                near: -1.0,
                extent: 2.0,
            },
            Bounds::Pixel => {
                let near = zetas.clone().fold(f64::INFINITY, f64::min);
                let far = zetas.fold(f64::NEG_INFINITY, f64::max);
                Self {
                    near,
                    extent: far - near,
                }
            }
        }
    }

    /// Where in the range a warped depth lies: 0 at its near end, 1 at its far end; 0 in a range that is one depth.
    pub fn place(self, zeta: f64) -> f64 {
        if self.extent < LEAST_EXTENT {
            return 0.0;
        }
        ((zeta - self.near) / self.extent).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_middle() {
        let zetas = [0.25, -0.25, 0.0];
        let of = |bounds| {
            let range = Range::from_depths(bounds, zetas.into_iter());
            zetas.map(|z| range.place(z))
        };
        assert_eq!(of(Bounds::Pixel), [1.0, 0.0, 0.5]);
        assert_eq!(of(Bounds::Frame), [0.625, 0.375, 0.5]);
        let one = Range::from_depths(Bounds::Pixel, [0.3, 0.3].into_iter());
        assert_eq!(one.place(0.3), 0.0);
    }
}
