use earcut::{Earcut, utils3d::project3d_to_2d};
use glam::DVec3;

/// Vertices of the largest concave polygon that is cut: where one of them lies far from all others, `earcut` needs time by their third power.
/// Ten milliseconds for 1,000; a second for 5,000, which a file could ask for in every line.
const MAX_CONCAVE: usize = 1_000;

/// Cuts polygons into triangles; keeps its buffers from polygon to polygon.
#[derive(Default)]
pub(super) struct Triangulator {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
}

impl Triangulator {
    /// Triangles of a polygon, as indices of its vertices, in the polygon's orientation. A convex polygon becomes a fan around its first
    /// vertex, as most programs draw it (`earcut` would choose other diagonals). A polygon that cannot be triangulated (without area, or
    /// meeting itself) becomes a fan too, so that nothing is lost.
    ///
    /// # Errors
    /// A concave polygon of too many vertices.
    pub fn triangulate(&mut self, vertices: &[DVec3]) -> Result<Vec<[usize; 3]>, String> {
        let n = vertices.len();
        let fan = || (1..n.saturating_sub(1)).map(|i| [0, i, i + 1]).collect();
        if n <= 3 {
            return Ok(fan());
        }
        // Far from the origin the projection would lose digits.
        let near = vertices.iter().map(|&v| (v - vertices[0]).to_array());
        let near: Vec<[f64; 3]> = near.collect();
        if !project3d_to_2d(&near, n, &mut self.flat) {
            return Ok(fan());
        }
        // Twice the signed area: the projection makes the polygon counter-clockwise.
        let flat = &self.flat;
        let turn = |[a, b, c]: [usize; 3]| {
            let [a, b, c] = [flat[a], flat[b], flat[c]];
            (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        };
        if (0..n).all(|i| turn([i, (i + 1) % n, (i + 2) % n]) >= 0.0) {
            return Ok(fan());
        }
        if n > MAX_CONCAVE {
            return Err(format!(
                "a concave polygon of {n} vertices, and at most {MAX_CONCAVE} are cut into triangles; triangulate it before the export"
            ));
        }
        let mut indices: Vec<usize> = Vec::new();
        self.earcut.earcut_slice(&self.flat, &[], &mut indices);
        let triangles = indices.chunks_exact(3).map(|t| {
            let t = [t[0], t[1], t[2]];
            if turn(t) < 0.0 { [t[0], t[2], t[1]] } else { t }
        });
        let triangles: Vec<[usize; 3]> = triangles.collect();
        Ok(if triangles.is_empty() {
            fan()
        } else {
            triangles
        })
    }
}

/// The triangles of a strip of so many vertices, as numbers of these: every second one is wound the other way.
pub(super) fn strip(vertices: usize) -> impl Iterator<Item = [usize; 3]> {
    let triangle = |i: usize| match i % 2 {
        0 => [i - 2, i - 1, i],
        _ => [i - 1, i - 2, i],
    };
    (2..vertices).map(triangle)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangulate(points: &[[f64; 2]], z: f64) -> Result<Vec<[usize; 3]>, String> {
        let vertices: Vec<DVec3> = points.iter().map(|&[x, y]| DVec3::new(x, y, z)).collect();
        Triangulator::default().triangulate(&vertices)
    }

    /// A star: every second vertex is concave.
    fn star(n: usize) -> Vec<[f64; 2]> {
        let at = |i: usize| {
            let r = if i.is_multiple_of(2) { 1.0 } else { 0.5 };
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
            [r * cos, r * sin]
        };
        (0..n).map(at).collect()
    }

    /// Every triangle keeps the polygon's orientation, and the areas add up, wherever the polygon begins.
    #[test]
    fn concave_polygons_keep_their_area() {
        let star = star(MAX_CONCAVE);
        let angle = std::f64::consts::TAU / MAX_CONCAVE as f64;
        let cases: [(&[[f64; 2]], f64); 4] = [
            (&[[0., 0.], [1., 0.], [1., 1.], [0., 1.]], 1.0),
            (
                &[[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]],
                3.0,
            ),
            (&[[0., 0.], [2., 1.], [0., 2.], [1., 1.]], 1.0),
            // Every second vertex is a triangle of two radii around the middle.
            (&star, MAX_CONCAVE as f64 * 0.25 * angle.sin()),
        ];
        for (points, exact) in cases {
            for start in 0..4 {
                let mut points = points.to_vec();
                points.rotate_left(start);
                let triangles = triangulate(&points, 5.0).expect("is cut");
                assert_eq!(triangles.len(), points.len() - 2);
                let area = |t: &[usize; 3]| {
                    let [a, b, c] = t.map(|i| points[i]);
                    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
                };
                assert!(triangles.iter().all(|t| area(t) >= -1e-12));
                let sum: f64 = triangles.iter().map(area).sum();
                assert!((sum - exact).abs() < 1e-9, "{sum} {exact}");
            }
        }
    }

    /// Polygons without area lose no vertex, one that meets itself is drawn, and one that would take minutes is refused.
    #[test]
    fn polygons_that_are_none() {
        let line: Vec<[f64; 2]> = (0..5).map(|i| [f64::from(i), 0.0]).collect();
        assert_eq!(triangulate(&line, 0.0).map(|t| t.len()), Ok(3));
        assert_eq!(triangulate(&[[1.0; 2]; 4], 0.0).map(|t| t.len()), Ok(2));
        assert_eq!(triangulate(&[[1.0; 2]; 2], 0.0), Ok(Vec::new()));
        let bow = triangulate(&[[0., 0.], [1., 1.], [1., 0.], [0., 1.]], 0.0);
        assert!(bow.is_ok_and(|t| !t.is_empty()));
        assert!(triangulate(&star(MAX_CONCAVE + 2), 0.0).is_err());
    }
}
