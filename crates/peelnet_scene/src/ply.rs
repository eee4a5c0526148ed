//! PLY files (Turk 1994), ASCII and binary of either byte order: meshes of scanners.
//!
//! `ply-rs-bw` reads the header and every element. Around it: counts are compared with the length of the file before it is asked for
//! anything (`head`), elements are read one by one, so that an error names the element and nothing is held twice (`elements`), and numbers
//! that its grammar refuses, such as `.5` and `1.`, are written in another way.

mod elements;
mod head;
#[cfg(test)]
mod tests;

use crate::{
    budget::Budget,
    error::SceneError,
    files::Files,
    material::Lighting,
    polygons::Triangulator,
    scan::{self, Fault, Surface, fault_of},
    warnings::Warnings,
};
use elements::{Face, Payload, Skipped, Vertex};
use glam::{DVec3, Vec2, Vec3};
use head::Head;
use peelnet_files::{counted, printable};
use ply_rs_bw::{parser::Parser, ply::ElementDef};
use std::{io, path::Path};

pub use crate::scan::LoadedScan;

/// Reads a PLY file: positions, normals, colours with opacity, texture coordinates (of vertices or of the vertices of faces), polygons and
/// triangle strips.
///
/// Colours in bytes are sRGB, as programs show them, colours in floating-point numbers linear. Missing normals are computed.
///
/// # Errors
/// A file that cannot be read, is cut off, holds numbers or indices that make no sense, or has no faces: with its line or element.
pub fn load_ply(path: &Path, lighting: Lighting) -> Result<LoadedScan, SceneError> {
    load(path, lighting, &mut Files::new(&peelnet_files::read))
}

/// The same with a function that reads files: from an archive, or from memory.
///
/// # Errors
/// See [`load_ply`].
pub fn load_ply_from(
    path: &Path,
    lighting: Lighting,
    read: impl Fn(&Path) -> io::Result<Vec<u8>>,
) -> Result<LoadedScan, SceneError> {
    load(path, lighting, &mut Files::new(&|path, _| read(path)))
}

/// Reads a PLY file.
pub(crate) fn load(
    path: &Path,
    lighting: Lighting,
    files: &mut Files<'_>,
) -> Result<LoadedScan, SceneError> {
    scan::load(path, lighting, files, surface)
}

/// The triangles of a file.
fn surface(bytes: &[u8], budget: &mut Budget, warnings: &mut Warnings) -> Result<Surface, Fault> {
    let head = Head::read(bytes)?;
    let count = |name: &str| head.elements.get(name).map_or(0, |e| e.count as u64);
    let (vertices, faces) = (count("vertex"), count("face") + count("tristrips"));
    if faces == 0 {
        return Err(Fault::new(match vertices {
            0 => "holds no faces; is the file empty or cut off?".into(),
            n => format!(
                "holds {} and no faces: it is a point cloud; reconstruct a surface of it first, and export that",
                counted(n, "point")
            ),
        }));
    }
    // Polygons of more than three vertices are counted when they are met.
    budget.take_mesh(faces, vertices).map_err(Fault::new)?;
    if head.has_texture {
        let message = "not drawn: its texture; name it as color_map in a scene file";
        warnings.add(message);
    }
    let mut payload = Payload::new(bytes, &head);
    let mut reader = Reader {
        surface: Surface::default(),
        budget,
        triangulator: Triangulator::new(),
        vertex_uvs: Vec::new(),
        short_faces: 0,
    };
    for element in head.elements.values() {
        match element.name.as_str() {
            "vertex" => reader.vertices(&mut payload, element)?,
            "face" | "tristrips" => reader.faces(&mut payload, element)?,
            // It has no bytes, however many there are.
            _ if element.properties.is_empty() => {}
            _ => {
                let parser = Parser::<Skipped>::new();
                for i in 0..element.count {
                    payload.next(&parser, element, i)?;
                }
            }
        }
    }
    if reader.short_faces > 0 {
        let count = counted(reader.short_faces, "face");
        warnings.add(format!("{count} of fewer than 3 vertices left out"));
    }
    Ok(reader.surface)
}

/// Reads the elements that make a surface.
struct Reader<'a> {
    surface: Surface,
    budget: &'a mut Budget,
    triangulator: Triangulator,
    /// One for each vertex, or none.
    vertex_uvs: Vec<Vec2>,
    short_faces: u64,
}

impl Reader<'_> {
    fn vertices(&mut self, payload: &mut Payload<'_>, element: &ElementDef) -> Result<(), Fault> {
        let has = |names: &[&str]| names.iter().any(|n| element.properties.contains_key(*n));
        for axis in ["x", "y", "z"] {
            if !has(&[axis]) {
                let message = format!("its vertices have no '{axis}'; export the mesh again");
                return Err(Fault::new(message));
            }
        }
        let has_normals = has(&["nx"]);
        let has_colors = has(&elements::RED);
        let has_uvs = has(&elements::U);
        let (mut normals, mut colors) = (Vec::new(), Vec::new());
        let parser = Parser::<Vertex>::new();
        for i in 0..element.count {
            let vertex = payload.next(&parser, element, i)?;
            let position = Vec3::from(vertex.position);
            if let Some(what) = fault_of(position) {
                return Err(payload.fault(format!("vertex {i} {what}; repair the mesh")));
            }
            self.surface.positions.push(position);
            if has_normals {
                normals.push(Vec3::from(vertex.normal));
            }
            if has_colors {
                colors.push(vertex.color);
            }
            if has_uvs {
                // v runs up in PLY, down here.
                let uv = Vec2::new(vertex.uv[0], 1.0 - vertex.uv[1]);
                self.vertex_uvs.push(uv);
            }
        }
        self.surface.normals = has_normals.then_some(normals);
        self.surface.colors = has_colors.then_some(colors);
        Ok(())
    }

    fn faces(&mut self, payload: &mut Payload<'_>, element: &ElementDef) -> Result<(), Fault> {
        let has = |name: &str| element.properties.contains_key(name);
        if !elements::INDICES.into_iter().any(has) {
            let message = format!(
                "its elements '{}' have no vertex_indices; export the mesh again",
                printable(&element.name)
            );
            return Err(Fault::new(message));
        }
        if has("texcoord") || !self.vertex_uvs.is_empty() {
            // Triangles of an element before this one have none.
            let zeros = vec![[Vec2::ZERO; 3]; self.surface.triangles.len()];
            self.surface.uvs.get_or_insert(zeros);
        }
        let is_strip = element.name == "tristrips";
        let parser = Parser::<Face>::new();
        for i in 0..element.count {
            let face = payload.next(&parser, element, i)?;
            let (corners, indices) = self
                .face(&face, is_strip)
                .map_err(|e| payload.fault(format!("{} {i}: {e}", element.name)))?;
            let uv = |corner: usize| match face.uvs.get(2 * corner..2 * corner + 2) {
                Some(uv) => Vec2::new(uv[0], 1.0 - uv[1]),
                None => {
                    let uv = self.vertex_uvs.get(indices[corner] as usize);
                    uv.copied().unwrap_or_default()
                }
            };
            if let Some(uvs) = &mut self.surface.uvs {
                uvs.extend(corners.iter().map(|t| t.map(uv)));
            }
            let triangles = corners.iter().map(|t| t.map(|k| indices[k]));
            self.surface.triangles.extend(triangles);
        }
        Ok(())
    }

    /// The triangles of a face, as numbers of its vertices, and its vertices.
    fn face(&mut self, face: &Face, is_strip: bool) -> Result<(Vec<[usize; 3]>, Vec<u32>), String> {
        let n = self.surface.positions.len();
        let mut indices = Vec::with_capacity(face.indices.len());
        for &index in &face.indices {
            // In strips, −1 begins a new one.
            let is_gap = is_strip && index == -1;
            if !is_gap && usize::try_from(index).ok().is_none_or(|index| index >= n) {
                return Err(format!(
                    "index {index} points at none of the {n} vertices before it; repair the mesh"
                ));
            }
            indices.push(if is_gap { GAP } else { index as u32 });
        }
        let more = (indices.len() as u64).saturating_sub(3);
        self.budget.take_mesh(more, 0)?;
        let corners = if is_strip {
            strip(&indices)
        } else if indices.len() < 3 {
            self.short_faces += 1;
            Vec::new()
        } else if indices.len() == 3 {
            vec![[0, 1, 2]]
        } else {
            let position = |&i: &u32| self.surface.positions[i as usize].as_dvec3();
            let vertices: Vec<DVec3> = indices.iter().map(position).collect();
            self.triangulator.triangulate(&vertices)
        };
        Ok((corners, indices))
    }
}

/// Stands in a strip where another one begins.
const GAP: u32 = u32::MAX;

/// The triangles of strips, as numbers of their vertices: every second one is wound the other way.
fn strip(indices: &[u32]) -> Vec<[usize; 3]> {
    let mut triangles = Vec::new();
    let mut first = 0;
    for strip in indices.split(|&i| i == GAP) {
        for k in 0..strip.len().saturating_sub(2) {
            let i = first + k;
            triangles.push(if k % 2 == 0 {
                [i, i + 1, i + 2]
            } else {
                [i + 1, i, i + 2]
            });
        }
        first += strip.len() + 1;
    }
    triangles
}
