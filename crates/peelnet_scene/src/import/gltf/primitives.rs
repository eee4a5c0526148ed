//! Triangles of a mesh's primitives.

use super::{
    checks::is_readable,
    nodes::{Reader, finite},
};
use crate::{
    error::SceneError,
    mesh::{Mesh, NO_UVS, Part, smooth_normals},
};
use glam::{Mat3, Mat4, Vec2, Vec3};
use gltf::{material::AlphaMode, mesh::Mode};
use peelnet_files::printable;

/// Positions beyond this overflow when they are squared.
const FARTHEST: f32 = 1e15;

impl Reader<'_, '_> {
    /// Adds a primitive of a mesh in its place in the world.
    pub fn primitive(
        &mut self,
        mesh: &gltf::Mesh<'_>,
        primitive: &gltf::Primitive<'_>,
        world: Mat4,
    ) -> Result<(), SceneError> {
        let place = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
        let mode = primitive.mode();
        if !matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            self.missing.about(format!("{mode:?} ("), &place, ")");
            return Ok(());
        }
        let fail = |message: String| self.fail(format!("{place}{message}"));
        check_accessors(primitive).map_err(fail)?;
        let buffers = &self.buffers;
        let reader = primitive.reader(|b| buffers.get(b.index()).map(Vec::as_slice));
        let positions = reader.read_positions();
        let positions =
            positions.ok_or_else(|| fail(" has no positions; export it again".into()))?;
        let positions: Vec<Vec3> = positions
            .map(|p| world.transform_point3(p.into()))
            .collect();
        check_positions(&positions).map_err(fail)?;
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..positions.len() as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|i| **i as usize >= positions.len()) {
            return Err(fail(format!(
                ": index {index} points at none of its {} vertices; export it again",
                positions.len()
            )));
        }
        // A mirrored node turns its triangles inside out: turn them back.
        let is_mirrored = Mat3::from_mat4(world).determinant() < 0.0;
        let triangles = triangles(mode, &indices, is_mirrored);
        let normal_matrix = Mat3::from_mat4(world).inverse().transpose();
        let given = reader.read_normals();
        let given = given.filter(|given| given.len() == positions.len());
        let normals = given.map(|given| {
            let turned = given.map(|n| normal_matrix * Vec3::from(n));
            turned.map(Vec3::normalize_or_zero).collect()
        });
        let normals = complete(normals, &positions, &triangles);
        // Opaque materials ignore the opacity of vertices.
        let is_opaque = primitive.material().alpha_mode() == AlphaMode::Opaque;
        let n = positions.len();
        let colors = reader.read_colors(0).map(|colors| {
            let colors = colors.into_rgba_f32().map(|c| {
                let [r, g, b, a] = c.map(|x| finite(x, 0.0, 1.0));
                [r, g, b, if is_opaque { 1.0 } else { a }]
            });
            colors.collect::<Vec<_>>()
        });
        if primitive.morph_targets().len() > 0 {
            self.missing.add("morph targets");
        }
        let (material, placement) = self.material(&primitive.material());
        let buffers = &self.buffers;
        let reader = primitive.reader(|b| buffers.get(b.index()).map(Vec::as_slice));
        let uvs: Vec<Vec2> = reader
            .read_tex_coords(placement.set)
            .map_or_else(Vec::new, |uvs| {
                let (turned, moved) = placement.transform;
                let uvs = uvs.into_f32().map(|uv| turned * Vec2::from(uv) + moved);
                uvs.map(|uv| if uv.is_finite() { uv } else { Vec2::ZERO })
                    .collect()
            });
        let corners = triangles.iter().filter(|_| uvs.len() == n);
        let uvs = corners.map(|t| t.map(|i| uvs[i as usize])).collect();
        let part = Part {
            name: mesh.name().unwrap_or(&place).to_owned(),
            triangles: 0..triangles.len(),
            material,
        };
        let name = format!("'{}'", printable(&part.name));
        let lost_maps = self.loaded.mesh.append(Mesh {
            uvs,
            colors: colors.filter(|c| c.len() == n).unwrap_or_default(),
            positions,
            normals,
            triangles,
            parts: vec![part],
        });
        if lost_maps {
            self.missing.about("", &name, NO_UVS);
        }
        Ok(())
    }
}

/// The normals of a file, and computed ones where it has none or zeros.
fn complete(given: Option<Vec<Vec3>>, positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let smooth = || smooth_normals(positions, triangles);
    let mut normals = given.unwrap_or_else(smooth);
    if normals.contains(&Vec3::ZERO) {
        for (normal, smooth) in normals.iter_mut().zip(smooth()) {
            if *normal == Vec3::ZERO {
                *normal = smooth;
            }
        }
    }
    normals
}

/// What is wrong with the first accessor of a primitive that cannot be read.
fn check_accessors(primitive: &gltf::Primitive<'_>) -> Result<(), String> {
    let attributes = primitive.attributes();
    let named = attributes.map(|(semantic, accessor)| (Some(semantic), accessor));
    for (semantic, accessor) in named.chain(primitive.indices().map(|a| (None, a))) {
        if !is_readable(&accessor, semantic.as_ref()) {
            let what = semantic.map_or_else(|| "indices".into(), |s| s.to_string());
            return Err(format!(
                ": accessor {} does not hold what {what} are made of; export it again",
                accessor.index()
            ));
        }
    }
    Ok(())
}

/// What is wrong with the first position that cannot be drawn.
fn check_positions(positions: &[Vec3]) -> Result<(), String> {
    let is_far = |p: &Vec3| p.is_finite() && p.abs().max_element() > FARTHEST;
    let Some(i) = positions.iter().position(|p| !p.is_finite() || is_far(p)) else {
        return Ok(());
    };
    let what = if is_far(&positions[i]) {
        format!("lies farther than {FARTHEST:e} from the origin")
    } else {
        "is not finite".to_owned()
    };
    Err(format!(": position {i} {what}; repair the mesh"))
}

/// The triangles of a list, strip or fan.
fn triangles(mode: Mode, indices: &[u32], is_mirrored: bool) -> Vec<[u32; 3]> {
    let wound = |a: u32, b: u32, c: u32| {
        if is_mirrored { [a, c, b] } else { [a, b, c] }
    };
    match mode {
        // Every second triangle of a strip is wound the other way.
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(i, t)| {
                if i % 2 == 0 {
                    wound(t[0], t[1], t[2])
                } else {
                    wound(t[1], t[0], t[2])
                }
            })
            .collect(),
        Mode::TriangleFan => indices
            .get(1..)
            .unwrap_or_default()
            .windows(2)
            .map(|t| wound(indices[0], t[0], t[1]))
            .collect(),
        _ => indices
            .chunks_exact(3)
            .map(|t| wound(t[0], t[1], t[2]))
            .collect(),
    }
}
