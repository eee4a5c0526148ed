//! Generated meshes. Closed ones are watertight, face outwards, and share their vertices; quads, strands and terrain are open.

mod strands;
mod surfaces;
mod terrain;
#[cfg(test)]
mod tests;
mod unwrap;

use crate::{
    budget::MAX_COORDINATE,
    material::Material,
    mesh::{Mesh, smooth_normals},
};
use glam::Vec3;
use serde::Deserialize;
use std::f32::consts::PI;
use strands::Strands;
use surfaces::{Surface, Waves, cuboid, lathe, resample, revolve, torus, torus_grid};
use unwrap::Unwrap;

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
        /// Distance outside of the profile: the layers of a nested object are lathes of one profile with different offsets.
        #[serde(default)]
        offset: f32,
        /// About how many triangles.
        #[serde(default = "smooth")]
        triangles: usize,
    },
    /// Hair: thin ribbons that grow out of the upper part of a sphere around the origin and hang down around it.
    Strands {
        /// Radius of the sphere.
        #[serde(default = "one")]
        radius: f32,
        /// Number of strands.
        #[serde(default = "thousand")]
        count: usize,
        /// Rectangles of a strand, two triangles each.
        #[serde(default = "eight")]
        segments: usize,
        /// Length of the longest strand; the others have 0.7 of it or more.
        #[serde(default = "one")]
        length: f32,
        /// Width at the root; it falls to a third towards the tip.
        #[serde(default = "hundredth")]
        width: f32,
        /// How soon a strand hangs down: 0 grows straight outwards.
        #[serde(default = "one")]
        droop: f32,
        /// How far a strand winds about its course: 0 is straight hair.
        #[serde(default)]
        curl: f32,
        /// Height of the lowest roots as a part of the radius, −1 … 1.
        #[serde(default)]
        roots: f32,
        /// Another seed, other strands.
        #[serde(default)]
        seed: u64,
    },
    /// Land over the xz plane: ridges and valleys, open below.
    Terrain {
        /// Extent along x and z.
        #[serde(default = "two_twos")]
        size: [f32; 2],
        /// Height between the lowest and the highest place.
        #[serde(default = "half")]
        height: f32,
        /// Another seed, another land.
        #[serde(default)]
        seed: u64,
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
const fn thousand() -> usize {
    1000
}
const fn eight() -> usize {
    8
}
const fn hundredth() -> f32 {
    0.01
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
            Self::Strands { .. } => "strands",
            Self::Terrain { .. } => "terrain",
        }
    }

    /// About how many triangles it has.
    pub(crate) const fn triangles(&self) -> usize {
        match self {
            Self::Box { .. } => 12,
            Self::Quad { .. } => 2,
            Self::Strands {
                count, segments, ..
            } => count.saturating_mul(*segments).saturating_mul(2),
            Self::Sphere { triangles, .. }
            | Self::Torus { triangles, .. }
            | Self::Capsule { triangles, .. }
            | Self::Bumpy { triangles, .. }
            | Self::Cup { triangles, .. }
            | Self::Lathe { triangles, .. }
            | Self::Terrain { triangles, .. } => *triangles,
        }
    }

    /// Makes the mesh, with UVs where `has_uvs` asks for them: u once around, v from the top down along the profile.
    ///
    /// # Errors
    /// A text that names the parameter out of range and its bounds.
    pub fn build(&self, material: &Material, has_uvs: bool) -> Result<Mesh, String> {
        let ((positions, normals, triangles), unwrap) = self.surface()?;
        let mut mesh = Mesh::single(self.name(), positions, normals, triangles, material);
        if has_uvs {
            mesh.uvs = unwrap.uvs(&mesh.triangles);
        }
        Ok(mesh)
    }

    /// The shape's surface, and how its UVs are made.
    fn surface(&self) -> Result<(Surface, Unwrap), String> {
        match *self {
            Self::Sphere { radius, triangles } => sphere(radius, triangles),
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
                Ok((surface, Unwrap::Torus(around)))
            }
            Self::Box { size } => {
                for s in size {
                    length("size", s)?;
                }
                Ok((cuboid(size), Unwrap::Faces))
            }
            Self::Quad { size } => {
                for s in size {
                    length("size", s)?;
                }
                let [x, y] = size.map(|s| s / 2.0);
                let p = [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| Vec3::new(x, y, 0.0));
                let surface = (p.to_vec(), vec![Vec3::Z; 4], vec![[0, 1, 2], [0, 2, 3]]);
                Ok((surface, Unwrap::Faces))
            }
            Self::Capsule {
                radius,
                height,
                triangles,
            } => capsule(radius, height, triangles),
            Self::Bumpy {
                radius,
                amplitude,
                seed,
                triangles,
            } => bumpy(radius, amplitude, seed, triangles),
            Self::Cup {
                radius,
                height,
                thickness,
                triangles,
            } => cup(radius, height, thickness, triangles),
            Self::Lathe {
                ref profile,
                offset,
                triangles,
            } => {
                let (rings, segments) = sphere_grid(triangles)?;
                let profile = lathe(profile, offset, rings)?;
                Ok(smooth_revolved(profile, segments))
            }
            Self::Strands {
                radius,
                count,
                segments,
                length,
                width,
                droop,
                curl,
                roots,
                seed,
            } => Strands {
                radius,
                count,
                segments,
                length,
                width,
                droop,
                curl,
                roots,
                seed,
            }
            .build(),
            Self::Terrain {
                size,
                height,
                seed,
                triangles,
            } => terrain::build(size, height, seed, triangles),
        }
    }
}

/// A half circle of radius 1 as a profile, from pole to pole.
fn half_circle(rings: usize) -> impl Iterator<Item = (f32, f32)> {
    (0..=rings + 1).map(move |i| {
        let a = PI * i as f32 / (rings + 1) as f32;
        (a.sin(), -a.cos())
    })
}

/// A surface of revolution whose normals are computed.
fn smooth_revolved(profile: Vec<(f32, f32)>, segments: usize) -> (Surface, Unwrap) {
    let (positions, triangles) = revolve(&profile, segments);
    let normals = smooth_normals(&positions, &triangles);
    let surface = (positions, normals, triangles);
    (surface, Unwrap::Revolved(profile, segments))
}

fn sphere(radius: f32, triangles: usize) -> Result<(Surface, Unwrap), String> {
    length("radius", radius)?;
    let (rings, segments) = sphere_grid(triangles)?;
    let profile: Vec<_> = half_circle(rings)
        .map(|(r, y)| (radius * r, radius * y))
        .collect();
    let (positions, triangles) = revolve(&profile, segments);
    let normals = positions.iter().map(|p| p.normalize_or(Vec3::Y)).collect();
    let surface = (positions, normals, triangles);
    Ok((surface, Unwrap::Revolved(profile, segments)))
}

fn capsule(radius: f32, height: f32, triangles: usize) -> Result<(Surface, Unwrap), String> {
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
    let (positions, triangles) = revolve(&profile, segments);
    let normals = positions
        .iter()
        .map(|p| {
            let centre = p.y.clamp(-height / 2.0, height / 2.0);
            (*p - Vec3::Y * centre).normalize_or(Vec3::Y)
        })
        .collect();
    let surface = (positions, normals, triangles);
    Ok((surface, Unwrap::Revolved(profile, segments)))
}

fn bumpy(
    radius: f32,
    amplitude: f32,
    seed: u64,
    triangles: usize,
) -> Result<(Surface, Unwrap), String> {
    length("radius", radius)?;
    if !(0.0..0.5).contains(&amplitude) {
        return Err(format!("amplitude {amplitude} must lie in 0 … 0.5"));
    }
    let (rings, segments) = sphere_grid(triangles)?;
    let profile: Vec<_> = half_circle(rings).collect();
    let (mut positions, triangles) = revolve(&profile, segments);
    let waves = Waves::new(seed);
    for p in &mut positions {
        *p *= radius * (1.0 + amplitude * waves.at(*p));
    }
    let normals = smooth_normals(&positions, &triangles);
    let surface = (positions, normals, triangles);
    Ok((surface, Unwrap::Revolved(profile, segments)))
}

fn cup(
    radius: f32,
    height: f32,
    thickness: f32,
    triangles: usize,
) -> Result<(Surface, Unwrap), String> {
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
    Ok(smooth_revolved(profile, segments))
}

/// Lengths whose squares 32-bit numbers hold.
const LENGTHS: std::ops::RangeInclusive<f32> = 1e-16..=MAX_COORDINATE;

fn length(name: &str, x: f32) -> Result<(), String> {
    if LENGTHS.contains(&x) {
        Ok(())
    } else {
        let (least, most) = (LENGTHS.start(), LENGTHS.end());
        Err(format!(
            "{name} {x} must be a positive length, {least:e} to {most:e}"
        ))
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
