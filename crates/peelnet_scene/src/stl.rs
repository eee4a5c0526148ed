//! STL files, binary and ASCII (3D Systems 1989): meshes of CAD programs and printers.
//!
//! Read here, not by a crate: those that there are take a binary file whose header begins with `solid` for text, as many programs write it,
//! and know no lines in their errors.

#[cfg(test)]
mod tests;
mod text;

use crate::{
    budget::Budget,
    error::SceneError,
    files::Files,
    material::Lighting,
    mesh::key_of,
    scan::{self, Fault, Surface, fault_of},
    warnings::Warnings,
};
use glam::Vec3;
use peelnet_files::counted;
use std::{collections::HashMap, io, path::Path};

pub use crate::scan::LoadedScan;

/// Reads an STL file. Vertices at equal positions are one; normals are computed: smooth, but for edges of more than 30 degrees. All solids of a file
/// are one part. Colours, which each program writes in another way, are not read.
///
/// # Errors
/// A file that cannot be read, is cut off, has no facets, or holds numbers that make no sense: with its line or triangle.
pub fn load_stl(path: &Path, lighting: Lighting) -> Result<LoadedScan, SceneError> {
    load(path, lighting, &mut Files::new(&peelnet_files::read))
}

/// The same with a function that reads files: from an archive, or from memory.
///
/// # Errors
/// See [`load_stl`].
pub fn load_stl_from(
    path: &Path,
    lighting: Lighting,
    read: impl Fn(&Path) -> io::Result<Vec<u8>>,
) -> Result<LoadedScan, SceneError> {
    load(path, lighting, &mut Files::new(&|path, _| read(path)))
}

/// Reads an STL file.
pub(crate) fn load(
    path: &Path,
    lighting: Lighting,
    files: &mut Files<'_>,
) -> Result<LoadedScan, SceneError> {
    scan::load(path, lighting, files, surface)
}

/// Bytes of a binary file's header, and of its count.
const HEADER: usize = 80;
const COUNT: usize = 4;

/// Bytes of a triangle of a binary file: a normal, three vertices, and two that each program uses in another way.
const TRIANGLE: usize = 50;

/// The triangles of a file.
fn surface(bytes: &[u8], budget: &mut Budget, warnings: &mut Warnings) -> Result<Surface, Fault> {
    let count = bytes
        .get(HEADER..HEADER + COUNT)
        .map(|count| u64::from(u32::from_le_bytes([count[0], count[1], count[2], count[3]])));
    let needed = count.map(|n| (HEADER + COUNT) as u64 + n * TRIANGLE as u64);
    let held = bytes.len() as u64;
    if needed != Some(held) && text::is_text(bytes) {
        return text::read(bytes, budget, warnings);
    }
    let (Some(count), Some(needed)) = (count, needed) else {
        return Err(Fault::new(format!(
            "has {}, and a binary STL file at least {}; is the file empty or cut off?",
            counted(held, "byte"),
            HEADER + COUNT
        )));
    };
    if needed > held {
        return Err(Fault::new(format!(
            "its header says that it has {}, which take {}, and it has {held}; is it an STL file, and is it cut off?",
            counted(count, "triangle"),
            counted(needed, "byte"),
        )));
    }
    if needed < held {
        let more = counted(held - needed, "byte");
        warnings.add(format!("{more} behind its last triangle are not read"));
    }
    budget.take_mesh(count, 0).map_err(Fault::new)?;
    let mut soup = Soup::default();
    let facets = &bytes[HEADER + COUNT..needed as usize];
    for (i, facet) in facets.chunks_exact(TRIANGLE).enumerate() {
        let number = |k: usize| {
            let at = 12 + 4 * k;
            f32::from_le_bytes([facet[at], facet[at + 1], facet[at + 2], facet[at + 3]])
        };
        let vertex = |k: usize| Vec3::new(number(3 * k), number(3 * k + 1), number(3 * k + 2));
        let triangle = [0, 1, 2].map(vertex);
        if let Some(what) = triangle.into_iter().find_map(fault_of) {
            let message = format!("a vertex of triangle {i} {what}; repair the mesh");
            return Err(Fault::new(message));
        }
        soup.push(triangle);
    }
    soup.into_surface(budget, warnings)
}

/// Triangles, whose vertices at equal positions become one.
#[derive(Default)]
struct Soup {
    positions: Vec<Vec3>,
    known: HashMap<[u32; 3], u32>,
    triangles: Vec<[u32; 3]>,
}

impl Soup {
    fn push(&mut self, triangle: [Vec3; 3]) {
        let triangle = triangle.map(|p| {
            *self.known.entry(key_of(p)).or_insert_with(|| {
                self.positions.push(p);
                self.positions.len() as u32 - 1
            })
        });
        self.triangles.push(triangle);
    }

    /// The surface, with normals.
    fn into_surface(self, budget: &mut Budget, warnings: &mut Warnings) -> Result<Surface, Fault> {
        if self.triangles.is_empty() {
            return Err(Fault::new("holds no facets; is the file empty or cut off?"));
        }
        let mut surface = Surface {
            positions: self.positions,
            triangles: self.triangles,
            ..Surface::default()
        };
        surface.drop_degenerate(warnings);
        let surface = creased(&surface);
        let vertices = surface.positions.len() as u64;
        budget.take_mesh(0, vertices).map_err(Fault::new)?;
        Ok(surface)
    }
}

/// Cosine of the angle between two triangles from which on the edge between them is sharp: 30 degrees.
const CREASE: f32 = 0.866_025_4;

/// Triangles around a vertex beyond which all edges there are smooth: comparing them takes time by their square.
const MOST_AROUND: usize = 64;

/// The surface with a normal for every vertex: of the triangles around it that lean by less than 30 degrees against each other. A vertex on a
/// sharp edge is split, as parts of machines have such edges; files of this format do not say where.
fn creased(surface: &Surface) -> Surface {
    let areas = surface.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|i| surface.positions[i as usize]);
        (b - a).cross(c - a)
    });
    let areas: Vec<Vec3> = areas.collect();
    let units: Vec<Vec3> = areas.iter().map(|a| a.normalize_or_zero()).collect();
    let (starts, adjacent) = adjacent(surface);
    let mut positions = Vec::with_capacity(surface.positions.len());
    let mut normals: Vec<Vec3> = Vec::with_capacity(surface.positions.len());
    let mut triangles = surface.triangles.clone();
    for (v, range) in starts.windows(2).enumerate() {
        let around = &adjacent[range[0] as usize..range[1] as usize];
        let first = positions.len();
        let is_dense = around.len() > MOST_AROUND;
        let all: Vec3 = around.iter().map(|&t| areas[t as usize]).sum();
        for &t in around {
            let unit = units[t as usize];
            let sum = if is_dense {
                all
            } else {
                let near = around.iter().map(|&o| o as usize);
                let near = near.filter(|&o| unit.dot(units[o]) >= CREASE);
                near.map(|o| areas[o]).sum()
            };
            let normal = sum.normalize_or(unit);
            let known = normals[first..].iter().position(|n| *n == normal);
            let index = first + known.unwrap_or(normals.len() - first);
            if known.is_none() {
                positions.push(surface.positions[v]);
                normals.push(normal);
            }
            let old = surface.triangles[t as usize];
            for (corner, old) in triangles[t as usize].iter_mut().zip(old) {
                if old as usize == v {
                    *corner = index as u32;
                }
            }
        }
    }
    Surface {
        positions,
        normals: Some(normals),
        triangles,
        ..Surface::default()
    }
}

/// The triangles around each vertex, one after another, and where each vertex's begin.
fn adjacent(surface: &Surface) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; surface.positions.len() + 1];
    for &v in surface.triangles.iter().flatten() {
        starts[v as usize + 1] += 1;
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut next = starts.clone();
    let mut adjacent = vec![0u32; 3 * surface.triangles.len()];
    for (triangle, t) in surface.triangles.iter().zip(0u32..) {
        for &v in triangle {
            adjacent[next[v as usize] as usize] = t;
            next[v as usize] += 1;
        }
    }
    (starts, adjacent)
}
