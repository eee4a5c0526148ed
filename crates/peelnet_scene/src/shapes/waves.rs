//! Waves, and land that is made of them.

use super::{Terrain, count, length};
use crate::mesh::Mesh;
use glam::{Vec2, Vec3};
use peelnet_core::random::Random;
use std::f32::consts::TAU;

/// A few plane waves through the unit sphere, together between −1 and 1.
pub(super) struct Waves([(Vec3, f32); 5]);

impl Waves {
    pub fn new(seed: u64) -> Self {
        let mut random = Random::new(seed, &[0x0b_00b5]);
        Self([(); 5].map(|()| {
            let [x, y, z] = [(); 3].map(|()| random.between(-1.0, 1.0));
            let frequency = random.between(2.0, 7.0);
            let direction = Vec3::new(x, y, z).normalize_or(Vec3::X);
            (direction * frequency, random.between(0.0, TAU))
        }))
    }

    /// The sum at a point of the unit sphere.
    pub fn at(&self, p: Vec3) -> f32 {
        let waves = self.0.iter().map(|(k, phase)| (k.dot(p) + phase).sin());
        waves.sum::<f32>() / 5.0
    }
}

/// Octaves of ridges, each twice as fine as the one before and so much lower.
const OCTAVES: u64 = 5;
const FALL: f32 = 0.45;

impl Terrain {
    /// A grid of squares with ridged noise as its height (after Musgrave, in Ebert et al., "Texturing and Modeling", 1994), facing up.
    pub(super) fn surface(&self) -> Result<Mesh, String> {
        let size = self.size;
        size.iter().try_for_each(|s| length("size", *s))?;
        length("height", self.height)?;
        // Squares whose number comes nearest to half of the triangles.
        let squares = count(self.triangles)? as f32 / 2.0;
        let nx = (squares * size[0] / size[1]).sqrt().round() as usize;
        let nx = nx.clamp(1, self.triangles / 2);
        let nz = ((squares / nx as f32).round() as usize).max(1);
        let waves = (0..OCTAVES).map(|k| Waves::new(self.seed.wrapping_add(k)));
        let waves: Vec<Waves> = waves.collect();
        let across = |z: usize| (0..=nx).map(move |x| [x as f32 / nx as f32, z as f32 / nz as f32]);
        let uvs: Vec<Vec2> = (0..=nz).flat_map(across).map(Vec2::from).collect();
        let heights: Vec<f32> = uvs.iter().map(|&uv| ridges(&waves, uv)).collect();
        let low = heights.iter().copied().fold(f32::INFINITY, f32::min);
        let high = heights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let positions = uvs.iter().zip(&heights).map(|(uv, h)| {
            let y = (h - low) / (high - low).max(f32::MIN_POSITIVE) - 0.5;
            let [x, z] = [uv.x - 0.5, uv.y - 0.5];
            Vec3::new(x * size[0], y * self.height, z * size[1])
        });
        let mut surface = Mesh {
            positions: positions.collect(),
            ..Mesh::default()
        };
        surface.push_grid([nz, nx], |z, x| (z * (nx + 1) + x) as u32);
        surface.unwrap(|i| uvs[i]);
        Ok(surface)
    }
}

fn ridges(octaves: &[Waves], uv: Vec2) -> f32 {
    let (mut sum, mut weight, mut scale) = (0.0, 1.0, 1.0);
    for waves in octaves {
        let p = Vec3::new(uv.x * 2.0 - 1.0, 0.0, uv.y * 2.0 - 1.0) * scale;
        let ridge = 1.0 - waves.at(p).abs();
        sum += weight * ridge * ridge;
        weight *= FALL;
        scale *= 2.0;
    }
    sum
}
