use super::{
    checks::is_readable,
    nodes::{Reader, finite},
};
use crate::{
    error::SceneError,
    import::{polygons::strip, surface::fault_of},
    mesh::{Mesh, smooth_normals},
};
use glam::{Mat3, Mat4, Vec2, Vec3};
use gltf::{Semantic, material::AlphaMode, mesh::Mode};
use std::sync::Arc;

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
        let declared = Arc::clone(&self.declared);
        let declared = declared.get(&(mesh.index(), primitive.index()));
        if let Some(declared) = declared.filter(|_| mode == Mode::Points) {
            return self.splats(mesh, primitive, declared, world);
        }
        if !matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            self.missing(&format!("{mode:?} ("), &place, ")");
            return Ok(());
        }
        let (material, placement) = self.material(&primitive.material());
        self.report_unused(primitive, &place);
        let fail = |message: String| self.fail(format!("{place}{message}"));
        check_accessors(primitive).map_err(fail)?;
        let buffers = &self.buffers;
        let reader = primitive.reader(|b| buffers.get(b.index()).map(|bytes| &bytes[..]));
        let positions = reader.read_positions();
        let positions =
            positions.ok_or_else(|| fail(" has no positions; export it again".into()))?;
        let positions: Vec<Vec3> = positions
            .map(|p| world.transform_point3(p.into()))
            .collect();
        let numbered = positions.iter().enumerate();
        let fault = |(i, p): (usize, &Vec3)| fault_of(*p).map(|what| (i, what));
        if let Some((i, what)) = numbered.into_iter().find_map(fault) {
            return Err(fail(format!(": position {i} {what}; repair the mesh")));
        }
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
        // Where the file has none, triangles are flat, as the format says (3.7.2.1); zeros among others are computed.
        let given = reader.read_normals();
        let given = given.filter(|given| given.len() == positions.len());
        let is_flat = given.is_none();
        let given = given.into_iter().flatten();
        let given = given.map(|n| (normal_matrix * Vec3::from(n)).normalize_or_zero());
        let mut normals: Vec<Vec3> = given.collect();
        normals.resize(positions.len(), Vec3::ZERO);
        if !is_flat && normals.contains(&Vec3::ZERO) {
            let smooth = smooth_normals(&positions, &triangles);
            for (normal, smooth) in normals.iter_mut().zip(smooth) {
                if *normal == Vec3::ZERO {
                    *normal = smooth;
                }
            }
        }
        // Opaque materials ignore the opacity of vertices.
        let is_opaque = primitive.material().alpha_mode() == AlphaMode::Opaque;
        let n = positions.len();
        let is_counted = |a: &gltf::Accessor<'_>| a.count() == n;
        let colors = primitive
            .get(&Semantic::Colors(0))
            .filter(is_counted)
            .and_then(|_| reader.read_colors(0));
        let colors = colors.map(|colors| {
            let colors = colors.into_rgba_f32().map(|c| {
                let [r, g, b, a] = c.map(|x| finite(x, 0.0, 1.0));
                [r, g, b, if is_opaque { 1.0 } else { a }]
            });
            colors.collect::<Vec<_>>()
        });
        let uvs = reader.read_tex_coords(placement.set).into_iter();
        let uvs = uvs.flat_map(|uvs| uvs.into_f32());
        let uvs = uvs.map(|uv| placement.transform.transform_point2(uv.into()));
        let or_zero = |uv: Vec2| if uv.is_finite() { uv } else { Vec2::ZERO };
        let uvs: Vec<Vec2> = uvs.map(or_zero).collect();
        let corners = triangles.iter().filter(|_| uvs.len() == n);
        let uvs = corners.map(|t| t.map(|i| uvs[i as usize])).collect();
        let part = Mesh {
            uvs,
            colors: colors.unwrap_or_default(),
            positions,
            normals,
            triangles,
            ..Mesh::default()
        };
        let mut part = part.into_part(mesh.name().unwrap_or(&place), material);
        if is_flat {
            part = part.flat();
        }
        // Of the vertices that many primitives name, each holds its own.
        if 3 * part.triangles.len() < n {
            part.keep_used();
        }
        let warnings = &mut self.files.warnings;
        self.loaded.mesh.append(part, &self.not_drawn, warnings);
        Ok(())
    }

    /// Warns of what a primitive has beside its triangles.
    fn report_unused(&mut self, primitive: &gltf::Primitive<'_>, place: &str) {
        if primitive.morph_targets().len() > 0 {
            self.missing("morph targets", "", "");
        }
        let has_tangents = primitive.get(&Semantic::Tangents).is_some();
        if has_tangents && primitive.material().normal_texture().is_some() {
            self.missing("tangents of its own (those of MikkTSpace are)", "", "");
        }
        let vertices = primitive.get(&Semantic::Positions).map(|a| a.count());
        for (semantic, accessor) in primitive.attributes() {
            if Some(accessor.count()) != vertices {
                let what = "attributes of another count than the positions: ";
                self.missing(what, &semantic.to_string(), "");
            }
        }
        let drawn = primitive.indices().map(|a| a.count()).or(vertices);
        let is_list = primitive.mode() == Mode::Triangles;
        if drawn.is_some_and(|n| n < 3 || is_list && !n.is_multiple_of(3)) {
            self.missing("vertices beyond the last triangle (", place, ")");
        }
    }
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

/// The triangles of a list, strip or fan.
fn triangles(mode: Mode, indices: &[u32], is_mirrored: bool) -> Vec<[u32; 3]> {
    let n = indices.len();
    let corners: Box<dyn Iterator<Item = [usize; 3]>> = match mode {
        Mode::TriangleStrip => Box::new(strip(n)),
        Mode::TriangleFan => Box::new((2..n).map(|i| [0, i - 1, i])),
        _ => Box::new((2..n).step_by(3).map(|i| [i - 2, i - 1, i])),
    };
    let turned = corners.map(|[a, b, c]| if is_mirrored { [a, c, b] } else { [a, b, c] });
    turned.map(|t| t.map(|k| indices[k])).collect()
}
