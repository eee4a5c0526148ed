//! Cutting polygons into triangles.

use glam::{DVec2, DVec3};

/// Cuts a polygon, given by its corners in order, into n − 2 triangles of corner numbers. Convex polygons become fans;
/// others lose one ear after another (Meisters 1975). Where no ear can be found (a polygon that meets itself), the rest
/// becomes a fan, so that nothing is lost.
pub(crate) fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let n = corners.len();
    let fan = |rest: &[usize]| -> Vec<[usize; 3]> {
        (1..rest.len().saturating_sub(1))
            .map(|i| [rest[0], rest[i], rest[i + 1]])
            .collect()
    };
    let mut left: Vec<usize> = (0..n).collect();
    if n <= 3 {
        return fan(&left);
    }
    // Newell's normal: of all polygons, also those that are not quite flat.
    let normal: DVec3 = (0..n)
        .map(|i| (corners[i] - corners[0]).cross(corners[(i + 1) % n] - corners[0]))
        .sum();
    let Some(normal) = normal.try_normalize() else {
        return fan(&left);
    };
    let (u, v) = normal.any_orthonormal_pair();
    // u × v must be the normal, so that the flat polygon runs counterclockwise.
    let v = if u.cross(v).dot(normal) < 0.0 { -v } else { v };
    let flat: Vec<DVec2> = corners
        .iter()
        .map(|&c| DVec2::new((c - corners[0]).dot(u), (c - corners[0]).dot(v)))
        .collect();
    let turn = |a: usize, b: usize, c: usize| (flat[b] - flat[a]).perp_dot(flat[c] - flat[b]);
    if (0..n).all(|i| turn(i, (i + 1) % n, (i + 2) % n) >= 0.0) {
        return fan(&left);
    }
    let mut triangles = Vec::with_capacity(n - 2);
    while left.len() > 3 {
        let m = left.len();
        let ear = (0..m).find(|&i| {
            let [a, b, c] = [left[(i + m - 1) % m], left[i], left[(i + 1) % m]];
            turn(a, b, c) > 0.0
                && left.iter().all(|&p| {
                    [a, b, c].contains(&p)
                        || turn(a, b, p) < 0.0
                        || turn(b, c, p) < 0.0
                        || turn(c, a, p) < 0.0
                })
        });
        let Some(i) = ear else { break };
        triangles.push([left[(i + m - 1) % m], left[i], left[(i + 1) % m]]);
        left.remove(i);
    }
    triangles.extend(fan(&left));
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[DVec3], triangles: &[[usize; 3]]) -> Vec<f64> {
        triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| corners[i]);
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
                let corners: Vec<DVec3> = (0..points.len())
                    .map(|i| points[(start + i) % points.len()])
                    .map(|[x, y]| DVec3::new(x, y, 5.0))
                    .collect();
                let triangles = triangulate(&corners);
                assert_eq!(triangles.len(), points.len() - 2);
                let areas = area(&corners, &triangles);
                assert!(areas.iter().all(|a| *a >= 0.0), "{areas:?}");
                assert!((areas.iter().sum::<f64>() - exact).abs() < 1e-12);
            }
        }
    }
}
