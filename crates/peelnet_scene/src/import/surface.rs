//! Surfaces of PLY and STL files, as meshes.

use super::Imported;
use crate::{
    budget::Budget,
    error::{SceneError, shown},
    files::{FileKind, Files},
    material::{Lighting, Material},
    mesh::{Mesh, Part, smooth_normals_by_position},
    warnings::Warnings,
};
use glam::{Vec2, Vec3};
use peelnet_files::counted;
use std::path::Path;

/// Positions beyond this overflow when they are squared.
const FARTHEST: f32 = 1e15;

/// Reads a file, whose triangles `surface` finds.
pub(super) fn load(
    path: &Path,
    lighting: Lighting,
    files: &mut Files<'_>,
    surface: impl FnOnce(&[u8], &mut Budget, &mut Warnings) -> Result<Surface, Fault>,
) -> Result<Imported, SceneError> {
    let bytes = files.read(path, FileKind::Mesh)?;
    files.record(path, &bytes);
    let mut warnings = Warnings::default();
    let mesh = surface(&bytes, &mut files.budget, &mut warnings).and_then(|surface| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        surface.into_mesh(&name, lighting, &mut warnings)
    });
    let mesh = mesh.map_err(|Fault { line, message }| SceneError::Mesh {
        path: path.to_owned(),
        line,
        message,
    })?;
    let texts = warnings.texts().into_iter();
    let texts = texts.map(|text| format!("{}: {text}", shown(path)));
    Ok(Imported::mesh(mesh, texts.collect()))
}

/// What is wrong in a file, and where.
#[derive(Debug, PartialEq)]
pub(super) struct Fault {
    /// The line, from 1, in a file that has lines.
    pub line: Option<usize>,
    pub message: String,
}

impl Fault {
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            line: None,
            message: message.into(),
        }
    }

    pub fn at(line: usize, message: impl Into<String>) -> Self {
        Self {
            line: Some(line),
            message: message.into(),
        }
    }
}

/// The triangles of a file, before they are checked.
#[derive(Default)]
pub(super) struct Surface {
    pub positions: Vec<Vec3>,
    /// One for each position.
    pub normals: Option<Vec<Vec3>>,
    /// One for each position: linear RGB and alpha.
    pub colors: Option<Vec<[f32; 4]>>,
    /// One for each vertex of each triangle.
    pub uvs: Option<Vec<[Vec2; 3]>>,
    pub triangles: Vec<[u32; 3]>,
}

/// What is wrong with a position.
pub(super) fn fault_of(position: Vec3) -> Option<String> {
    if !position.is_finite() {
        return Some("is not finite".into());
    }
    let is_far = position.abs().max_element() > FARTHEST;
    is_far.then(|| format!("lies farther than {FARTHEST:e} from the origin"))
}

impl Surface {
    /// A mesh of one part: without triangles that have no area, with normals where the file has none, and with an opaque light grey
    /// material, which is white under vertex colours.
    pub fn into_mesh(
        mut self,
        name: &str,
        lighting: Lighting,
        warnings: &mut Warnings,
    ) -> Result<Mesh, Fault> {
        self.drop_degenerate(warnings);
        if self.triangles.is_empty() {
            let message = "holds no triangle with an area; export the mesh again";
            return Err(Fault::new(message));
        }
        let normals = self.normals(warnings);
        let mut material = Material::default_with(lighting);
        if let Some(colors) = &mut self.colors {
            material.color = [1.0; 3];
            if colors.iter().all(|c| c[3] == 0.0) {
                warnings.add("every vertex has an opacity of 0, which is taken as 1");
                for color in colors.iter_mut() {
                    color[3] = 1.0;
                }
            }
            material.blend = colors.iter().any(|c| c[3] < 1.0);
        }
        let uvs = self.uvs.map(|mut uvs| {
            for uv in uvs.iter_mut().flatten().filter(|uv| !uv.is_finite()) {
                *uv = Vec2::ZERO;
            }
            uvs
        });
        Ok(Mesh {
            positions: self.positions,
            normals,
            colors: self.colors.unwrap_or_default(),
            uvs: uvs.unwrap_or_default(),
            parts: vec![Part {
                name: name.to_owned(),
                triangles: 0..self.triangles.len(),
                material,
            }],
            triangles: self.triangles,
        })
    }

    /// Drops triangles without area: exactly zero, as a sliver is a triangle.
    pub fn drop_degenerate(&mut self, warnings: &mut Warnings) {
        let all = self.triangles.len();
        let has_area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| self.positions[i as usize]);
            (b - a).cross(c - a) != Vec3::ZERO
        };
        if self.triangles.iter().all(has_area) {
            return;
        }
        if let Some(uvs) = &mut self.uvs {
            let mut triangles = self.triangles.iter();
            uvs.retain(|_| triangles.next().is_some_and(has_area));
        }
        let triangles = std::mem::take(&mut self.triangles);
        self.triangles = triangles.into_iter().filter(has_area).collect();
        let lost = (all - self.triangles.len()) as u64;
        warnings.add(format!(
            "{} without area left out",
            counted(lost, "triangle")
        ));
    }

    /// The file's normals, and computed ones where it has none or zeros.
    fn normals(&mut self, warnings: &mut Warnings) -> Vec<Vec3> {
        let smooth = || smooth_normals_by_position(&self.positions, &self.triangles);
        let Some(mut normals) = self.normals.take() else {
            return smooth();
        };
        let mut lost = 0;
        for normal in &mut normals {
            *normal = normal.try_normalize().unwrap_or_default();
            lost += u64::from(*normal == Vec3::ZERO);
        }
        if lost > 0 {
            for (normal, smooth) in normals.iter_mut().zip(smooth()) {
                if *normal == Vec3::ZERO {
                    *normal = smooth;
                }
            }
            warnings.add(format!(
                "{} without a direction computed from the triangles",
                counted(lost, "normal")
            ));
        }
        normals
    }
}
