//! Wavefront OBJ files, read by `tobj`.
//!
//! Before it, what it would misread or panic on is rewritten line by line, so that lines keep their numbers, or refused; behind it, values are
//! checked and polygons cut into triangles. A fault has its line where `tobj` stops there.

use super::{Imported, mtl::Libraries, polygons::Triangulator, textures::Textures};
use crate::{
    error::{SceneError, shown},
    files::{FileKind, Files},
    material::{Lighting, Material},
    mesh::{Mesh, NO_UVS, Part, PartGeometry, key_of},
    warnings::Warnings,
};
use glam::{DVec3, Vec2, Vec3};
use peelnet_files::printable;
use std::{
    borrow::Cow,
    cell::RefCell,
    collections::{HashMap, HashSet},
    path::Path,
};

#[cfg(test)]
#[path = "obj_tests.rs"]
mod tests;

/// Digits of the largest index: `tobj` multiplies indices before it checks them, and panics where the product overflows. The largest file that
/// is read has fewer than a billion vertices.
const INDEX_DIGITS: usize = 9;

/// Reads an OBJ file and the MTL files and textures that it names.
///
/// Polygons are triangulated, missing or unusable normals computed, triangles without area left out with a warning. A missing MTL, or a name
/// that no MTL has, is a warning and a default material.
pub(super) fn load(
    path: &Path,
    lighting: Lighting,
    files: &mut Files<'_>,
) -> Result<Imported, SceneError> {
    let fail = |line: Option<usize>, message: String| SceneError::Mesh {
        path: path.to_owned(),
        line,
        message,
    };
    let bytes = files.read(path, FileKind::Mesh)?;
    files.record(path, &bytes);
    let mut warnings = Warnings::default();
    let text = statements(path, &bytes, &mut warnings)?;
    check(&text).map_err(|(line, message)| fail(Some(line), message))?;
    // tobj takes a line of three points for a triangle.
    let is_drawn = |line: &&str| !(line.starts_with("l ") || line.starts_with("p "));
    let text: String = text
        .lines()
        .map(|line| if is_drawn(&line) { line } else { "" })
        .flat_map(|line| [line, "\n"])
        .collect();
    let options = tobj::LoadOptions {
        single_index: true,
        ..tobj::LoadOptions::default()
    };
    let libraries = RefCell::new(Libraries::new(path, files, warnings));
    let mut unread = text.as_bytes();
    let loaded = tobj::load_obj_buf(&mut unread, &options, |name| {
        libraries.borrow_mut().load(name)
    });
    let Libraries {
        files,
        owners,
        mut warnings,
        is_incomplete,
        error,
        ..
    } = libraries.into_inner();
    let (models, materials) = loaded.map_err(|e| {
        // It stops reading where it fails.
        let read = &text.as_bytes()[..text.len() - unread.len()];
        let line = read.iter().filter(|&&b| b == b'\n').count().max(1);
        let line_text = printable(text.lines().nth(line - 1).unwrap_or_default());
        fail(Some(line), format!("{e} in '{line_text}'; repair the line"))
    })?;
    if let Some(e) = error {
        return Err(e);
    }
    if !models.iter().all(|m| is_sound(&m.mesh)) {
        let message = "a number is not finite; is it too large? Export the mesh again";
        return Err(fail(None, message.into()));
    }
    if models.iter().all(|m| m.mesh.indices.is_empty()) {
        let message = "holds no faces; is the file empty or cut off?";
        return Err(fail(None, message.into()));
    }
    let materials = materials.unwrap_or_default();
    if !is_incomplete {
        let known: HashSet<&str> = materials.iter().map(|m| m.name.as_str()).collect();
        let named = text.lines().filter_map(|line| line.strip_prefix("usemtl "));
        for name in named.filter(|name| !known.contains(name.trim())) {
            warnings.about(
                format!("{}: no material ", shown(path)),
                &format!("'{}'", printable(name.trim())),
                " in its MTL files; default material used",
            );
        }
    }
    let mut textures = Textures::new(&mut warnings);
    let materials: Vec<Material> = materials
        .iter()
        .zip(&owners)
        .map(|(m, owner)| textures.put_on(files, owner, m, super::mtl::material(m, lighting)))
        .collect();
    let material = |model: &tobj::Model| {
        let id = model.mesh.material_id;
        id.and_then(|i| materials.get(i).cloned())
            .unwrap_or_else(|| Material::default_with(lighting))
    };
    let mesh = assemble(&models, material, &shown(path), &mut warnings)
        .map_err(|message| fail(None, message))?;
    if mesh.triangles.is_empty() {
        let message = "holds no triangle with an area; export the mesh again";
        return Err(fail(None, message.into()));
    }
    Ok(Imported::mesh(mesh, warnings.texts()))
}

/// The text of an OBJ or MTL file: UTF-8, else Latin-1 as old exporters write it, with a warning. Without comments, with continued lines joined
/// and blanks for all other white space; every statement stays on its line.
pub(super) fn statements(
    path: &Path,
    bytes: &[u8],
    warnings: &mut Warnings,
) -> Result<String, SceneError> {
    let text: Cow<'_, str> = match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(e) => {
            let valid = &bytes[..e.valid_up_to()];
            let line = 1 + valid.iter().filter(|&&b| b == b'\n').count();
            // No text has these: it is UTF-16, or not text.
            if bytes.contains(&0) {
                return Err(SceneError::Mesh {
                    path: path.to_owned(),
                    line: Some(line),
                    message: "is not UTF-8 text; is it an OBJ file? Save it as plain text".into(),
                });
            }
            warnings.add(format!(
                "{}:{line}: is not UTF-8 and is read as Latin-1; save it as UTF-8 where names look wrong",
                shown(path)
            ));
            let marked = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            marked
                .iter()
                .map(|&b| char::from(b))
                .collect::<String>()
                .into()
        }
    };
    let mut out = String::with_capacity(text.len());
    let mut joined = 0;
    for line in text.replace("\r\n", "\n").replace('\r', "\n").lines() {
        // Files that were joined have byte order marks inside.
        let line = line.trim_start_matches('\u{feff}');
        let line = line.split('#').next().unwrap_or("").trim();
        let (part, is_continued) = match line.strip_suffix('\\') {
            Some(part) => (part, true),
            None => (line, false),
        };
        let blank = |c: char| if c.is_whitespace() { ' ' } else { c };
        out.extend(part.chars().map(blank));
        if is_continued {
            out.push(' ');
            joined += 1;
        } else {
            out.extend(std::iter::repeat_n('\n', joined + 1));
            joined = 0;
        }
    }
    Ok(out)
}

/// Refuses what `tobj` would read wrong or panic on: words for numbers, such as `nan`; indices that overflow; colours of some vertices alone,
/// which would become those of others; faces of fewer than three vertices, which it takes for lines. The line from 1, and a message.
fn check(text: &str) -> Result<(), (usize, String)> {
    let mut has_colors = None;
    for (line, number) in text.lines().zip(1..) {
        let (key, rest) = line.split_once(' ').unwrap_or((line, ""));
        let is_word = |b: u8| b.is_ascii_alphabetic() && !b.eq_ignore_ascii_case(&b'e');
        let is_index_too_large = || {
            let mut numbers = rest.split(|c: char| !c.is_ascii_digit());
            numbers.any(|n| n.len() > INDEX_DIGITS)
        };
        let message = match key {
            "v" | "vn" if rest.bytes().any(is_word) => {
                format!(
                    "'{}' holds no finite numbers; repair the mesh",
                    printable(line)
                )
            }
            "v" => {
                let count = rest.split_whitespace().count();
                if (3..=4).contains(&count) || count == 6 {
                    let is_colored = count == 6;
                    if *has_colors.get_or_insert(is_colored) == is_colored {
                        continue;
                    }
                    "a vertex with a colour among vertices without one; repair the line".into()
                } else {
                    format!(
                        "a vertex of {count} numbers; a position has 3, with w 4, with a colour 6: repair the line, or is the file cut off?"
                    )
                }
            }
            "f" if is_index_too_large() => "an index is too large; repair the face".into(),
            "f" if rest.split_whitespace().count() < 3 => {
                "a face has fewer than 3 vertices; is the file cut off?".into()
            }
            _ => continue,
        };
        return Err((number, message));
    }
    Ok(())
}

/// Whether a mesh has finite numbers alone: some are too large for the type.
fn is_sound(mesh: &tobj::Mesh) -> bool {
    let numbers = [&mesh.positions, &mesh.normals, &mesh.vertex_color];
    numbers.into_iter().flatten().all(|x| x.is_finite())
}

/// The mesh of all models of a file.
fn assemble(
    models: &[tobj::Model],
    material: impl Fn(&tobj::Model) -> Material,
    file: &str,
    warnings: &mut Warnings,
) -> Result<Mesh, String> {
    let mut triangulator = Triangulator::new();
    let triangles: Vec<Vec<[u32; 3]>> = models
        .iter()
        .map(|model| triangles(&model.mesh, &mut triangulator))
        .collect::<Result<_, _>>()?;
    let areas = area_sums(models, &triangles);
    let mut mesh = Mesh::empty();
    let mut lost = Lost::default();
    for (model, triangles) in models.iter().zip(triangles) {
        let geometry = part_geometry(&model.mesh, triangles, &areas, &mut lost);
        if geometry.triangles.is_empty() {
            continue;
        }
        let part = Part {
            name: model.name.clone(),
            triangles: 0..0,
            material: material(model),
        };
        if mesh.push(geometry, part) {
            let name = format!("'{}'", printable(&model.name));
            warnings.about(format!("{file}: "), &name, NO_UVS);
        }
    }
    for (count, what) in [
        (
            lost.uvs,
            "texture coordinates were not finite and are taken as 0",
        ),
        (lost.triangles, "triangles without area left out"),
        (
            lost.normals,
            "normals were zero and were computed from the triangles",
        ),
    ] {
        if count > 0 {
            warnings.add(format!("{file}: {count} {what}"));
        }
    }
    Ok(mesh)
}

/// How many elements of a file could not be used.
#[derive(Default)]
struct Lost {
    uvs: usize,
    triangles: usize,
    normals: usize,
}

fn vectors(flat: &[f32]) -> Vec<Vec3> {
    flat.chunks_exact(3).map(Vec3::from_slice).collect()
}

/// The faces of a mesh as triangles.
fn triangles(mesh: &tobj::Mesh, triangulator: &mut Triangulator) -> Result<Vec<[u32; 3]>, String> {
    // tobj lists no arities where all faces are triangles.
    if mesh.face_arities.is_empty() {
        let triangles = mesh.indices.chunks_exact(3);
        return Ok(triangles.map(|t| [t[0], t[1], t[2]]).collect());
    }
    let position = |i: &u32| {
        let p = &mesh.positions[3 * *i as usize..];
        DVec3::new(p[0].into(), p[1].into(), p[2].into())
    };
    let mut rest = mesh.indices.as_slice();
    let mut triangles = Vec::new();
    for &arity in &mesh.face_arities {
        let (face, after) = rest.split_at(arity as usize);
        rest = after;
        let vertices: Vec<DVec3> = face.iter().map(position).collect();
        let cut = triangulator.triangulate(&vertices)?;
        triangles.extend(cut.into_iter().map(|t| t.map(|i| face[i])));
    }
    Ok(triangles)
}

/// The sum of the adjacent triangles' area vectors at every position of the file: groups and UV seams split vertices, but not the
/// surface.
fn area_sums(models: &[tobj::Model], triangles: &[Vec<[u32; 3]>]) -> HashMap<[u32; 3], Vec3> {
    let mut sums: HashMap<[u32; 3], Vec3> = HashMap::new();
    for (model, triangles) in models.iter().zip(triangles) {
        let position = |i: u32| Vec3::from_slice(&model.mesh.positions[3 * i as usize..]);
        for t in triangles {
            let [a, b, c] = t.map(position);
            let area = (b - a).cross(c - a);
            for p in [a, b, c] {
                *sums.entry(key_of(p)).or_default() += area;
            }
        }
    }
    sums
}

/// A model's vertices, and those of its triangles that have an area.
fn part_geometry(
    mesh: &tobj::Mesh,
    mut triangles: Vec<[u32; 3]>,
    areas: &HashMap<[u32; 3], Vec3>,
    lost: &mut Lost,
) -> PartGeometry {
    let positions = vectors(&mesh.positions);
    let all = triangles.len();
    // Exactly zero, not small: a sliver is a triangle.
    triangles.retain(|t| {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        (b - a).cross(c - a) != Vec3::ZERO
    });
    lost.triangles += all - triangles.len();
    let smooth = |p: &Vec3| {
        areas
            .get(&key_of(*p))
            .map_or(Vec3::Z, |n| n.normalize_or(Vec3::Z))
    };
    let given = vectors(&mesh.normals);
    let normals: Vec<Vec3> = if given.len() == positions.len() {
        let both = given.iter().zip(&positions);
        both.map(|(n, p)| {
            n.try_normalize().unwrap_or_else(|| {
                lost.normals += 1;
                smooth(p)
            })
        })
        .collect()
    } else {
        positions.iter().map(smooth).collect()
    };
    let uvs: Vec<Vec2> = mesh
        .texcoords
        .chunks_exact(2)
        .map(|uv| {
            // v runs up in OBJ, down here.
            let uv = Vec2::new(uv[0], 1.0 - uv[1]);
            lost.uvs += usize::from(!uv.is_finite());
            if uv.is_finite() { uv } else { Vec2::ZERO }
        })
        .collect();
    let colors: Vec<[f32; 4]> = vectors(&mesh.vertex_color)
        .iter()
        .map(|c| c.clamp(Vec3::ZERO, Vec3::ONE).extend(1.0).to_array())
        .collect();
    let n = positions.len();
    PartGeometry {
        // A part has UVs only if all of its vertices have them; colours likewise.
        uvs: (uvs.len() == n).then_some(uvs),
        colors: (colors.len() == n).then_some(colors),
        positions,
        normals,
        triangles,
    }
}
