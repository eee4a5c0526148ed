//! Surfaces of revolution about y.

use super::{Bumpy, Capsule, Cup, Lathe, Sphere, count, length, unseam, waves::Waves};
use crate::mesh::Mesh;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Rings between the poles and segments around, whose `2 · rings · segments` triangles come nearest to a count, about
/// twice as many segments as rings.
fn grid(triangles: usize) -> Result<(usize, usize), String> {
    let n = count(triangles)? as f32;
    let rings = ((n / 4.0).sqrt().round() as usize).max(2);
    let segments = ((n / (2.0 * rings as f32)).round() as usize).max(3);
    Ok((rings, segments))
}

/// A surface of revolution. The profile (radius, y) runs from pole to pole, outside to its right.
fn revolve(profile: &[Vec2], segments: usize) -> Mesh {
    let rings = profile.len() - 2;
    let mut surface = Mesh::default();
    let positions = &mut surface.positions;
    positions.push(Vec3::new(0.0, profile[0].y, 0.0));
    for p in &profile[1..=rings] {
        positions.extend((0..segments).map(|s| {
            let a = TAU * s as f32 / segments as f32;
            Vec3::new(p.x * a.cos(), p.y, -p.x * a.sin())
        }));
    }
    positions.push(Vec3::new(0.0, profile[rings + 1].y, 0.0));
    let last = positions.len() as u32 - 1;
    let at = |ring: usize, s: usize| (1 + ring * segments + s % segments) as u32;
    let bottom = (0..segments).map(|s| [0, at(0, s + 1), at(0, s)]);
    surface.triangles.extend(bottom);
    for ring in 0..rings - 1 {
        for s in 0..segments {
            let [lower, upper] = [ring, ring + 1].map(|ring| [at(ring, s), at(ring, s + 1)]);
            surface.push_rectangle([lower[0], lower[1], upper[0], upper[1]]);
        }
    }
    let top = (0..segments).map(|s| [last, at(rings - 1, s), at(rings - 1, s + 1)]);
    surface.triangles.extend(top);
    // v goes with the length of the profile.
    let mut down = vec![0.0];
    for w in profile.windows(2) {
        down.push(down[down.len() - 1] + (w[1].x - w[0].x).hypot(w[1].y - w[0].y));
    }
    let total = down[rings + 1];
    surface.unwrap(|i| match i {
        0 => Vec2::Y,
        i if i == last as usize => Vec2::ZERO,
        i => {
            let (ring, s) = ((i - 1) / segments, (i - 1) % segments);
            Vec2::new(s as f32 / segments as f32, 1.0 - down[ring + 1] / total)
        }
    });
    for (uvs, t) in surface.uvs.iter_mut().zip(&surface.triangles) {
        let pole = t.iter().position(|i| [0, last].contains(i));
        // A pole's u lies in the middle of its triangle.
        if let Some(pole) = pole {
            uvs[pole].x = uvs[(pole + 1) % 3].x;
        }
        unseam(uvs);
        if let Some(pole) = pole {
            uvs[pole].x = (uvs[(pole + 1) % 3].x + uvs[(pole + 2) % 3].x) / 2.0;
        }
    }
    surface
}

/// A half circle of radius 1 as a profile, from pole to pole.
fn half_circle(rings: usize) -> impl Iterator<Item = Vec2> {
    (0..=rings + 1).map(move |i| {
        let a = PI * i as f32 / (rings + 1) as f32;
        Vec2::new(a.sin(), -a.cos())
    })
}

impl Sphere {
    pub(super) fn surface(&self) -> Result<Mesh, String> {
        length("radius", self.radius)?;
        let (rings, segments) = grid(self.triangles)?;
        let profile: Vec<Vec2> = half_circle(rings).map(|p| self.radius * p).collect();
        let mut surface = revolve(&profile, segments);
        let out = |p: &Vec3| p.normalize_or(Vec3::Y);
        surface.normals = surface.positions.iter().map(out).collect();
        Ok(surface)
    }
}

impl Capsule {
    pub(super) fn surface(&self) -> Result<Mesh, String> {
        let &Self { radius, height, .. } = self;
        length("radius", radius)?;
        length("height", height)?;
        let (rings, segments) = grid(self.triangles)?;
        // Two half circles; the straight part lies between the middle rings.
        let rings = rings + rings % 2;
        let steps = (rings / 2) as f32;
        let profile = (0..=rings + 1).map(|i| {
            let (a, shift) = if i > rings / 2 {
                let i = i - rings / 2 - 1;
                (PI / 2.0 * (1.0 + i as f32 / steps), height / 2.0)
            } else {
                (PI / 2.0 * i as f32 / steps, -height / 2.0)
            };
            Vec2::new(radius * a.sin(), shift - radius * a.cos())
        });
        let mut surface = revolve(&profile.collect::<Vec<_>>(), segments);
        let out = |p: &Vec3| {
            let centre = p.y.clamp(-height / 2.0, height / 2.0);
            (*p - Vec3::Y * centre).normalize_or(Vec3::Y)
        };
        surface.normals = surface.positions.iter().map(out).collect();
        Ok(surface)
    }
}

impl Bumpy {
    pub(super) fn surface(&self) -> Result<Mesh, String> {
        length("radius", self.radius)?;
        if !(0.0..0.5).contains(&self.amplitude) {
            return Err(format!("amplitude {} must lie in 0 … 0.5", self.amplitude));
        }
        let (rings, segments) = grid(self.triangles)?;
        let mut surface = revolve(&half_circle(rings).collect::<Vec<_>>(), segments);
        let waves = Waves::new(self.seed);
        for p in &mut surface.positions {
            *p *= self.radius * (1.0 + self.amplitude * waves.at(*p));
        }
        Ok(surface)
    }
}

impl Cup {
    pub(super) fn surface(&self) -> Result<Mesh, String> {
        let (radius, height, thickness) = (self.radius, self.height, self.thickness);
        length("radius", radius)?;
        length("height", height)?;
        length("thickness", thickness)?;
        if thickness >= radius.min(height) / 2.0 {
            return Err(format!(
                "thickness {thickness} must be below half of radius and height"
            ));
        }
        let h = height / 2.0;
        // Up the outside, over the rim, down the inside.
        let line = [
            [0.0, -h],
            [radius, -h],
            [radius, h],
            [radius - thickness, h],
            [radius - thickness, thickness - h],
            [0.0, thickness - h],
        ];
        let (rings, segments) = grid(self.triangles)?;
        let profile = resample(&line.map(Vec2::from), rings.max(8));
        Ok(revolve(&profile, segments))
    }
}

/// About `rings` points along a polyline, evenly between its own, which are kept.
fn resample(line: &[Vec2], rings: usize) -> Vec<Vec2> {
    let length = |w: &[Vec2]| (w[1].x - w[0].x).hypot(w[1].y - w[0].y);
    let total: f32 = line.windows(2).map(length).sum();
    let mut points = vec![line[0]];
    for w in line.windows(2) {
        let steps = ((length(w) / total * (rings + 1) as f32).round() as usize).max(1);
        points.extend((1..=steps).map(|i| w[0] + i as f32 / steps as f32 * (w[1] - w[0])));
    }
    points
}

const MAX_POINTS: usize = 10_000;

impl Lathe {
    pub(super) fn surface(&self) -> Result<Mesh, String> {
        let (rings, segments) = grid(self.triangles)?;
        self.check()?;
        Ok(revolve(&self.profile(rings), segments))
    }

    fn check(&self) -> Result<(), String> {
        let points = &self.profile;
        let n = points.len();
        let message = if n < 3 || points[0][0] != 0.0 || points[n - 1][0] != 0.0 {
            "profile must have three points or more, the first and the last with radius 0".into()
        } else if n > MAX_POINTS {
            format!("profile has {n} points; it has at most {MAX_POINTS}")
        } else if points[1..n - 1].iter().any(|p| p[0] <= 0.0)
            || points.iter().flatten().any(|x| !x.is_finite())
        {
            "profile: every radius between its ends must be positive, and all of it finite".into()
        } else if !self.offset.is_finite() {
            "offset must be finite".into()
        } else {
            return Ok(());
        };
        Err(message)
    }

    /// A Catmull–Rom curve (1974) through the points, moved outwards, in even steps.
    fn profile(&self, rings: usize) -> Vec<Vec2> {
        let n = self.profile.len() as isize;
        let at = |i: isize| Vec2::from(self.profile[i.clamp(0, n - 1) as usize]);
        let mut fine = Vec::new();
        for i in 0..n - 1 {
            let [a, b, c, d] = [-1, 0, 1, 2].map(|k| at(i + k));
            for step in 0..32 {
                let t = step as f32 / 32.0;
                let tangents = [(c - a) * 0.5, (d - b) * 0.5];
                let (t2, t3) = (t * t, t * t * t);
                fine.push(
                    b * (2.0 * t3 - 3.0 * t2 + 1.0)
                        + tangents[0] * (t3 - 2.0 * t2 + t)
                        + c * (3.0 * t2 - 2.0 * t3)
                        + tangents[1] * (t3 - t2),
                );
            }
        }
        fine.push(at(n - 1));
        let moved = (0..fine.len()).map(|i| {
            let along = fine[(i + 1).min(fine.len() - 1)] - fine[i.saturating_sub(1)];
            fine[i] + Vec2::new(along.y, -along.x).normalize_or_zero() * self.offset
        });
        let moved: Vec<Vec2> = moved.collect();
        let steps = moved.windows(2).map(|w| w[0].distance(w[1]));
        let total: f32 = steps.clone().sum();
        let (mut line, mut gone) = (vec![Vec2::new(0.0, moved[0].y)], 0.0);
        for (w, step) in moved.windows(2).zip(steps) {
            let next = |line: &[Vec2]| total * line.len() as f32 / (rings + 1) as f32;
            while line.len() <= rings && gone + step >= next(&line) {
                let t = (next(&line) - gone) / step.max(1e-12);
                let p = w[0].lerp(w[1], t.clamp(0.0, 1.0));
                line.push(Vec2::new(p.x.max(1e-4 * total), p.y));
            }
            gone += step;
        }
        line.push(Vec2::new(0.0, moved[moved.len() - 1].y));
        line
    }
}
