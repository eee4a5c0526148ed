//! `[scatter]`: many objects at random places. Everything is drawn from the seed in a fixed order, so that a file always gives the same scene.

use crate::{
    error::{Fault, check_color, require, within},
    file::raw::{MapRef, MeshRef},
    material::Lighting,
};
use glam::{Mat4, Quat, Vec3};
use peelnet_core::random::Random;
use serde::Deserialize;

/// The table in the scene file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Scatter {
    pub count: usize,
    #[serde(default)]
    pub seed: u64,
    /// The mesh of every object,
    pub mesh: Option<MeshRef>,
    /// or several, taken in turn.
    pub meshes: Option<Vec<MeshRef>>,
    /// The box in which the objects' origins lie.
    pub min: [f32; 3],
    pub max: [f32; 3],
    /// Cells along each axis, taken in turn.
    pub grid: Option<[usize; 3]>,
    /// Part of its cell in which an object may lie, around the cell's centre.
    #[serde(default)]
    pub jitter: f32,
    #[serde(default = "one")]
    pub scale: NumberOrRange,
    #[serde(default)]
    pub rotate: Rotate,
    pub color: Option<ColorChoice>,
    pub alpha: Option<NumberOrRange>,
    /// The last four as in a material and an object.
    pub lighting: Option<Lighting>,
    pub color_map: Option<MapRef>,
    pub layer: Option<u32>,
}

/// Most objects of a scatter, so that a small file cannot ask for endless memory.
const MAX_COUNT: usize = 1_000_000;

/// Most cells along an axis: the cells of two axes can be counted in 32 bits.
const MAX_CELLS: usize = 65_535;

const fn one() -> NumberOrRange {
    NumberOrRange::Number(1.0)
}

/// A number, or a range to draw from.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged, expecting = "expected a number or [low, high]")]
pub(crate) enum NumberOrRange {
    Number(f32),
    Range([f32; 2]),
}

impl NumberOrRange {
    fn draw(self, random: &mut Random) -> f32 {
        match self {
            Self::Number(x) => x,
            Self::Range([low, high]) => random.between(low, high),
        }
    }

    fn ends(self) -> [f32; 2] {
        match self {
            Self::Number(x) => [x, x],
            Self::Range(r) => r,
        }
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(
    rename_all = "kebab-case",
    expecting = "expected \"random\", \"camera\" or [x, y, z] degrees"
)]
pub(crate) enum Rotate {
    /// Every orientation alike.
    Random,
    /// +z towards the eye of the first view, as billboards do.
    Camera,
    /// About the fixed axes x, y, z in this order, degrees.
    #[serde(untagged)]
    Degrees([f32; 3]),
}

impl Default for Rotate {
    fn default() -> Self {
        Self::Degrees([0.0; 3])
    }
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(
    rename_all = "kebab-case",
    expecting = "expected \"random\" or [r, g, b]"
)]
pub(crate) enum ColorChoice {
    /// Every component evenly from 0 to 1.
    Random,
    #[serde(untagged)]
    Color([f32; 3]),
}

/// One object of a scatter.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Placed {
    pub mesh: usize,
    pub world_from_object: Mat4,
    pub color: Option<[f32; 3]>,
    pub alpha: Option<f32>,
}

impl Scatter {
    /// Checks the values; an error holds the field and what is wrong.
    pub fn check(&self) -> Result<(), Fault> {
        let finite = |v: &[f32]| v.iter().all(|x| x.is_finite());
        let is_either = self.mesh.is_some() != self.meshes.is_some();
        require(is_either, "mesh", "give either mesh or meshes")?;
        let has_any = !self.mesh_list().is_empty();
        let message = "the list is empty; name at least one mesh";
        require(has_any, "meshes", message)?;
        let is_box = (0..3).all(|k| self.min[k] <= self.max[k]);
        let is_box = is_box && finite(&self.min) && finite(&self.max);
        require(is_box, "min", "must be finite and nowhere above max")?;
        require(self.count <= MAX_COUNT, "count", "must be at most 1000000")?;
        let mut cells = self.grid.into_iter().flatten();
        let is_grid = cells.all(|n| (1..=MAX_CELLS).contains(&n));
        require(is_grid, "grid", "needs 1 … 65535 cells along each axis")?;
        if let Rotate::Degrees(degrees) = &self.rotate {
            require(finite(degrees), "rotate", "must be finite")?;
        }
        let [low, high] = self.scale.ends();
        let is_scale = low > 0.0 && low <= high && high.is_finite();
        require(is_scale, "scale", "must be positive, the lower end first")?;
        let [low, high] = self.alpha.map_or([0.0; 2], NumberOrRange::ends);
        let is_alpha = 0.0 <= low && low <= high && high <= 1.0;
        require(is_alpha, "alpha", "must lie in 0 … 1, the lower end first")?;
        within("jitter", self.jitter, 0.0, 1.0)?;
        match self.color {
            Some(ColorChoice::Color(color)) => check_color(color),
            _ => Ok(()),
        }
    }

    /// The meshes that are taken in turn.
    pub fn mesh_list(&self) -> &[MeshRef] {
        match (&self.meshes, &self.mesh) {
            (Some(list), _) => list,
            (None, Some(one)) => std::slice::from_ref(one),
            (None, None) => &[],
        }
    }

    /// Draws the objects. `eye` is the first view's position.
    pub fn place(&self, eye: Vec3) -> Vec<Placed> {
        let mut random = Random::new(self.seed, &[0x5ca7]);
        let (min, max) = (Vec3::from_array(self.min), Vec3::from_array(self.max));
        let meshes = self.mesh_list().len().max(1);
        let range = self.alpha.map(NumberOrRange::ends);
        (0..self.count)
            .map(|i| {
                let free = Vec3::new(random.unit(), random.unit(), random.unit());
                let place = self.grid.map_or(free, |[nx, ny, nz]| {
                    let cell = [i % nx, i / nx % ny, i / (nx * ny) % nz];
                    let cell = Vec3::from(cell.map(|n| n as f32));
                    let cells = Vec3::new(nx as f32, ny as f32, nz as f32);
                    (cell + Vec3::splat(0.5) + (free - 0.5) * self.jitter) / cells
                });
                let position = min + place * (max - min);
                let scale = Vec3::splat(self.scale.draw(&mut random));
                // Drawn whether it is used or not, so that the rest of the scene does not depend on `rotate`.
                let turn = random_rotation(&mut random);
                let rotation = match &self.rotate {
                    Rotate::Random => turn,
                    Rotate::Camera => {
                        Quat::from_rotation_arc(Vec3::Z, (eye - position).normalize_or(Vec3::Z))
                    }
                    Rotate::Degrees(d) => fixed_axes(*d),
                };
                let world_from_object =
                    Mat4::from_scale_rotation_translation(scale, rotation, position);
                let color = random.color();
                let alpha = random.unit();
                Placed {
                    mesh: i % meshes,
                    world_from_object,
                    color: self.color.map(|c| match c {
                        ColorChoice::Random => color,
                        ColorChoice::Color(c) => c,
                    }),
                    alpha: range.map(|[low, high]| low + alpha * (high - low)),
                }
            })
            .collect()
    }
}

/// Rotation about the fixed axes x, y, z in this order.
pub(crate) fn fixed_axes(degrees: [f32; 3]) -> Quat {
    let [x, y, z] = degrees.map(f32::to_radians);
    Quat::from_rotation_z(z) * Quat::from_rotation_y(y) * Quat::from_rotation_x(x)
}

/// The degrees that [`fixed_axes`] makes a rotation of.
pub(crate) fn from_fixed_axes(rotation: Quat) -> [f32; 3] {
    let (z, y, x) = rotation.to_euler(glam::EulerRot::ZYX);
    [x, y, z].map(f32::to_degrees)
}

/// Every orientation alike (Shoemake, "Uniform Random Rotations", Graphics Gems III, 1992).
fn random_rotation(random: &mut Random) -> Quat {
    let (u, v, w) = (random.unit(), random.unit(), random.unit());
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    let (v, w) = (v * std::f32::consts::TAU, w * std::f32::consts::TAU);
    Quat::from_xyzw(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scatter(text: &str) -> Scatter {
        toml::from_str(text).expect("parses")
    }

    #[test]
    fn a_grid_fills_its_cells_and_a_seed_repeats() {
        let text = "count = 8\nmesh = { shape = 'box' }\nmin = [0, 0, 0]\nmax = [2, 2, 2]\ngrid = [2, 2, 2]\njitter = 0.5\nalpha = [0.2, 0.4]\ncolor = 'random'";
        let s = scatter(text);
        s.check().expect("fine");
        let placed = s.place(Vec3::ZERO);
        assert_eq!(placed, scatter(text).place(Vec3::ZERO));
        let cell = |p: &Placed| p.world_from_object.w_axis.truncate().floor().as_ivec3();
        let cells: std::collections::HashSet<_> = placed.iter().map(cell).collect();
        assert_eq!(cells.len(), 8);
        let mut alphas = placed.iter().map(|p| p.alpha.expect("drawn"));
        assert!(alphas.all(|alpha| (0.2..=0.4).contains(&alpha)));
    }

    #[test]
    fn billboards_face_the_eye() {
        let s = scatter(
            "count = 5\nmesh = { shape = 'quad' }\nmin = [-1, -1, -9]\nmax = [1, 1, -2]\nrotate = 'camera'",
        );
        let eye = Vec3::new(0.0, 0.5, 3.0);
        for p in s.place(eye) {
            let m = p.world_from_object;
            let toward = (eye - m.w_axis.truncate()).normalize();
            assert!(m.transform_vector3(Vec3::Z).dot(toward) > 0.9999);
        }
    }
}
