use crate::Material;
use glam::Vec3;
use std::ops::Range;

/// Triangles with a normal at every corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Corner positions, object space.
    pub positions: Vec<Vec3>,
    /// Unit normals, one for each position.
    pub normals: Vec<Vec3>,
    /// Indices of three corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Runs of triangles that share a material; together they cover all triangles in order.
    pub parts: Vec<Part>,
}

/// A run of triangles of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Name of the group or object in the mesh file.
    pub name: String,
    /// Indices into [`Mesh::triangles`].
    pub triangles: Range<usize>,
    /// The material that the mesh itself asks for.
    pub material: Material,
}

impl Mesh {
    /// A mesh of one part.
    pub(crate) fn single(
        name: &str,
        positions: Vec<Vec3>,
        normals: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        material: &Material,
    ) -> Self {
        Self {
            parts: vec![Part {
                name: name.to_owned(),
                triangles: 0..triangles.len(),
                material: material.clone(),
            }],
            positions,
            normals,
            triangles,
        }
    }

    /// The box around all corners that triangles use; `None` without any.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut corners = self
            .triangles
            .iter()
            .flatten()
            .map(|&i| self.positions[i as usize]);
        let first = corners.next()?;
        Some(corners.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p))))
    }
}

/// Smooth normals: the sum of the adjacent triangles' area vectors, so that large triangles count more. A corner whose
/// triangles have no area gets +z, never NaN.
pub(crate) fn smooth_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; positions.len()];
    for t in triangles {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        let area = (b - a).cross(c - a);
        for &i in t {
            sums[i as usize] += area;
        }
    }
    sums.into_iter().map(|n| n.normalize_or(Vec3::Z)).collect()
}
