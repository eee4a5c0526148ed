//! Surfaces of OBJ, PLY and STL files, as meshes.

use super::Imported;
use crate::{
    budget::Budget,
    error::{SceneError, shown},
    files::{FileKind, Files},
    material::{Lighting, Material},
    mesh::{Mesh, area_of, key_of, normals_by_position},
    warnings::Warnings,
};
use glam::{Vec2, Vec3};
use peelnet_files::counted;
use std::{collections::HashMap, path::Path};

/// Positions beyond this overflow when they are squared.
const FARTHEST: f32 = 1e15;

/// Reads a file without materials, whose triangles `surface` finds.
pub(super) fn load(
    path: &Path,
    lighting: Lighting,
    files: &mut Files<'_>,
    surface: impl FnOnce(&[u8], &mut Budget, &mut Warnings) -> Result<Mesh, Fault>,
) -> Result<Imported, SceneError> {
    let bytes = files.read(path, FileKind::Mesh)?;
    let mut warnings = Warnings::default();
    let mesh = surface(&bytes, &mut files.budget, &mut warnings).and_then(|mut surface| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let material = surface.material(lighting, &mut warnings);
        let part = (name.into_owned(), material, surface);
        assemble(vec![part], "", &mut warnings).map_err(Fault::new)
    });
    let mesh = mesh.map_err(|Fault { line, message }| SceneError::file(path, line, message))?;
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

/// What is wrong with a position.
pub(super) fn fault_of(position: Vec3) -> Option<String> {
    if !position.is_finite() {
        return Some("is not finite".into());
    }
    let is_far = position.abs().max_element() > FARTHEST;
    is_far.then(|| format!("lies farther than {FARTHEST:e} from the origin"))
}

impl Mesh {
    /// An opaque light grey material, which is white under vertex colours.
    fn material(&mut self, lighting: Lighting, warnings: &mut Warnings) -> Material {
        let mut material = Material::default_with(lighting);
        if self.colors.is_empty() {
            return material;
        }
        material.color = [1.0; 3];
        if self.colors.iter().all(|c| c[3] == 0.0) {
            warnings.add("every vertex has an opacity of 0, which is taken as 1");
            self.colors.iter_mut().for_each(|c| c[3] = 1.0);
        }
        material.blend = self.colors.iter().any(|c| c[3] < 1.0);
        material
    }

    /// Drops triangles without area: exactly zero, as a sliver is a triangle. Returns how many.
    pub(super) fn drop_degenerate(&mut self) -> usize {
        let all = self.triangles.len();
        let has_area = |t: &[u32; 3]| area_of(&self.positions, *t) != Vec3::ZERO;
        if self.triangles.iter().all(has_area) {
            return 0;
        }
        let mut triangles = self.triangles.iter();
        self.uvs.retain(|_| triangles.next().is_some_and(has_area));
        let triangles = std::mem::take(&mut self.triangles);
        self.triangles = triangles.into_iter().filter(has_area).collect();
        all - self.triangles.len()
    }
}

/// The mesh of all parts, of which each may lack anything but positions: without triangles that have no area, and with computed normals where a part has none or zeros. Parts split
/// vertices, but not the surface: computed normals are those of all triangles around a position.
pub(super) fn assemble(
    mut parts: Vec<(String, Material, Mesh)>,
    file: &str,
    warnings: &mut Warnings,
) -> Result<Mesh, String> {
    let [mut lost_triangles, mut lost_normals, mut lost_uvs] = [0; 3];
    for (_, _, surface) in &mut parts {
        lost_triangles += surface.drop_degenerate();
        for normal in &mut surface.normals {
            *normal = normal.try_normalize().unwrap_or_default();
            lost_normals += usize::from(*normal == Vec3::ZERO);
        }
        for uv in surface
            .uvs
            .iter_mut()
            .flatten()
            .filter(|uv| !uv.is_finite())
        {
            *uv = Vec2::ZERO;
            lost_uvs += 1;
        }
    }
    parts.retain(|(_, _, surface)| !surface.triangles.is_empty());
    let is_incomplete = |(_, _, s): &(_, _, Mesh)| s.normals.len() < s.positions.len();
    let mut smooth = HashMap::new();
    if lost_normals > 0 || parts.iter().any(is_incomplete) {
        let surfaces = parts.iter().map(|(_, _, s)| (&*s.positions, &*s.triangles));
        smooth = normals_by_position(surfaces);
    }
    let mut mesh = Mesh::default();
    for (name, material, mut surface) in parts {
        let n = surface.positions.len();
        surface.normals.resize(n, Vec3::ZERO);
        for (normal, position) in surface.normals.iter_mut().zip(&surface.positions) {
            if *normal == Vec3::ZERO {
                *normal = smooth.get(&key_of(*position)).copied().unwrap_or(Vec3::Z);
            }
        }
        mesh.append(surface.into_part(name, material), file, warnings);
    }
    for (count, what, why) in [
        (lost_uvs, "UV", "that is not finite is taken as 0"),
        (lost_triangles, "triangle", "without area left out"),
        (
            lost_normals,
            "normal",
            "without a direction computed from the triangles",
        ),
    ] {
        if count > 0 {
            let count = counted(count as u64, what);
            warnings.add(format!("{file}{count} {why}"));
        }
    }
    if mesh.triangles.is_empty() {
        return Err("holds no triangle with an area; export the mesh again".into());
    }
    Ok(mesh)
}
