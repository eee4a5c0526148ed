//! Wavefront OBJ files, read by `tobj` behind a check.

use super::{Imported, mtl::Libraries, polygons::Triangulator, surface::assemble};
use crate::{
    error::{SceneError, shown},
    files::{Files, MAX_MESH},
    material::Material,
    mesh::Mesh,
    warnings::Warnings,
};
use glam::{DVec3, Vec2, Vec3};
use peelnet_core::files::{MAX_SHOWN, printable};
use std::{borrow::Cow, fmt::Write, path::Path};

/// What is said of bright vertices.
pub(super) const BRIGHT: &str =
    "vertex colours outside of 0 … 1 are cut off; divide those of bytes by 255";

/// Reads an OBJ file and the MTL files and textures that it names.
///
/// Polygons are triangulated, missing or unusable normals computed, triangles without area left out with a warning. A missing MTL, or a name
/// that no MTL has, is a warning and a default material.
pub(super) fn load(path: &Path, files: &mut Files<'_>) -> Result<Imported, SceneError> {
    let bytes = files.read(path, MAX_MESH)?;
    let text = statements(path, &bytes, &mut files.warnings)?;
    drop(bytes);
    let fail = |message: String| SceneError::file(path, None, message);
    let mut libraries = Libraries::new(path, files);
    let text = check(path, &text, &mut libraries)?;
    let options = tobj::LoadOptions {
        single_index: true,
        ..tobj::LoadOptions::default()
    };
    let loaded = tobj::load_obj_buf(&mut text.as_bytes(), &options, |name| {
        Ok((Vec::new(), libraries.names(name)))
    });
    let (models, _) = loaded.map_err(|e| fail(format!("{e}; export the mesh again")))?;
    if models.iter().all(|m| m.mesh.indices.is_empty()) {
        return Err(fail("holds no faces; is the file empty or cut off?".into()));
    }
    let named = text.lines().filter_map(|line| line.strip_prefix("usemtl "));
    let materials = libraries.finish(named);
    let mut colors = models.iter().flat_map(|m| &m.mesh.vertex_color);
    if colors.any(|c| !(0.0..=1.0).contains(c)) {
        files.warn(path, BRIGHT);
    }
    let mut triangulator = Triangulator::default();
    let parts = models.into_iter().map(|tobj::Model { name, mesh }| {
        let material = mesh.material_id.map(|i| materials[i].clone());
        let surface = surface(&mesh, &mut triangulator);
        let surface = surface.map_err(|e| fail(format!("'{}' holds {e}", printable(&name))))?;
        let default = || Material::default_with(files.lighting);
        Ok((name, material.unwrap_or_else(default), surface))
    });
    let parts = parts.collect::<Result<_, SceneError>>()?;
    let mesh = assemble(parts, path, &mut files.warnings).map_err(fail)?;
    Ok(Imported {
        mesh,
        ..Imported::default()
    })
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
                let message = "is not UTF-8 text; is it an OBJ file? Save it as plain text";
                return Err(SceneError::file(path, Some(line), message));
            }
            warnings.add(format!(
                "{}:{line}: is not UTF-8 and is read as Latin-1; save it as UTF-8 where names look wrong",
                shown(path)
            ));
            let unmarked = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            let text = unmarked.iter().map(|&b| char::from(b));
            text.collect::<String>().into()
        }
    };
    let mut out = String::with_capacity(text.len());
    let (mut statement, mut joined) = (String::new(), 0);
    // The last line may say that it goes on.
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    for line in text.lines().chain([""]) {
        // Files that were joined have byte order marks inside.
        let line = line.trim_start_matches('\u{feff}');
        let line = line.split('#').next().unwrap_or("").trim();
        let (part, is_continued) = match line.strip_suffix('\\') {
            Some(part) => (part, true),
            None => (line, false),
        };
        let blank = |c: char| if c.is_whitespace() { ' ' } else { c };
        statement.extend(part.chars().map(blank));
        if is_continued {
            statement.push(' ');
            joined += 1;
        } else {
            // A part may be empty.
            out += statement.trim();
            out.extend(std::iter::repeat_n('\n', joined + 1));
            statement.clear();
            joined = 0;
        }
    }
    Ok(out)
}

/// Refuses, with its line, what `tobj` would misread or panic on, and reads the libraries. The text that is left: vertices first, as a face can
/// name any of them, then faces with numbers from 1, names and materials. Lines and points, which `tobj` takes for faces, are no part of it; a
/// warning names them.
fn check(path: &Path, text: &str, libraries: &mut Libraries<'_, '_>) -> Result<String, SceneError> {
    let fault = |number, line: &str, what: &str| {
        let message = format!("'{}' {what}", printable(line));
        SceneError::file(path, Some(number), message)
    };
    let mut out = String::with_capacity(text.len());
    // Positions, UVs and normals; those of them that stand before a face, as negative numbers count back from there.
    let [mut counts, mut read] = [[0; 3]; 2];
    let list = |key: &str| ["v", "vt", "vn"].iter().position(|k| *k == key);
    let mut colors = 0;
    for (line, number) in text.lines().zip(1..) {
        let (key, rest) = line.split_once(' ').unwrap_or((line, ""));
        let Some(list) = list(key) else { continue };
        counts[list] += 1;
        let is_colored = check_vertex(key, rest).and_then(|is_colored| {
            colors += usize::from(is_colored);
            if [0, counts[0]].contains(&colors) {
                return Ok(());
            }
            Err("is among vertices some of which have a colour and some none".into())
        });
        is_colored.map_err(|what| fault(number, line, &format!("{what}; repair the line")))?;
        out.extend([line, "\n"]);
    }
    for (line, number) in text.lines().zip(1..) {
        let (key, rest) = line.split_once(' ').unwrap_or((line, ""));
        match key {
            "f" => {
                let words: Vec<&str> = rest.split_whitespace().collect();
                if words.len() < 3 {
                    let what = "is a face of fewer than 3 vertices; is the file cut off? Export the mesh again";
                    return Err(fault(number, line, what));
                }
                out.push('f');
                for word in words {
                    let what = "names a vertex that is not there; repair the face";
                    let numbers = numbers(word, counts, read);
                    let numbers = numbers.ok_or_else(|| fault(number, line, what))?;
                    let [v, vt, vn] = numbers.map(|n| n.map_or(String::new(), |n| n.to_string()));
                    let _ = write!(out, " {v}/{vt}/{vn}");
                }
            }
            "mtllib" if !libraries.load(rest)? => continue,
            "o" | "g" | "usemtl" if rest.len() > MAX_SHOWN => {
                return Err(fault(
                    number,
                    line,
                    "has a name of more than 200 bytes; repair it",
                ));
            }
            // tobj refuses a material without a name.
            "usemtl" if rest.is_empty() => out += "usemtl unnamed",
            "o" | "g" | "mtllib" | "usemtl" => out += line,
            // Smoothing: normals that a file lacks are computed.
            "" | "s" => continue,
            _ => {
                match list(key) {
                    Some(list) => read[list] += 1,
                    None => libraries.files.warnings.not_drawn(path, key),
                }
                continue;
            }
        }
        out.push('\n');
    }
    Ok(out)
}

/// Whether the line of a vertex, a UV or a normal has a colour, or what is wrong with it.
fn check_vertex(key: &str, rest: &str) -> Result<bool, Cow<'static, str>> {
    const NOT_FINITE: &str = "holds no finite numbers";
    // A vertex of more numbers than these is none.
    let words = rest.split_whitespace().take(7).map(str::parse);
    let numbers: Vec<f32> = words.collect::<Result<_, _>>().map_err(|_| NOT_FINITE)?;
    let is_finite = match (key, &*numbers) {
        // UVs that are not finite are taken as 0 later.
        ("vt", [_, _, ..]) => true,
        ("v", [position @ .., w]) if numbers.len() == 4 => {
            position.iter().all(|x| (x / w).is_finite())
        }
        ("v", [_, _, _] | [_, _, _, _, _, _]) | ("vn", [_, _, _, ..]) => {
            numbers.iter().all(|x| x.is_finite())
        }
        ("v", _) => {
            let message = format!(
                "is a vertex of {} numbers, and a position has 3, with w 4, with a colour 6: is the file cut off?",
                numbers.len()
            );
            return Err(message.into());
        }
        _ => return Err("holds too few numbers".into()),
    };
    let is_colored = key == "v" && numbers.len() == 6;
    is_finite.then_some(is_colored).ok_or(NOT_FINITE.into())
}

/// The numbers, from 1, of the position, the UV and the normal that a word such as `1/2/3` names. Those of a list that is empty are none.
fn numbers(word: &str, counts: [usize; 3], read: [usize; 3]) -> Option<[Option<usize>; 3]> {
    let mut numbers = [None; 3];
    for (k, part) in word.split('/').enumerate() {
        if part.is_empty() {
            continue;
        }
        let count = *counts.get(k)?;
        let number: i64 = part.parse().ok()?;
        if k > 0 && (number == 0 || count == 0) {
            continue;
        }
        let base = if number < 0 { read[k] as i64 + 1 } else { 0 };
        let number = usize::try_from(base.checked_add(number)?).ok()?;
        numbers[k] = Some(number).filter(|n| (1..=count).contains(n));
        numbers[k]?;
    }
    numbers[0].map(|_| numbers)
}

/// The surface of a model. It has UVs only if all of its vertices have them; normals and colours likewise.
fn surface(mesh: &tobj::Mesh, triangulator: &mut Triangulator) -> Result<Mesh, String> {
    let vectors = |flat: &[f32]| -> Vec<Vec3> { flat.chunks(3).map(Vec3::from_slice).collect() };
    let positions = vectors(&mesh.positions);
    let n = positions.len();
    // tobj lists no arities where all faces are triangles.
    let all_triangles = mesh.indices.len() / 3 * usize::from(mesh.face_arities.is_empty());
    let arities = mesh.face_arities.iter().copied();
    let mut rest = &*mesh.indices;
    let mut triangles = Vec::new();
    for arity in arities.chain(std::iter::repeat_n(3, all_triangles)) {
        let (face, after) = rest.split_at(arity as usize);
        rest = after;
        let position = |&i: &u32| positions[i as usize].as_dvec3();
        let polygon: Vec<DVec3> = face.iter().map(position).collect();
        let cut = triangulator.triangulate(&polygon)?;
        triangles.extend(cut.into_iter().map(|t| t.map(|k| face[k])));
    }
    // v runs up in OBJ, down here.
    let uvs = mesh.texcoords.chunks(2);
    let uvs: Vec<Vec2> = uvs.map(|uv| Vec2::new(uv[0], 1.0 - uv[1])).collect();
    let colors = vectors(&mesh.vertex_color).into_iter();
    let colors = colors.map(|c| c.clamp(Vec3::ZERO, Vec3::ONE).extend(1.0).to_array());
    let normals = Some(vectors(&mesh.normals)).filter(|all| all.len() == n);
    let with_uvs = triangles.iter().filter(|_| uvs.len() == n);
    Ok(Mesh {
        uvs: with_uvs.map(|t| t.map(|i| uvs[i as usize])).collect(),
        normals: normals.unwrap_or_default(),
        colors: colors.collect(),
        positions,
        triangles,
        ..Mesh::default()
    })
}
