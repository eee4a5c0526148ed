//! Triangulation of polygons.

mod sweep;

use earcut::{Earcut, utils3d::project3d_to_2d};
use glam::DVec3;

/// Corners from which on a polygon is swept: `earcut` needs time by their square.
const SWEPT: usize = 1000;

/// Corners of the largest polygon that `earcut` gets, as it copes with most that meet themselves.
const LARGEST_EARCUT: usize = 20_000;

/// Cuts polygons into triangles; keeps its buffers from polygon to polygon.
pub(crate) struct Triangulator {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
}

impl Triangulator {
    pub fn new() -> Self {
        Self {
            earcut: Earcut::new(),
            flat: Vec::new(),
        }
    }

    /// Triangles of a polygon, as indices of its vertices, in the polygon's orientation. A convex polygon becomes a fan around its first
    /// vertex, as most programs draw it (`earcut` would choose other diagonals). A polygon that cannot be triangulated (without area, or
    /// meeting itself) becomes a fan too, so that nothing is lost.
    pub fn triangulate(&mut self, vertices: &[DVec3]) -> Vec<[usize; 3]> {
        let n = vertices.len();
        let fan = || (1..n.saturating_sub(1)).map(|i| [0, i, i + 1]).collect();
        if n <= 3 {
            return fan();
        }
        // Far from the origin the projection would lose digits.
        let near: Vec<[f64; 3]> = vertices
            .iter()
            .map(|&v| (v - vertices[0]).to_array())
            .collect();
        if !project3d_to_2d(&near, n, &mut self.flat) {
            return fan();
        }
        // Twice the signed area: the projection makes the polygon counter-clockwise.
        let flat = &self.flat;
        let turn = |[a, b, c]: [usize; 3]| {
            let [a, b, c] = [flat[a], flat[b], flat[c]];
            (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        };
        if (0..n).all(|i| turn([i, (i + 1) % n, (i + 2) % n]) >= 0.0) {
            return fan();
        }
        if n > SWEPT
            && let Some(triangles) = sweep::triangulate(flat)
        {
            return triangles;
        }
        if n > LARGEST_EARCUT {
            return fan();
        }
        let mut indices: Vec<usize> = Vec::new();
        self.earcut.earcut_slice(&self.flat, &[], &mut indices);
        let triangles = indices.chunks_exact(3).map(|t| {
            let t = [t[0], t[1], t[2]];
            if turn(t) < 0.0 { [t[0], t[2], t[1]] } else { t }
        });
        let triangles: Vec<[usize; 3]> = triangles.collect();
        if triangles.is_empty() {
            return fan();
        }
        triangles
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangulate(vertices: &[DVec3]) -> Vec<[usize; 3]> {
        Triangulator::new().triangulate(vertices)
    }

    fn areas(vertices: &[DVec3], triangles: &[[usize; 3]]) -> Vec<f64> {
        triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| vertices[i]);
                (b - a).cross(c - a).z / 2.0
            })
            .collect()
    }

    #[test]
    fn convex_polygons_become_fans() {
        let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]].map(|[x, y]| DVec3::new(x, y, 0.0));
        assert_eq!(triangulate(&square), [[0, 1, 2], [0, 2, 3]]);
    }

    /// An L and a dart: every triangle keeps the polygon's orientation, and the areas add up.
    #[test]
    fn concave_polygons_keep_their_area() {
        let cases: [(&[[f64; 2]], f64); 2] = [
            (
                &[[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]],
                3.0,
            ),
            (&[[0., 0.], [2., 1.], [0., 2.], [1., 1.]], 1.0),
        ];
        for (points, exact) in cases {
            for start in 0..points.len() {
                let vertices: Vec<DVec3> = (0..points.len())
                    .map(|i| points[(start + i) % points.len()])
                    .map(|[x, y]| DVec3::new(x, y, 5.0))
                    .collect();
                let triangles = triangulate(&vertices);
                assert_eq!(triangles.len(), points.len() - 2);
                let areas = areas(&vertices, &triangles);
                assert!(areas.iter().all(|a| *a >= 0.0), "{areas:?}");
                assert!((areas.iter().sum::<f64>() - exact).abs() < 1e-12);
            }
        }
    }

    /// A star of half a million corners, which takes minutes where every corner is compared with every other, a large one that meets
    /// itself, and large ones without area.
    #[test]
    fn large_polygons_take_no_longer_for_each_corner() {
        let star = |n: usize| {
            let at = |i: usize| {
                let r = if i.is_multiple_of(2) { 1.0 } else { 0.5 };
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
                DVec3::new(r * cos, r * sin, 2.0)
            };
            (0..n).map(at).collect::<Vec<_>>()
        };
        let n = 500_000;
        let mut vertices = star(n);
        let triangles = triangulate(&vertices);
        assert_eq!(triangles.len(), n - 2);
        let areas = areas(&vertices, &triangles);
        assert!(areas.iter().all(|a| *a >= -1e-12));
        // Every second corner is a triangle of two radii around the middle.
        let angle = std::f64::consts::TAU / n as f64;
        let exact = n as f64 * 0.5 * 0.5 * angle.sin();
        assert!((areas.iter().sum::<f64>() - exact).abs() < 1e-9);
        vertices.swap(3, n / 2);
        assert_eq!(triangulate(&vertices).len(), n - 2);
        assert_eq!(triangulate(&vec![DVec3::ONE; n]).len(), n - 2);
        let line: Vec<DVec3> = (0..n).map(|i| DVec3::X * i as f64).collect();
        assert_eq!(triangulate(&line).len(), n - 2);
    }

    /// Polygons without area, and one that meets itself, lose no vertex and do not panic.
    #[test]
    fn polygons_that_are_none_become_fans() {
        let line: Vec<DVec3> = (0..5).map(|i| DVec3::X * f64::from(i)).collect();
        assert_eq!(triangulate(&line).len(), 3);
        assert_eq!(triangulate(&[DVec3::ONE; 4]).len(), 2);
        let bow = [[0., 0.], [1., 1.], [1., 0.], [0., 1.]].map(|[x, y]| DVec3::new(x, y, 0.0));
        assert!(!triangulate(&bow).is_empty());
        assert!(triangulate(&[DVec3::ONE; 2]).is_empty());
    }
}
