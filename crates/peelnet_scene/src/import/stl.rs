//! STL files, binary and ASCII (3D Systems 1989): meshes of CAD programs and printers.
//!
//! Read here, not by a crate: `stl_io` and its like stop after the first solid of a file without a word, and take a binary file whose header
//! begins with `solid` for text, as many programs write it.

use super::surface::{Fault, fault_of, in_file, warn_of_rest};
use crate::{
    files::Files,
    mesh::{Mesh, area_of, key_of},
};
use glam::Vec3;
use peelnet_core::files::{counted, holds, printable};
use rayon::prelude::*;
use std::{collections::HashMap, path::Path};

/// Bytes of a binary file's header, and of its count.
const HEADER: usize = 80;
const COUNT: usize = 4;

/// Bytes of a triangle of a binary file: a normal, three vertices, and two that each program uses in another way.
const TRIANGLE: usize = 50;

/// Reads an STL file. Vertices at equal positions are one; normals are computed: smooth, but for edges of more than 30 degrees. All solids of a file
/// are one part. Colours, which each program writes in another way, are not read.
pub(super) fn read(path: &Path, bytes: &[u8], files: &mut Files<'_>) -> Result<Mesh, Fault> {
    let number = |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok());
    let count = number(HEADER).map(|count| u64::from(u32::from_le_bytes(count)));
    let needed = count.map(|n| (HEADER + COUNT) as u64 + n * TRIANGLE as u64);
    let held = bytes.len() as u64;
    if needed != Some(held) && is_text(bytes) {
        return read_text(path, bytes, files);
    }
    let (Some(count), Some(needed)) = (count, needed) else {
        return Err(in_file(format!(
            "has {}, and a binary STL file at least {}; is the file empty or cut off?",
            counted(held, "byte"),
            HEADER + COUNT
        )));
    };
    if needed > held {
        return Err(in_file(format!(
            "its header says that it has {}, which take {}, and it has {held}; is it an STL file, and is it cut off?",
            counted(count, "triangle"),
            counted(needed, "byte"),
        )));
    }
    warn_of_rest(files, path, held - needed, "byte", "triangle");
    files.budget.take_mesh(count, 0).map_err(in_file)?;
    let mut soup = Soup::default();
    let facets = &bytes[HEADER + COUNT..needed as usize];
    for (i, facet) in facets.chunks_exact(TRIANGLE).enumerate() {
        // Behind the normal stand nine numbers.
        let number = |k: usize| f32::from_le_bytes([0, 1, 2, 3].map(|b| facet[12 + 4 * k + b]));
        let triangle = [0, 3, 6].map(|k| Vec3::new(number(k), number(k + 1), number(k + 2)));
        if let Some(what) = triangle.into_iter().find_map(fault_of) {
            let message = format!("a vertex of triangle {i} {what}; repair the mesh");
            return Err(in_file(message));
        }
        soup.push(triangle);
    }
    soup.into_surface(path, files)
}

/// Whether a file is text: its first word is `solid`, as that of many binary files is, and a facet or the end follows it soon.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes[..bytes.len().min(4096)].to_ascii_lowercase();
    let is_solid = start.trim_ascii_start().starts_with(b"solid");
    is_solid && (holds(&start, b"facet") || holds(&start, b"endsolid"))
}

/// Reads a file of text, a statement a line. Normals are not used: many files have wrong ones.
fn read_text(path: &Path, bytes: &[u8], files: &mut Files<'_>) -> Result<Mesh, Fault> {
    // Names may be of any encoding; all other words are ASCII.
    let text = String::from_utf8_lossy(bytes).replace('\r', "\n");
    let mut soup = Soup::default();
    let mut vertices = Vec::new();
    let mut is_open = false;
    for (line, i) in text.lines().zip(1..) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let first = words.first().map(|word| word.to_ascii_lowercase());
        match first.as_deref() {
            Some(next @ ("facet" | "endfacet" | "solid" | "endsolid")) if !vertices.is_empty() => {
                let message = format!("'{next}' inside of a facet; add 'endloop' before it");
                return Err((Some(i), message));
            }
            None | Some("outer" | "facet" | "endfacet") => {}
            Some("solid") => is_open = true,
            Some("endsolid") => is_open = false,
            Some("vertex") if words.len() == 4 => {
                let number = |k: usize| words[k].parse().unwrap_or(f32::NAN);
                let vertex = Vec3::new(number(1), number(2), number(3));
                if let Some(what) = fault_of(vertex) {
                    return Err((Some(i), format!("a vertex {what}; repair the mesh")));
                }
                vertices.push(vertex);
            }
            Some("endloop") => {
                let &[a, b, c] = &vertices[..] else {
                    let message = format!("a facet of {} vertices", vertices.len());
                    return Err((Some(i), message + "; triangulate the mesh"));
                };
                files.budget.take_mesh(1, 0).map_err(in_file)?;
                soup.push([a, b, c]);
                vertices.clear();
            }
            _ => {
                let line = printable(line.trim());
                let message = format!("'{line}' is no statement of STL; repair the line");
                return Err((Some(i), message));
            }
        }
    }
    if !vertices.is_empty() {
        let message = "ends inside of a facet; is the file cut off?";
        return Err(in_file(message));
    }
    let surface = soup.into_surface(path, files)?;
    if is_open {
        files.warn(path, "has no 'endsolid' at its end: it may be cut off");
    }
    Ok(surface)
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

    fn into_surface(self, path: &Path, files: &mut Files<'_>) -> Result<Mesh, Fault> {
        if self.triangles.is_empty() {
            return Err(in_file("holds no facets; is the file empty or cut off?"));
        }
        let mut surface = Mesh {
            positions: self.positions,
            triangles: self.triangles,
            ..Mesh::default()
        };
        let lost = surface.drop_degenerate() as u64;
        if lost > 0 {
            let count = counted(lost, "triangle");
            files.warn(path, &(count + " without area left out"));
        }
        let surface = creased(&surface);
        let vertices = surface.positions.len() as u64;
        let taken = files.budget.take_mesh(0, vertices);
        taken.map_err(in_file)?;
        Ok(surface)
    }
}

/// Cosine of the angle between two triangles from which on the edge between them is sharp: 30 degrees.
const CREASE: f32 = 0.866_025_4;

/// Triangles around a vertex beyond which all edges there are smooth: comparing them takes time by their square.
const MOST_AROUND: usize = 64;

/// The surface with a normal for every vertex: of the triangles around it that lean by less than 30 degrees against each other. A vertex on a
/// sharp edge is split, as parts of machines have such edges; files of this format do not say where.
fn creased(surface: &Mesh) -> Mesh {
    let triangles = surface.triangles.iter();
    let areas: Vec<Vec3> = triangles.map(|t| area_of(&surface.positions, *t)).collect();
    let units: Vec<Vec3> = areas.iter().map(|a| a.normalize_or_zero()).collect();
    // Triangles by their vertices.
    let triangles = surface.triangles.iter().zip(0u32..);
    let mut adjacent: Vec<(u32, u32)> = triangles.flat_map(|(t, i)| t.map(|v| (v, i))).collect();
    adjacent.par_sort_unstable();
    let mut positions = Vec::with_capacity(surface.positions.len());
    let mut normals: Vec<Vec3> = Vec::with_capacity(surface.positions.len());
    let mut triangles = surface.triangles.clone();
    for around in adjacent.chunk_by(|a, b| a.0 == b.0) {
        let first = positions.len();
        let is_dense = around.len() > MOST_AROUND;
        let all: Vec3 = around.iter().map(|&(_, t)| areas[t as usize]).sum();
        for &(v, t) in around {
            let unit = units[t as usize];
            let sum = if is_dense {
                all
            } else {
                let near = around.iter().map(|&(_, o)| o as usize);
                let near = near.filter(|&o| unit.dot(units[o]) >= CREASE);
                near.map(|o| areas[o]).sum()
            };
            let normal = sum.normalize_or(unit);
            let known = normals[first..].iter().position(|n| *n == normal);
            let index = first + known.unwrap_or(normals.len() - first);
            if known.is_none() {
                positions.push(surface.positions[v as usize]);
                normals.push(normal);
            }
            let old = surface.triangles[t as usize];
            for (corner, old) in triangles[t as usize].iter_mut().zip(old) {
                if old == v {
                    *corner = index as u32;
                }
            }
        }
    }
    Mesh {
        positions,
        normals,
        triangles,
        ..Mesh::default()
    }
}
