//! Generated meshes. Closed ones are watertight, face outwards, and share their vertices; quads, strands and terrain are open, and splats have no
//! surface.

mod revolution;
mod splats;
mod strands;
#[cfg(test)]
pub(crate) mod tests;
mod waves;

use crate::{
    budget::MAX_COORDINATE,
    material::Material,
    mesh::{Mesh, smooth_normals},
    parameters::parameters,
};
use glam::{Vec2, Vec3};
use serde::Deserialize;
use std::f32::consts::TAU;

const MAX_TRIANGLES: usize = 20_000_000;

/// Declares the shapes with their parameters and defaults: a struct for each, which builds a [`Mesh`], and [`Shape`], which is any of them.
macro_rules! shapes {
    ($($(#[$doc:meta])* $kind:ident $name:literal { $($field:ident: $type:ty = $default:expr),* $(,)? })*) => {
        /// A generated shape: `mesh = { shape = "torus", radius = 1.0 }`. Lengths are scene units, all shapes are centred on the
        /// origin, `triangles` is approximate (the nearest count that the shape's grid can have).
        #[derive(Clone, Debug, PartialEq, Deserialize)]
        #[serde(tag = "shape")]
        pub(crate) enum Shape {
            $(#[serde(rename = $name)] $kind($kind),)*
        }

        $(parameters! {
            $(#[$doc])*
            #[derive(Clone, Debug, PartialEq)]
            pub(crate) struct $kind { $($field: $type = $default),* }
        })*

        impl Shape {
            /// Its name in a scene file, and its surface: normals are to be computed where there are none, UVs are u once around, v from the top down
            /// along the profile.
            fn surface(&self) -> (&'static str, Result<Mesh, String>) {
                match self {
                    $(Self::$kind(shape) => ($name, shape.surface()),)*
                }
            }
        }
    };
}

shapes! {
    Sphere "sphere" { radius: f32 = 1.0, triangles: usize = 2000 }
    /// A torus about the y axis: `radius` is the distance of the tube's centre from it.
    Torus "torus" { radius: f32 = 1.0, tube: f32 = 0.35, triangles: usize = 2000 }
    /// A box of twelve triangles.
    Cuboid "box" { size: [f32; 3] = [2.0; 3] }
    /// A rectangle in the xy plane, facing +z, two triangles.
    Quad "quad" { size: [f32; 2] = [2.0; 2] }
    /// A cylinder with half-sphere caps, along y; `height` is the distance between the caps.
    Capsule "capsule" { radius: f32 = 0.5, height: f32 = 1.0, triangles: usize = 2000 }
    /// A closed bumpy surface around the origin: a sphere with waves on it, whose height is a part of the radius.
    Bumpy "bumpy" { radius: f32 = 1.0, amplitude: f32 = 0.25, seed: u64 = 0, triangles: usize = 2000 }
    /// An open vessel with a wall of some thickness, along y: four surfaces seen through its middle.
    Cup "cup" { radius: f32 = 1.0, height: f32 = 2.0, thickness: f32 = 0.1, triangles: usize = 2000 }
    /// A surface of revolution about y whose profile is a smooth curve through points (radius, y): from the axis below along the outside
    /// to the axis again. The layers of a nested object are lathes of one profile, each at another distance `offset` outside of it.
    Lathe "lathe" { profile: Vec<[f32; 2]> = Vec::new(), offset: f32 = 0.0, triangles: usize = 2000 }
    /// Hair: thin ribbons that grow out of the upper part of a sphere around the origin and hang down around it. `segments` are rectangles
    /// of a strand, `length` is that of the longest, `width` that at the root. A `droop` of 0 grows straight outwards, a `curl` of 0 is
    /// straight hair, `roots` is the height of the lowest ones as a part of the radius.
    Strands "strands" {
        radius: f32 = 1.0, count: usize = 1000, segments: usize = 8, length: f32 = 1.0, width: f32 = 0.01, droop: f32 = 1.0,
        curl: f32 = 0.0, roots: f32 = 0.0, seed: u64 = 0,
    }
    /// Gaussian splats as captures have them: on the surfaces of a few bumpy blobs within `radius`, and some large faint ones anywhere. `size` is the
    /// median standard deviation along the surface, `opacity` multiplies that of each, and `degree` is that of the harmonics of its colour, 0 to 3.
    SplatCloud "splats" { count: usize = 2000, radius: f32 = 1.0, seed: u64 = 0, degree: u8 = 0, size: f32 = 0.02, opacity: f32 = 1.0 }
    /// Land over the xz plane: ridges and valleys, open below. `height` is that of the highest place over the lowest.
    Terrain "terrain" { size: [f32; 2] = [2.0; 2], height: f32 = 0.5, seed: u64 = 0, triangles: usize = 2000 }
}

impl Mesh {
    /// Appends the two triangles of a rectangle whose vertices are `a`, `b` and, above them, `c`, `d`.
    fn push_rectangle(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangles.extend([[a, b, d], [a, d, c]]);
    }

    /// Appends the rectangles of a grid, whose vertices have these numbers.
    fn push_grid(&mut self, [rows, columns]: [usize; 2], at: impl Fn(usize, usize) -> u32) {
        for i in 0..rows {
            for j in 0..columns {
                self.push_rectangle([at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
            }
        }
    }

    /// Sets UVs that belong to vertices.
    fn unwrap(&mut self, uv: impl Fn(usize) -> Vec2) {
        let triangles = self.triangles.iter();
        self.uvs = triangles.map(|t| t.map(|i| uv(i as usize))).collect();
    }
}

impl Shape {
    /// About how many triangles it has.
    pub const fn triangles(&self) -> usize {
        match self {
            Self::Cuboid(_) => 12,
            Self::Quad(_) => 2,
            Self::SplatCloud(shape) => shape.count,
            Self::Strands(shape) => shape.triangles(),
            Self::Sphere(Sphere { triangles, .. })
            | Self::Torus(Torus { triangles, .. })
            | Self::Capsule(Capsule { triangles, .. })
            | Self::Bumpy(Bumpy { triangles, .. })
            | Self::Cup(Cup { triangles, .. })
            | Self::Lathe(Lathe { triangles, .. })
            | Self::Terrain(Terrain { triangles, .. }) => *triangles,
        }
    }

    /// Makes the mesh, with UVs where `has_uvs` asks for them. An error names the parameter out of range and its bounds.
    pub fn build(&self, material: &Material, has_uvs: bool) -> Result<Mesh, String> {
        let (name, surface) = self.surface();
        let mut surface = surface?;
        if surface.normals.is_empty() {
            surface.normals = smooth_normals(&surface.positions, &surface.triangles);
        }
        if !has_uvs {
            surface.uvs.clear();
        }
        // Their colours and opacities are their own.
        let material = match surface.splats {
            Some(_) => Material::unlit([1.0; 3], 1.0),
            None => material.clone(),
        };
        Ok(surface.into_part(name, material))
    }
}

impl Torus {
    fn surface(&self) -> Result<Mesh, String> {
        let &Self { radius, tube, .. } = self;
        length("tube", tube)?;
        length("radius", radius)?;
        if tube >= radius {
            return Err(format!("tube {tube} must be smaller than radius {radius}"));
        }
        let triangles = count(self.triangles)? as f32;
        let around = ((triangles / 2.0 * (tube / radius)).sqrt().round() as usize).max(3);
        let along = ((triangles / (2.0 * around as f32)).round() as usize).max(3);
        let mut surface = Mesh::default();
        for i in 0..along {
            let a = TAU * i as f32 / along as f32;
            let out = Vec3::new(a.cos(), 0.0, -a.sin());
            for j in 0..around {
                let b = TAU * j as f32 / around as f32;
                let n = out * b.cos() + Vec3::Y * b.sin();
                surface.positions.push(out * radius + n * tube);
                surface.normals.push(n);
            }
        }
        let at = |i: usize, j: usize| ((i % along) * around + j % around) as u32;
        surface.push_grid([along, around], at);
        surface.unwrap(|i| {
            let (i, j) = (i / around, i % around);
            Vec2::new(i as f32 / along as f32, 1.0 - j as f32 / around as f32)
        });
        surface.uvs.iter_mut().for_each(unseam);
        Ok(surface)
    }
}

/// A triangle over the seam, where u or v jumps from 1 to 0, continues beyond 1.
fn unseam(uvs: &mut [Vec2; 3]) {
    for axis in 0..2 {
        let most = uvs.iter().map(|c| c[axis]).fold(0.0, f32::max);
        for c in &mut *uvs {
            if most - c[axis] > 0.5 {
                c[axis] += 1.0;
            }
        }
    }
}

/// UVs of a rectangle's four vertices, counter-clockwise from the lower left.
const RECTANGLE: [Vec2; 4] = [Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO];

impl Cuboid {
    /// Four vertices a side.
    fn surface(&self) -> Result<Mesh, String> {
        self.size.iter().try_for_each(|s| length("size", *s))?;
        let half = Vec3::from_array(self.size) / 2.0;
        let mut surface = Mesh::default();
        for (axis, sign) in [0, 0, 1, 1, 2, 2].into_iter().zip([1.0, -1.0].repeat(3)) {
            let unit = |k: usize| Vec3::AXES[k % 3];
            let n = unit(axis) * sign;
            let (u, v) = (unit(axis + 1) * sign, unit(axis + 2));
            let base = surface.positions.len() as u32;
            for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                surface.positions.push((n + u * a + v * b) * half);
                surface.normals.push(n);
            }
            surface.push_rectangle([base, base + 1, base + 3, base + 2]);
        }
        surface.unwrap(|i| RECTANGLE[i % 4]);
        Ok(surface)
    }
}

impl Quad {
    fn surface(&self) -> Result<Mesh, String> {
        self.size.iter().try_for_each(|s| length("size", *s))?;
        let [x, y] = self.size.map(|s| s / 2.0);
        let corners = [(-x, -y), (x, -y), (x, y), (-x, y)];
        let mut surface = Mesh {
            positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            normals: vec![Vec3::Z; 4],
            ..Mesh::default()
        };
        surface.push_rectangle([0, 1, 3, 2]);
        surface.unwrap(|i| RECTANGLE[i]);
        Ok(surface)
    }
}

/// Lengths whose squares 32-bit numbers hold.
const LENGTHS: std::ops::RangeInclusive<f32> = 1e-16..=MAX_COORDINATE;

fn length(name: &str, x: f32) -> Result<(), String> {
    if LENGTHS.contains(&x) {
        return Ok(());
    }
    let (least, most) = (LENGTHS.start(), LENGTHS.end());
    Err(format!(
        "{name} {x} must be a positive length, {least:e} to {most:e}"
    ))
}

fn count(triangles: usize) -> Result<usize, String> {
    if (8..=MAX_TRIANGLES).contains(&triangles) {
        return Ok(triangles);
    }
    Err(format!(
        "triangles {triangles} must lie in 8 … {MAX_TRIANGLES}"
    ))
}
