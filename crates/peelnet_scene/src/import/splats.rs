//! Files of Gaussian splats: what all of their formats share.

pub(super) mod antimatter;
pub(super) mod ply;
pub(super) mod spz;
#[cfg(test)]
mod tests;
pub(super) mod turned;

use super::surface::{Fault, fault_of, in_file};
use crate::{
    files::Files,
    mesh::Mesh,
    splats::{CONSTANT_HARMONIC, Splats, harmonics_of},
};
use glam::{Quat, Vec3, Vec4};
use peelnet_core::files::counted;
use std::path::Path;

/// The highest degree of harmonics that is drawn.
pub(super) const MAX_DEGREE: u8 = 3;

/// A splat of a file, with its activations (exponentials, sigmoids) applied. Its numbers may be anything.
#[derive(Clone, Copy, Debug)]
pub(super) struct Splat {
    pub center: Vec3,
    pub scale: Vec3,
    /// x, y, z, w, of any length.
    pub rotation: Vec4,
    pub opacity: f32,
}

impl Splat {
    /// The same splat with a rotation of unit length and an opacity of at most 1; `None` if it cannot be drawn.
    fn checked(self) -> Option<(Self, Quat)> {
        let rotation = self.rotation.try_normalize()?;
        // Squares of its scales are elements of its covariance.
        let is_sound = fault_of(self.center).is_none()
            && fault_of(self.scale).is_none()
            && self.scale.min_element() >= 0.0
            && self.opacity.is_finite();
        let opacity = self.opacity.clamp(0.0, 1.0);
        is_sound.then_some((Self { opacity, ..self }, Quat::from_vec4(rotation)))
    }
}

/// Splats as they are read.
pub(super) struct Cloud {
    mesh: Mesh,
    splats: Splats,
    left_out: u64,
}

impl Cloud {
    pub fn new(degree: u8, antialiased: bool) -> Self {
        Self {
            mesh: Mesh::default(),
            splats: Splats {
                degree,
                antialiased,
                ..Splats::default()
            },
            left_out: 0,
        }
    }

    /// Adds a splat with [`harmonics_of`] the degree, or leaves it out if its numbers make no sense.
    pub fn push(&mut self, splat: Splat, harmonics: &[[f32; 3]]) {
        debug_assert_eq!(harmonics.len(), harmonics_of(self.splats.degree));
        let is_finite = harmonics.as_flattened().iter().all(|c| c.is_finite());
        let Some((splat, rotation)) = splat.checked().filter(|_| is_finite) else {
            self.left_out += 1;
            return;
        };
        let i = self.mesh.positions.len() as u32;
        self.mesh.positions.push(splat.center);
        self.mesh.normals.push(Vec3::Z);
        self.mesh.triangles.push([i; 3]);
        self.splats.scales.push(splat.scale);
        self.splats.rotations.push(rotation);
        self.splats.opacities.push(splat.opacity);
        self.splats.harmonics.extend_from_slice(harmonics);
    }

    /// The mesh, without parts.
    pub fn into_mesh(self, path: &Path, files: &mut Files<'_>) -> Result<Mesh, Fault> {
        if self.mesh.positions.is_empty() {
            return Err(in_file(match self.left_out {
                0 => "holds no splats; is the file empty or cut off?".into(),
                n => format!(
                    "holds {}, and numbers of each are not finite or out of range; export it again",
                    counted(n, "splat")
                ),
            }));
        }
        if self.left_out > 0 {
            let count = counted(self.left_out, "splat");
            let why = " left out: numbers that are not finite or out of range";
            files.warn(path, &(count + why));
        }
        Ok(Mesh {
            splats: Some(self.splats),
            ..self.mesh
        })
    }
}

/// The constant harmonic's coefficient of a colour as it is displayed.
pub(super) fn coefficient(color: f32) -> f32 {
    (color - 0.5) / CONSTANT_HARMONIC
}

/// A unit quaternion of three of its elements and 0 in the place of the largest, which is not negative.
fn with_largest(mut elements: [f32; 4], largest: usize) -> [f32; 4] {
    let squares: f32 = elements.iter().map(|x| x * x).sum();
    elements[largest] = (1.0 - squares).max(0.0).sqrt();
    elements
}

/// Three numbers that `number` returns for the axes or channels.
fn three(number: impl Fn(usize) -> f32) -> Vec3 {
    Vec3::new(number(0), number(1), number(2))
}
