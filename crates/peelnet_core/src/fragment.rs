//! One surface seen through one pixel, and the order of several.

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    /// Linear depth `z`: distance along the view axis, positive, in scene units.
    pub depth: f32,
    /// Opacity `α`, 0 … 1.
    pub alpha: f32,
    /// Un-premultiplied radiance, linear RGB.
    pub color: [f32; 3],
    /// Window depth `d`, 0 … 1 (only McGuire and Bavoil's eq 10 reads it).
    pub window_depth: f32,
    /// Index of the triangle in the scene's list, which runs object by object: comparing it compares
    /// (object index, primitive index).
    pub triangle: u32,
}

impl Fragment {
    /// A fragment with the values that most methods need; window depth and triangle are zero.
    pub const fn new(depth: f32, alpha: f32, color: [f32; 3]) -> Self {
        Self {
            depth,
            alpha,
            color,
            window_depth: 0.0,
            triangle: 0,
        }
    }

    /// Premultiplied colour `C = α c`.
    pub fn premultiplied(&self) -> [f32; 3] {
        self.color.map(|c| c * self.alpha)
    }
}

/// The one order of the project, front to back: by linear depth, ties by triangle, so that the same scene always gives the
/// same image.
pub fn sort_front_to_back(fragments: &mut [Fragment]) {
    fragments.sort_by(|a, b| (a.depth.total_cmp(&b.depth)).then(a.triangle.cmp(&b.triangle)));
}

/// Linear depth and opacity of each fragment, which is all that estimates of transmittance depend on.
pub fn points(fragments: &[Fragment]) -> Vec<(f32, f32)> {
    fragments.iter().map(|f| (f.depth, f.alpha)).collect()
}

/// `T_i` of every fragment of a sorted pixel, then `T_∞`: `n + 1` values.
///
/// ```
/// # use peelnet_core::fragment::*;
/// assert_eq!(transmittances(&[0.5, 0.25, 1.0]), [1.0, 0.5, 0.375, 0.0]);
/// ```
pub fn transmittances(alphas: &[f32]) -> Vec<f32> {
    let mut t = 1.0;
    let behind = alphas.iter().map(|alpha| {
        t *= 1.0 - alpha;
        t
    });
    std::iter::once(1.0).chain(behind).collect()
}

/// The four fragments that documentation, README and tests explain everything on: red, green and blue of α = ½
/// and a nearly opaque white one behind them, over black.
///
/// Its exact colour is `½ red + ¼ green + ⅛ blue + ⅛·0.9 white = (0.6125, 0.3625, 0.2375)`.
pub fn worked_example() -> [Fragment; 4] {
    [
        Fragment::new(1.0, 0.5, [1.0, 0.0, 0.0]),
        Fragment::new(2.0, 0.5, [0.0, 1.0, 0.0]),
        Fragment::new(4.0, 0.5, [0.0, 0.0, 1.0]),
        Fragment::new(8.0, 0.9, [1.0, 1.0, 1.0]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_by_triangle() {
        let mut f = [(7, 1.0), (3, 1.0), (9, 0.5)].map(|(triangle, depth)| Fragment {
            triangle,
            ..Fragment::new(depth, 0.1, [0.0; 3])
        });
        sort_front_to_back(&mut f);
        assert_eq!(f.map(|f| f.triangle), [9, 3, 7]);
    }
}
