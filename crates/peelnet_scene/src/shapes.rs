//! Meshes made by code. Closed ones are watertight, turned outwards, and their corners are shared.

use crate::{Material, Mesh, mesh::smooth_normals};
use glam::{Vec2, Vec3};
use peelnet_core::random::Random;
use serde::Deserialize;
use std::f32::consts::{PI, TAU};

/// Most triangles of a shape.
const MAX_TRIANGLES: usize = 20_000_000;

/// A generated shape: `mesh = { shape = "torus", radius = 1.0 }`. Lengths are scene units, all shapes are centred on the
/// origin, `triangles` is approximate (the nearest count that the shape's grid can have).
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "shape", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Shape {
    /// A sphere.
    Sphere {
        /// Radius.
        #[serde(default = "one")]
        radius: f32,
        /// About how many triangles.
        #[serde(default = "smooth")]
        triangles: usize,
    },
    /// A torus about the y axis.
    Torus {
        /// Distance of the tube's centre from the axis.
        #[serde(default = "one")]
        radius: f32,
        /// Radius of the tube.
        #[serde(default = "third")]
        tube: f32,
        /// About how many triangles.
        #[serde(default = "smooth")]
        triangles: usize,
    },
    /// A box of twelve triangles.
    Box {
        /// Side lengths.
        #[serde(default = "twos")]
        size: [f32; 3],
    },
    /// A rectangle in the xy plane, facing +z, two triangles.
    Quad {
        /// Width and height.
        #[serde(default = "two_twos")]
        size: [f32; 2],
    },
    /// A cylinder with half-sphere caps, along y.
    Capsule {
        /// Radius.
        #[serde(default = "half")]
        radius: f32,
        /// Length of the cylinder between the caps.
        #[serde(default = "one")]
        height: f32,
        /// About how many triangles.
        #[serde(default = "smooth")]
        triangles: usize,
    },
    /// A closed bumpy surface around the origin: a sphere with waves on it.
    Bumpy {
        /// Mean radius.
        #[serde(default = "one")]
        radius: f32,
        /// Height of the bumps as a part of the radius, below 0.5.
        #[serde(default = "quarter")]
        amplitude: f32,
        /// Another seed, another shape.
        #[serde(default)]
        seed: u64,
        /// About how many triangles.
        #[serde(default = "smooth")]
        triangles: usize,
    },
    /// An open vessel with a wall of some thickness, along y: four surfaces seen through its middle.
    Cup {
        /// Outer radius.
        #[serde(default = "one")]
        radius: f32,
        /// Height.
        #[serde(default = "two")]
        height: f32,
        /// Thickness of wall and bottom.
        #[serde(default = "tenth")]
        thickness: f32,
        /// About how many triangles.
        #[serde(default = "smooth")]
        triangles: usize,
    },
    /// A surface of revolution about y whose profile is a smooth curve through points (radius, y): from the axis below along the outside
    /// to the axis again.
    Lathe {
        /// Points of the profile, the first and the last on the axis.
        profile: Vec<[f32; 2]>,
        /// How far outside of the profile: layers of a nested object are lathes of one profile with different offsets.
        #[serde(default)]
        offset: f32,
        /// About how many triangles.
        #[serde(default = "smooth")]
        triangles: usize,
    },
}

const fn one() -> f32 {
    1.0
}
const fn two() -> f32 {
    2.0
}
const fn half() -> f32 {
    0.5
}
const fn quarter() -> f32 {
    0.25
}
const fn tenth() -> f32 {
    0.1
}
const fn third() -> f32 {
    0.35
}
const fn twos() -> [f32; 3] {
    [2.0; 3]
}
const fn two_twos() -> [f32; 2] {
    [2.0; 2]
}
const fn smooth() -> usize {
    2000
}

impl Shape {
    /// The shape's name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Sphere { .. } => "sphere",
            Self::Torus { .. } => "torus",
            Self::Box { .. } => "box",
            Self::Quad { .. } => "quad",
            Self::Capsule { .. } => "capsule",
            Self::Bumpy { .. } => "bumpy",
            Self::Cup { .. } => "cup",
            Self::Lathe { .. } => "lathe",
        }
    }

    /// Makes the mesh; where it is `mapped`, with places on images: u once around, v from the top down along the profile.
    ///
    /// # Errors
    /// A text that names the parameter out of range and what it may be.
    pub fn build(&self, material: &Material, mapped: bool) -> Result<Mesh, String> {
        let ((positions, normals, triangles), unwrap) = match *self {
            Self::Sphere { radius, triangles } => {
                length("radius", radius)?;
                let (rings, segments) = sphere_grid(triangles)?;
                let profile: Vec<_> = (0..=rings + 1)
                    .map(|i| {
                        let a = PI * i as f32 / (rings + 1) as f32;
                        (radius * a.sin(), -radius * a.cos())
                    })
                    .collect();
                let (p, t) = revolve(&profile, segments);
                let n = p.iter().map(|p| p.normalize_or(Vec3::Y)).collect();
                ((p, n, t), Unwrap::Revolved(profile, segments))
            }
            Self::Torus {
                radius,
                tube,
                triangles,
            } => {
                length("tube", tube)?;
                length("radius", radius)?;
                if tube >= radius {
                    return Err(format!("tube {tube} must be smaller than radius {radius}"));
                }
                let surface = torus(radius, tube, count(triangles)?);
                let [_, around] = torus_grid(radius, tube, triangles);
                (surface, Unwrap::Torus(around))
            }
            Self::Box { size } => {
                for s in size {
                    length("size", s)?;
                }
                (cuboid(size), Unwrap::Faces)
            }
            Self::Quad { size } => {
                for s in size {
                    length("size", s)?;
                }
                let [x, y] = size.map(|s| s / 2.0);
                let p = [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| Vec3::new(x, y, 0.0));
                let surface = (p.to_vec(), vec![Vec3::Z; 4], vec![[0, 1, 2], [0, 2, 3]]);
                (surface, Unwrap::Faces)
            }
            Self::Capsule {
                radius,
                height,
                triangles,
            } => {
                length("radius", radius)?;
                length("height", height)?;
                let (rings, segments) = sphere_grid(triangles)?;
                // Two half circles; the straight part lies between the middle rings.
                let rings = rings + rings % 2;
                let profile: Vec<_> = (0..=rings + 1)
                    .map(|i| {
                        let upper = i > rings / 2;
                        let steps = (rings / 2) as f32;
                        let a = if upper {
                            PI / 2.0 * (1.0 + (i - rings / 2 - 1) as f32 / steps)
                        } else {
                            PI / 2.0 * i as f32 / steps
                        };
                        let shift = if upper { height / 2.0 } else { -height / 2.0 };
                        (radius * a.sin(), shift - radius * a.cos())
                    })
                    .collect();
                let (p, t) = revolve(&profile, segments);
                let n = p
                    .iter()
                    .map(|p| {
                        let centre = p.y.clamp(-height / 2.0, height / 2.0);
                        (*p - Vec3::Y * centre).normalize_or(Vec3::Y)
                    })
                    .collect();
                ((p, n, t), Unwrap::Revolved(profile, segments))
            }
            Self::Bumpy {
                radius,
                amplitude,
                seed,
                triangles,
            } => {
                length("radius", radius)?;
                if !(0.0..0.5).contains(&amplitude) {
                    return Err(format!("amplitude {amplitude} must lie in 0 … 0.5"));
                }
                let (rings, segments) = sphere_grid(triangles)?;
                let profile: Vec<_> = (0..=rings + 1)
                    .map(|i| {
                        let a = PI * i as f32 / (rings + 1) as f32;
                        (a.sin(), -a.cos())
                    })
                    .collect();
                let (mut p, t) = revolve(&profile, segments);
                let waves = Waves::new(seed);
                for p in &mut p {
                    *p *= radius * (1.0 + amplitude * waves.at(*p));
                }
                let n = smooth_normals(&p, &t);
                ((p, n, t), Unwrap::Revolved(profile, segments))
            }
            Self::Cup {
                radius,
                height,
                thickness,
                triangles,
            } => {
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
                    (0.0, -h),
                    (radius, -h),
                    (radius, h),
                    (radius - thickness, h),
                    (radius - thickness, thickness - h),
                    (0.0, thickness - h),
                ];
                let (rings, segments) = sphere_grid(triangles)?;
                let profile = resample(&line, rings.max(8));
                let (p, t) = revolve(&profile, segments);
                let n = smooth_normals(&p, &t);
                ((p, n, t), Unwrap::Revolved(profile, segments))
            }
            Self::Lathe {
                ref profile,
                offset,
                triangles,
            } => {
                let (rings, segments) = sphere_grid(triangles)?;
                let profile = lathe(profile, offset, rings)?;
                let (p, t) = revolve(&profile, segments);
                let n = smooth_normals(&p, &t);
                ((p, n, t), Unwrap::Revolved(profile, segments))
            }
        };
        let mut mesh = Mesh::single(self.name(), positions, normals, triangles, material);
        if mapped {
            mesh.uvs = unwrap.uvs(&mesh.triangles);
        }
        Ok(mesh)
    }
}

fn length(name: &str, x: f32) -> Result<(), String> {
    if x.is_finite() && x > 0.0 {
        Ok(())
    } else {
        Err(format!("{name} {x} must be a positive length"))
    }
}

fn count(triangles: usize) -> Result<usize, String> {
    if (8..=MAX_TRIANGLES).contains(&triangles) {
        Ok(triangles)
    } else {
        Err(format!(
            "triangles {triangles} must lie in 8 … {MAX_TRIANGLES}"
        ))
    }
}

/// Rings between the poles and segments around, whose `2 · rings · segments` triangles come nearest to a count, about
/// twice as many segments as rings.
fn sphere_grid(triangles: usize) -> Result<(usize, usize), String> {
    let n = count(triangles)? as f32;
    let rings = ((n / 4.0).sqrt().round() as usize).max(2);
    let segments = ((n / (2.0 * rings as f32)).round() as usize).max(3);
    Ok((rings, segments))
}

/// How a surface lies on an image.
enum Unwrap {
    /// What [`revolve`] made of a profile and segments.
    Revolved(Vec<(f32, f32)>, usize),
    /// What [`torus`] made, with so many segments around the tube.
    Torus(usize),
    /// Pairs of triangles from four corners: each the whole image.
    Faces,
}

impl Unwrap {
    fn uvs(&self, triangles: &[[u32; 3]]) -> Vec<[Vec2; 3]> {
        match self {
            Self::Faces => triangles
                .iter()
                .map(|t| {
                    let corners = [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::X, Vec2::ZERO];
                    t.map(|i| corners[i as usize % 4])
                })
                .collect(),
            Self::Torus(around) => {
                let (n, along) = (*around, triangles.len() / 2 / around);
                let place = |i: u32| {
                    let (i, j) = (i as usize / n, i as usize % n);
                    Vec2::new(i as f32 / along as f32, 1.0 - j as f32 / n as f32)
                };
                triangles.iter().map(|t| unseamed(t.map(place))).collect()
            }
            Self::Revolved(profile, segments) => {
                // Along the profile by length.
                let mut down = vec![0.0];
                for w in profile.windows(2) {
                    let step = (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1);
                    down.push(down[down.len() - 1] + step);
                }
                let total = down[down.len() - 1];
                let poles = [0, (1 + (profile.len() - 2) * segments) as u32];
                let place = |i: u32| {
                    if i == poles[0] {
                        return Vec2::new(0.0, 1.0);
                    } else if i == poles[1] {
                        return Vec2::ZERO;
                    }
                    let (ring, s) = ((i as usize - 1) / segments, (i as usize - 1) % segments);
                    Vec2::new(s as f32 / *segments as f32, 1.0 - down[ring + 1] / total)
                };
                let of = |t: &[u32; 3]| {
                    let Some(pole) = t.iter().position(|i| poles.contains(i)) else {
                        return unseamed(t.map(place));
                    };
                    // A pole lies above the middle of its triangle.
                    let mut all = t.map(place);
                    all[pole].x = all[(pole + 1) % 3].x;
                    all = unseamed(all);
                    all[pole].x = (all[(pole + 1) % 3].x + all[(pole + 2) % 3].x) / 2.0;
                    all
                };
                triangles.iter().map(of).collect()
            }
        }
    }
}

/// A triangle over the seam, where places jump from 1 to 0, goes on beyond 1.
fn unseamed(mut corners: [Vec2; 3]) -> [Vec2; 3] {
    for axis in 0..2 {
        let most = corners.iter().map(|c| c[axis]).fold(0.0, f32::max);
        for c in &mut corners {
            if most - c[axis] > 0.5 {
                c[axis] += 1.0;
            }
        }
    }
    corners
}

/// The smooth profile of a lathe: a Catmull–Rom curve (1974) through its points, moved outwards, in even steps.
fn lathe(points: &[[f32; 2]], offset: f32, rings: usize) -> Result<Vec<(f32, f32)>, String> {
    let n = points.len();
    if n < 3 || points[0][0] != 0.0 || points[n - 1][0] != 0.0 {
        return Err(
            "profile must have three points or more, the first and the last with radius 0".into(),
        );
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

type Surface = (Vec<Vec3>, Vec<Vec3>, Vec<[u32; 3]>);

/// A surface of revolution about y. The profile (radius, y) runs from pole to pole, outside to its right.
fn revolve(profile: &[(f32, f32)], segments: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
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

/// Spreads `rings` points over the inside of a polyline, its corners among them, its ends kept.
fn resample(line: &[(f32, f32)], rings: usize) -> Vec<(f32, f32)> {
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
fn torus_grid(radius: f32, tube: f32, triangles: usize) -> [usize; 2] {
    let around = ((triangles as f32 / 2.0 * (tube / radius)).sqrt().round() as usize).max(3);
    let along = ((triangles as f32 / (2.0 * around as f32)).round() as usize).max(3);
    [along, around]
}

fn torus(radius: f32, tube: f32, triangles: usize) -> Surface {
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

fn cuboid(size: [f32; 3]) -> Surface {
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
struct Waves([(Vec3, f32); 5]);

impl Waves {
    fn new(seed: u64) -> Self {
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

    fn at(&self, p: Vec3) -> f32 {
        self.0
            .iter()
            .map(|(k, phase)| (k.dot(p) + phase).sin())
            .sum::<f32>()
            / 5.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lighting;
    use std::collections::HashMap;

    fn build(text: &str) -> Result<Mesh, String> {
        let shape: Shape = toml::from_str(text).map_err(|e| e.to_string())?;
        shape.build(&Material::default_with(Lighting::Unlit), true)
    }

    fn volume(mesh: &Mesh) -> f64 {
        mesh.triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                f64::from(a.dot(b.cross(c))) / 6.0
            })
            .sum()
    }

    /// Every edge belongs to two triangles, once each way; V − E + F is the surface's Euler characteristic.
    fn check_closed(name: &str, mesh: &Mesh, euler: i64) {
        let mut welded: HashMap<[u32; 3], u32> = HashMap::new();
        let ids: Vec<u32> = mesh
            .positions
            .iter()
            .map(|p| {
                let next = welded.len() as u32;
                // −0 and 0 are one place.
                *welded
                    .entry(p.to_array().map(|x| (x + 0.0).to_bits()))
                    .or_insert(next)
            })
            .collect();
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        for t in &mesh.triangles {
            let t = t.map(|i| ids[i as usize]);
            for k in 0..3 {
                *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
            }
        }
        for (&(a, b), &n) in &edges {
            assert_eq!(n, 1, "{name}: edge {a} {b}");
            assert!(edges.contains_key(&(b, a)), "{name}: edge {a} {b} is open");
        }
        let (v, e, f) = (
            welded.len() as i64,
            edges.len() as i64 / 2,
            mesh.triangles.len() as i64,
        );
        assert_eq!(v - e + f, euler, "{name}");
        assert!(volume(mesh) > 0.0, "{name} is turned inside out");
        for n in &mesh.normals {
            assert!((n.length() - 1.0).abs() < 1e-5, "{name}: normal {n}");
        }
    }

    #[test]
    fn closed_shapes_are_watertight_and_face_outwards() {
        for (text, euler) in [
            ("shape = 'sphere'", 2),
            ("shape = 'torus'", 0),
            ("shape = 'box'\nsize = [1, 2, 3]", 2),
            ("shape = 'capsule'", 2),
            ("shape = 'bumpy'\nseed = 3\namplitude = 0.4", 2),
            ("shape = 'cup'", 2),
            (LATHE, 2),
        ] {
            let mesh = build(text).unwrap_or_else(|e| panic!("{text}: {e}"));
            check_closed(text, &mesh, euler);
            check_unwrapped(text, &mesh);
        }
    }

    const LATHE: &str = "shape = 'lathe'\noffset = 0.05\nprofile = [[0, -1], [0.6, -1], [0.9, 0], [0.4, 0.8], [0.5, 1], [0.3, 0.8], [0.7, 0], [0, -0.8]]";

    /// No triangle is stretched over the seam, none is mirrored, and images stand upright: v falls where y rises, on the outside.
    fn check_unwrapped(name: &str, mesh: &Mesh) {
        assert_eq!(mesh.uvs.len(), mesh.triangles.len(), "{name}");
        for (uv, t) in mesh.uvs.iter().zip(&mesh.triangles) {
            let [a, b, c] = *uv;
            let area = (b - a).perp_dot(c - a);
            // v runs down: what turns left on the surface turns right on the image.
            assert!(area < 0.0, "{name}: {uv:?}");
            for axis in 0..2 {
                let all = uv.map(|p| p[axis]);
                let spread = all.iter().fold(0f32, |m, x| m.max((x - all[0]).abs()));
                assert!(spread <= 0.5 || spread == 1.0, "{name}: {uv:?} of {t:?}");
            }
        }
    }

    #[test]
    fn volumes_are_the_closed_forms() {
        let close = |text: &str, want: f64, relative: f64| {
            let v = volume(&build(text).expect("builds"));
            assert!((v / want - 1.0).abs() < relative, "{text}: {v} for {want}");
        };
        let pi = std::f64::consts::PI;
        // An inscribed grid of n segments misses about (2π/n)²/6 of a circle's area.
        close("shape = 'sphere'\ntriangles = 40000", 4.0 / 3.0 * pi, 1e-3);
        close(
            "shape = 'torus'\nradius = 2\ntube = 0.5\ntriangles = 40000",
            2.0 * pi * pi * 2.0 * 0.25,
            2e-3,
        );
        close("shape = 'box'\nsize = [1, 2, 3]", 6.0, 1e-6);
        close(
            "shape = 'capsule'\nradius = 1\nheight = 2\ntriangles = 40000",
            4.0 / 3.0 * pi + 2.0 * pi,
            2e-3,
        );
        close(
            "shape = 'cup'\nradius = 1\nheight = 2\nthickness = 0.25\ntriangles = 40000",
            2.0 * pi - pi * 0.5625 * 1.75,
            2e-3,
        );
    }

    /// The thesis's models have 11,102 triangles; the figures we compare with, 10,950.
    #[test]
    fn triangle_counts_come_near() {
        for shape in ["sphere", "torus", "capsule", "bumpy", "cup"] {
            for n in [10_950, 11_100] {
                let mesh = build(&format!("shape = '{shape}'\ntriangles = {n}")).expect("builds");
                let off = mesh.triangles.len() as f64 / f64::from(n) - 1.0;
                assert!(
                    off.abs() < 0.03,
                    "{shape}: {} for {n}",
                    mesh.triangles.len()
                );
            }
        }
    }

    #[test]
    fn nonsense_is_refused_by_name() {
        for (text, word) in [
            ("shape = 'sphere'\nradius = -1.0", "radius"),
            ("shape = 'sphere'\ntriangles = 3", "triangles"),
            ("shape = 'torus'\ntube = 2.0", "tube"),
            ("shape = 'sphere'\ntube = 2.0", "tube"),
            ("shape = 'cow'", "cow"),
            ("shape = 'bumpy'\namplitude = 0.9", "amplitude"),
            ("shape = 'lathe'\nprofile = [[0, 0], [1, 1]]", "profile"),
            (
                "shape = 'lathe'\nprofile = [[0, 0], [-1, 1], [0, 2]]",
                "profile",
            ),
        ] {
            let e = build(text).expect_err(text);
            assert!(e.contains(word), "{text}: {e}");
        }
    }
}
