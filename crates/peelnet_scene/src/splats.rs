//! Gaussian splats (Kerbl et al. 2023): ellipsoids whose opacity falls off from the middle, and whose colour depends on the direction they are
//! seen from. A mesh of splats has a triangle for each, all of whose vertices are its centre; the vertex shader draws it around the ellipse.

use glam::{Mat3, Mat4, Quat, Vec3};

/// Harmonics of a colour up to a degree: 1, 4, 9, 16.
pub const fn harmonics_of(degree: u8) -> usize {
    (degree as usize + 1) * (degree as usize + 1)
}

/// The constant harmonic: a colour of the files' first coefficient c is 0.5 + c times this.
pub const CONSTANT_HARMONIC: f32 = 0.282_094_8;

/// Fragments of less opacity are not drawn (Kerbl et al. 2023).
pub const FAINTEST: f32 = 1.0 / 255.0;

/// Splats of a mesh, whose [`crate::Mesh::positions`] are their centres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Splats {
    /// Standard deviations along each splat's own axes, object space, not negative.
    pub scales: Vec<Vec3>,
    /// Unit quaternions from a splat's own axes to object space.
    pub rotations: Vec<Quat>,
    /// Opacity in the middle, 0 … 1.
    pub opacities: Vec<f32>,
    /// Degree of the spherical harmonics, 0 … 3.
    pub degree: u8,
    /// [`harmonics_of`] the degree for each splat, in the order of the INRIA files: coefficients of red, green and blue in display space, where
    /// the colour is 0.5 and the sum of coefficients times harmonics of the direction from the eye to the centre, in object space.
    pub harmonics: Vec<[f32; 3]>,
    /// Whether opacity makes up for the blur that widens splats smaller than a pixel (Yu et al. 2024), as the network that made them did.
    pub antialiased: bool,
}

impl Splats {
    /// A splat's covariance in the world: xx, xy, xz, yy, yz, zz.
    pub fn covariance(&self, splat: usize, world_from_object: &Mat4) -> [f32; 6] {
        let axes = Mat3::from_mat4(*world_from_object)
            * Mat3::from_quat(self.rotations[splat])
            * Mat3::from_diagonal(self.scales[splat]);
        let c = axes * axes.transpose();
        [
            c.x_axis.x, c.y_axis.x, c.z_axis.x, c.y_axis.y, c.z_axis.y, c.z_axis.z,
        ]
    }

    /// Appends splats. Harmonics that either lack are 0.
    pub(crate) fn append(&mut self, mut other: Self) {
        let degree = self.degree.max(other.degree);
        self.raise(degree);
        other.raise(degree);
        self.scales.extend(other.scales);
        self.rotations.extend(other.rotations);
        self.opacities.extend(other.opacities);
        self.harmonics.extend(other.harmonics);
        self.antialiased |= other.antialiased;
    }

    /// The same splats with harmonics of a higher degree, which are 0.
    fn raise(&mut self, degree: u8) {
        let [before, after] = [self.degree, degree].map(harmonics_of);
        if before < after {
            let zeros = vec![[0.0; 3]; after - before];
            let all = self.harmonics.chunks_exact(before);
            self.harmonics = all.flat_map(|own| [own, &zeros].concat()).collect();
            self.degree = degree;
        }
    }

    /// Keeps the splats of these numbers, in this order.
    pub(crate) fn keep(&mut self, numbers: &[usize]) {
        let each = harmonics_of(self.degree);
        let harmonics = numbers
            .iter()
            .flat_map(|&i| &self.harmonics[i * each..(i + 1) * each]);
        self.harmonics = harmonics.copied().collect();
        self.scales = numbers.iter().map(|&i| self.scales[i]).collect();
        self.rotations = numbers.iter().map(|&i| self.rotations[i]).collect();
        self.opacities = numbers.iter().map(|&i| self.opacities[i]).collect();
    }

    /// How far from its centre a splat reaches at most, object space: where its opacity falls below [`FAINTEST`].
    pub fn reach(&self, splat: usize) -> f32 {
        let ratio = self.opacities[splat] / FAINTEST;
        self.scales[splat].max_element() * (2.0 * ratio.max(1.0).ln()).sqrt()
    }
}
