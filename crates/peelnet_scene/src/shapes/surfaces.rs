//! Positions, normals and triangles of surfaces.

use glam::{Vec2, Vec3};
use peelnet_core::random::Random;
use std::f32::consts::TAU;

/// Positions, normals, and triangles.
pub(super) type Surface = (Vec<Vec3>, Vec<Vec3>, Vec<[u32; 3]>);

/// A surface of revolution about y. The profile (radius, y) runs from pole to pole, outside to its right.
pub(super) fn revolve(profile: &[(f32, f32)], segments: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let rings = profile.len() - 2;
    let mut positions = vec![Vec3::new(0.0, profile[0].1, 0.0)];
    for &(r, y) in &profile[1..=rings] {
        for s in 0..segments {
            let a = TAU * s as f32 / segments as f32;
            positions.push(Vec3::new(r * a.cos(), y, -r * a.sin()));
        }
    }
    positions.push(Vec3::new(0.0, profile[rings + 1].1, 0.0));
    let at = |ring: usize, s: usize| (1 + ring * segments + s % segments) as u32;
    let last = positions.len() as u32 - 1;
    let mut triangles = Vec::with_capacity(2 * rings * segments);
    for s in 0..segments {
        triangles.push([0, at(0, s + 1), at(0, s)]);
    }
    for ring in 0..rings - 1 {
        for s in 0..segments {
            let (a, b) = (at(ring, s), at(ring, s + 1));
            let (c, d) = (at(ring + 1, s), at(ring + 1, s + 1));
            triangles.push([a, b, d]);
            triangles.push([a, d, c]);
        }
    }
    for s in 0..segments {
        triangles.push([last, at(rings - 1, s), at(rings - 1, s + 1)]);
    }
    (positions, triangles)
}

/// About `rings` points along a polyline, evenly between its own, which are kept.
pub(super) fn resample(line: &[(f32, f32)], rings: usize) -> Vec<(f32, f32)> {
    let lengths: Vec<f32> = line
        .windows(2)
        .map(|w| (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1))
        .collect();
    let total: f32 = lengths.iter().sum();
    let mut points = vec![line[0]];
    for (w, length) in line.windows(2).zip(&lengths) {
        let steps = ((length / total * (rings + 1) as f32).round() as usize).max(1);
        for i in 1..=steps {
            let t = i as f32 / steps as f32;
            points.push((
                w[0].0 + t * (w[1].0 - w[0].0),
                w[0].1 + t * (w[1].1 - w[0].1),
            ));
        }
    }
    points
}

/// Segments along and around a torus.
pub(super) fn torus_grid(radius: f32, tube: f32, triangles: usize) -> [usize; 2] {
    let around = ((triangles as f32 / 2.0 * (tube / radius)).sqrt().round() as usize).max(3);
    let along = ((triangles as f32 / (2.0 * around as f32)).round() as usize).max(3);
    [along, around]
}

/// A torus about the y axis.
pub(super) fn torus(radius: f32, tube: f32, triangles: usize) -> Surface {
    let [along, around] = torus_grid(radius, tube, triangles);
    let (mut positions, mut normals, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..along {
        let a = TAU * i as f32 / along as f32;
        let out = Vec3::new(a.cos(), 0.0, -a.sin());
        for j in 0..around {
            let b = TAU * j as f32 / around as f32;
            let n = out * b.cos() + Vec3::Y * b.sin();
            positions.push(out * radius + n * tube);
            normals.push(n);
        }
    }
    let at = |i: usize, j: usize| ((i % along) * around + j % around) as u32;
    for i in 0..along {
        for j in 0..around {
            let (a, b) = (at(i, j), at(i + 1, j));
            let (c, d) = (at(i, j + 1), at(i + 1, j + 1));
            faces.push([a, b, d]);
            faces.push([a, d, c]);
        }
    }
    (positions, normals, faces)
}

/// A box of twelve triangles, four vertices a side.
pub(super) fn cuboid(size: [f32; 3]) -> Surface {
    let half = Vec3::from_array(size) / 2.0;
    let (mut positions, mut normals, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for (axis, sign) in [
        (0, 1.0),
        (0, -1.0),
        (1, 1.0),
        (1, -1.0),
        (2, 1.0),
        (2, -1.0),
    ] {
        let unit = |k: usize| {
            let mut v = Vec3::ZERO;
            v[k % 3] = 1.0;
            v
        };
        let n = unit(axis) * sign;
        let (u, v) = (unit(axis + 1) * sign, unit(axis + 2));
        let base = positions.len() as u32;
        for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            positions.push((n + u * a + v * b) * half);
            normals.push(n);
        }
        faces.push([base, base + 1, base + 2]);
        faces.push([base, base + 2, base + 3]);
    }
    (positions, normals, faces)
}

/// A few plane waves through the unit sphere, together between −1 and 1.
pub(super) struct Waves([(Vec3, f32); 5]);

impl Waves {
    pub fn new(seed: u64) -> Self {
        let mut random = Random::new(seed, &[0x0b_00b5]);
        Self([(); 5].map(|()| {
            let direction = Vec3::new(
                random.between(-1.0, 1.0),
                random.between(-1.0, 1.0),
                random.between(-1.0, 1.0),
            );
            let frequency = random.between(2.0, 7.0);
            (
                direction.normalize_or(Vec3::X) * frequency,
                random.between(0.0, TAU),
            )
        }))
    }

    /// The sum at a point of the unit sphere.
    pub fn at(&self, p: Vec3) -> f32 {
        self.0
            .iter()
            .map(|(k, phase)| (k.dot(p) + phase).sin())
            .sum::<f32>()
            / 5.0
    }
}

/// Most points of a profile.
const MAX_POINTS: usize = 10_000;

/// The smooth profile of a lathe: a Catmull–Rom curve (1974) through its points, moved outwards, in even steps.
pub(super) fn lathe(
    points: &[[f32; 2]],
    offset: f32,
    rings: usize,
) -> Result<Vec<(f32, f32)>, String> {
    let n = points.len();
    if n < 3 || points[0][0] != 0.0 || points[n - 1][0] != 0.0 {
        return Err(
            "profile must have three points or more, the first and the last with radius 0".into(),
        );
    }
    if n > MAX_POINTS {
        return Err(format!(
            "profile has {n} points; it has at most {MAX_POINTS}"
        ));
    }
    if points[1..n - 1].iter().any(|p| p[0] <= 0.0)
        || points.iter().flatten().any(|x| !x.is_finite())
    {
        return Err(
            "profile: every radius between its ends must be positive, and all of it finite".into(),
        );
    }
    if !offset.is_finite() {
        return Err("offset must be finite".into());
    }
    let at = |i: isize| Vec2::from(points[i.clamp(0, n as isize - 1) as usize]);
    let mut fine = Vec::new();
    for i in 0..n as isize - 1 {
        let [a, b, c, d] = [-1, 0, 1, 2].map(|k| at(i + k));
        for step in 0..32 {
            let t = step as f32 / 32.0;
            let tangents = [(c - a) * 0.5, (d - b) * 0.5];
            let (t2, t3) = (t * t, t * t * t);
            let p = b * (2.0 * t3 - 3.0 * t2 + 1.0)
                + tangents[0] * (t3 - 2.0 * t2 + t)
                + c * (3.0 * t2 - 2.0 * t3)
                + tangents[1] * (t3 - t2);
            fine.push(p);
        }
    }
    fine.push(at(n as isize - 1));
    let moved: Vec<Vec2> = (0..fine.len())
        .map(|i| {
            let along = fine[(i + 1).min(fine.len() - 1)] - fine[i.saturating_sub(1)];
            fine[i] + Vec2::new(along.y, -along.x).normalize_or_zero() * offset
        })
        .collect();
    let steps = moved.windows(2).map(|w| w[0].distance(w[1]));
    let total: f32 = steps.clone().sum();
    let (mut line, mut gone) = (vec![(0.0, moved[0].y)], 0.0);
    for (w, step) in moved.windows(2).zip(steps) {
        while line.len() <= rings && gone + step >= total * line.len() as f32 / (rings + 1) as f32 {
            let t = (total * line.len() as f32 / (rings + 1) as f32 - gone) / step.max(1e-12);
            let p = w[0].lerp(w[1], t.clamp(0.0, 1.0));
            line.push((p.x.max(1e-4 * total), p.y));
        }
        gone += step;
    }
    line.push((0.0, moved[moved.len() - 1].y));
    Ok(line)
}
