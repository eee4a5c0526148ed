//! Gaussian splats that behave like those of a capture: hundreds of faint layers in a pixel.

use super::{MAX_TRIANGLES, SplatCloud, length, waves::Waves};
use crate::{
    error::within,
    mesh::Mesh,
    splats::{CONSTANT_HARMONIC, Splats, harmonics_of},
};
use glam::{Mat3, Quat, Vec3};
use peelnet_core::random::Random;
use std::f32::consts::TAU;

/// Blobs on whose surfaces most splats lie.
const BLOBS: usize = 5;

/// Height of the bumps as a part of a blob's radius.
const BUMPS: f32 = 0.3;

/// Size along the normal as a part of the size along the surface.
const FLATNESS: f32 = 0.15;

/// Standard deviation of the logarithms of sizes.
const SPREAD: f32 = 0.6;

/// Part of the splats that are large, faint and anywhere; and part of these that are far outside.
const FLOATERS: f32 = 0.03;
const FAR: f32 = 0.1;

/// A sphere with bumps.
struct Blob {
    center: Vec3,
    radius: f32,
    waves: Waves,
}

impl Blob {
    /// The place of its surface in a direction from its centre.
    fn place(&self, direction: Vec3) -> Vec3 {
        let height = 1.0 + BUMPS * self.waves.at(direction);
        self.center + direction * (self.radius * height)
    }

    /// The normal there, by differences.
    fn normal(&self, direction: Vec3) -> Vec3 {
        let (right, up) = direction.any_orthonormal_pair();
        let step = |side: Vec3| self.place((direction + side * 1e-2).normalize());
        let along = |side: Vec3| step(side) - step(-side);
        along(right).cross(along(up)).normalize_or(direction)
    }
}

/// A number of a normal distribution (Box and Muller 1958).
fn gaussian(random: &mut Random) -> f32 {
    let radius = (-2.0 * (1.0 - random.unit()).ln()).sqrt();
    radius * (TAU * random.unit()).cos()
}

fn direction(random: &mut Random) -> Vec3 {
    let z = random.between(-1.0, 1.0);
    let (sin, cos) = random.between(0.0, TAU).sin_cos();
    let ring = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(ring * cos, ring * sin, z)
}

impl SplatCloud {
    /// The splats, all within about the radius, but for a few.
    pub(super) fn surface(&self) -> Result<Mesh, String> {
        self.check()?;
        let mut random = Random::new(self.seed, &[0x5b_1a7]);
        let mut blobs = Vec::new();
        for i in 0..BLOBS as u64 {
            let size = random.between(0.3, 0.55);
            blobs.push(Blob {
                center: direction(&mut random) * (self.radius * random.between(0.0, 0.9 - size)),
                radius: self.radius * size,
                waves: Waves::new(self.seed.wrapping_mul(BLOBS as u64).wrapping_add(i)),
            });
        }
        // Colours vary by plane waves, one for each channel.
        let waves = [(); 3].map(|()| {
            let wave = direction(&mut random) * random.between(2.0, 5.0);
            (wave, random.between(0.0, TAU))
        });
        let mut mesh = Mesh::default();
        let mut splats = Splats {
            degree: self.degree,
            ..Splats::default()
        };
        for i in 0..self.count as u32 {
            let log_size = SPREAD * gaussian(&mut random);
            let skewed = random.unit().powf(1.5);
            let size = self.size * log_size.clamp(-2.5, 2.5).exp();
            let spin = random.between(0.0, TAU);
            let towards = direction(&mut random);
            let longer = random.between(0.5, 1.5);
            let (center, normal, scale, opacity) = if random.unit() < FLOATERS {
                let most = if random.unit() < FAR { 6.0 } else { 1.2 };
                let distance = most * random.unit().cbrt();
                let center = towards * (self.radius * distance);
                let scale = Vec3::new(longer, 1.0, 0.5) * (size * 4.0);
                let normal = direction(&mut random);
                (center, normal, scale, 0.05 + 0.1 * skewed)
            } else {
                let blob = &blobs[random.below(BLOBS)];
                let normal = blob.normal(towards);
                // Captures are some sizes thick.
                let depth = size * gaussian(&mut random);
                let center = blob.place(towards) + normal * depth;
                let scale = Vec3::new(longer, 1.0, FLATNESS) * size;
                (center, normal, scale, 0.05 + 0.94 * skewed)
            };
            let turn = Quat::from_axis_angle(normal, spin);
            let right = turn * normal.any_orthonormal_vector();
            let axes = Mat3::from_cols(right, normal.cross(right), normal);
            mesh.positions.push(center);
            mesh.normals.push(Vec3::Z);
            mesh.triangles.push([i; 3]);
            splats.scales.push(scale);
            splats.rotations.push(Quat::from_mat3(&axes).normalize());
            splats.opacities.push((self.opacity * opacity).min(0.99));
            splats.harmonics.push(waves.map(|(wave, phase)| {
                let smooth = 0.5 + 0.4 * (wave.dot(center / self.radius) + phase).sin();
                let color = smooth + 0.06 * gaussian(&mut random);
                (color.clamp(0.02, 0.98) - 0.5) / CONSTANT_HARMONIC
            }));
            for k in 1..harmonics_of(self.degree) {
                let strength = 0.1 / (k as f32).sqrt();
                let harmonic = [(); 3].map(|()| strength * gaussian(&mut random));
                splats.harmonics.push(harmonic);
            }
        }
        mesh.splats = Some(splats);
        Ok(mesh)
    }

    fn check(&self) -> Result<(), String> {
        length("radius", self.radius)?;
        length("size", self.size)?;
        within("opacity", self.opacity, 0.0, 1.0)
            .map_err(|(name, message)| format!("{name} {message}"))?;
        if self.degree > 3 {
            return Err(format!("degree {} must lie in 0 … 3", self.degree));
        }
        if !(1..=MAX_TRIANGLES).contains(&self.count) {
            let count = self.count;
            return Err(format!("count {count} must lie in 1 … {MAX_TRIANGLES}"));
        }
        Ok(())
    }
}
