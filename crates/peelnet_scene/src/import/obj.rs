//! Wavefront OBJ files.

use super::{
    Imported,
    mtl::Libraries,
    polygons::Triangulator,
    surface::{Surface, assemble},
};
use crate::{
    error::{SceneError, shown},
    files::{FileKind, Files},
    material::{Lighting, Material},
    warnings::Warnings,
};
use glam::{DVec3, Vec2, Vec3};
use peelnet_files::printable;
use std::{borrow::Cow, collections::HashMap, path::Path};

#[cfg(test)]
#[path = "obj_tests.rs"]
mod tests;

/// Reads an OBJ file and the MTL files and textures that it names.
///
/// Polygons are triangulated, missing or unusable normals computed, triangles without area left out with a warning. A missing MTL, or a name
/// that no MTL has, is a warning and a default material.
pub(super) fn load(
    path: &Path,
    lighting: Lighting,
    files: &mut Files<'_>,
) -> Result<Imported, SceneError> {
    let bytes = files.read(path, FileKind::Mesh)?;
    files.record(path, &bytes);
    let mut warnings = Warnings::default();
    let text = statements(path, &bytes, &mut warnings)?;
    drop(bytes);
    let at_line = |(line, message): (usize, String)| SceneError::file(path, Some(line), message);
    let vertices = Vertices::read(&text).map_err(at_line)?;
    let mut libraries = Libraries::new(path, lighting, files, warnings);
    let mut parts = Parts::new(&vertices);
    for (line, number) in text.lines().zip(1..) {
        let (key, rest) = line.split_once(' ').unwrap_or((line, ""));
        match key {
            "v" => parts.read[0] += 1,
            "vt" => parts.read[1] += 1,
            "vn" => parts.read[2] += 1,
            "f" => {
                let face = parts.face(rest);
                let fault = |what| (number, format!("'{}' {what}", printable(line)));
                face.map_err(|what| at_line(fault(what)))?;
            }
            "o" | "g" => {
                parts.close();
                parts.name = if rest.is_empty() { UNNAMED } else { rest }.to_owned();
            }
            "mtllib" => libraries.load(rest)?,
            "usemtl" => {
                let material = libraries.find(rest);
                if parts.material != material {
                    parts.close();
                }
                parts.material = material;
            }
            _ => {}
        }
    }
    parts.close();
    if parts.done.is_empty() {
        let message = "holds no faces; is the file empty or cut off?";
        return Err(SceneError::file(path, None, message));
    }
    let (materials, mut warnings) = libraries.materials();
    let parts = parts.done.into_iter().map(|(name, material, surface)| {
        let material = material.map(|i| materials[i].clone());
        let default = || Material::default_with(lighting);
        (name, material.unwrap_or_else(default), surface)
    });
    let mesh = assemble(
        parts.collect(),
        &format!("{}: ", shown(path)),
        &mut warnings,
    );
    let mesh = mesh.map_err(|message| SceneError::file(path, None, message))?;
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

const NOT_FINITE: &str = "holds no finite numbers";

/// Everything that faces of a file point at.
#[derive(Default)]
struct Vertices {
    positions: Vec<Vec3>,
    /// One for each position, or none.
    colors: Vec<[f32; 4]>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
}

impl Vertices {
    /// An error has the line from 1, and a message.
    fn read(text: &str) -> Result<Self, (usize, String)> {
        let mut all = Self::default();
        for (line, number) in text.lines().zip(1..) {
            let (key, rest) = line.split_once(' ').unwrap_or((line, ""));
            if !matches!(key, "v" | "vt" | "vn") {
                continue;
            }
            let fault = |what: &str| {
                let message = format!("'{}' {what}; repair the line", printable(line));
                (number, message)
            };
            // A vertex of more numbers than these is none.
            let mut numbers = [0.0; 7];
            let mut count = 0;
            for (number, word) in numbers.iter_mut().zip(rest.split_whitespace()) {
                *number = word.parse().map_err(|_| fault(NOT_FINITE))?;
                count += 1;
            }
            let added = all.add(key, &numbers[..count]);
            added.map_err(|what| fault(&what))?;
        }
        Ok(all)
    }

    fn add(&mut self, key: &str, numbers: &[f32]) -> Result<(), Cow<'static, str>> {
        match (key, numbers) {
            // v runs up in OBJ, down here.
            ("vt", [u, v, ..]) => self.uvs.push(Vec2::new(*u, 1.0 - *v)),
            ("vn", [x, y, z, ..]) => self.normals.push(Vec3::new(*x, *y, *z)),
            ("v", [x, y, z]) => self.positions.push(Vec3::new(*x, *y, *z)),
            ("v", [x, y, z, w]) => self.positions.push(Vec3::new(*x, *y, *z) / *w),
            ("v", [x, y, z, color @ ..]) if color.len() == 3 => {
                self.positions.push(Vec3::new(*x, *y, *z));
                let color = Vec3::from_slice(color);
                if !color.is_finite() {
                    return Err(NOT_FINITE.into());
                }
                let color = color.clamp(Vec3::ZERO, Vec3::ONE).extend(1.0);
                self.colors.push(color.to_array());
            }
            ("v", _) => {
                let message = format!(
                    "is a vertex of {} numbers, and a position has 3, with w 4, with a colour 6: is the file cut off?",
                    numbers.len()
                );
                return Err(message.into());
            }
            _ => return Err("holds too few numbers".into()),
        }
        // UVs that are not finite are taken as 0 later.
        let added = [self.positions.last(), self.normals.last()];
        if added.into_iter().flatten().any(|p| !p.is_finite()) {
            return Err(NOT_FINITE.into());
        }
        if ![0, self.positions.len()].contains(&self.colors.len()) {
            return Err("is among vertices some of which have a colour and some none".into());
        }
        Ok(())
    }
}

/// The name of a part without one.
const UNNAMED: &str = "unnamed_object";

/// The parts of a file: a new one begins at each group, object and material.
struct Parts<'a> {
    all: &'a Vertices,
    /// How many positions, UVs and normals stand before a face: negative numbers count back from them.
    read: [usize; 3],
    triangulator: Triangulator,
    name: String,
    material: Option<usize>,
    done: Vec<(String, Option<usize>, Surface)>,
    /// The open part, its vertices by their numbers in the file, and one UV for each, where the file has them.
    surface: Surface,
    known: HashMap<[Option<usize>; 3], u32>,
    uvs: Vec<Vec2>,
}

impl<'a> Parts<'a> {
    fn new(all: &'a Vertices) -> Self {
        Self {
            all,
            read: [0; 3],
            triangulator: Triangulator::new(),
            name: UNNAMED.to_owned(),
            material: None,
            done: Vec::new(),
            surface: Surface::default(),
            known: HashMap::new(),
            uvs: Vec::new(),
        }
    }

    /// Closes the open part, if it has any face.
    fn close(&mut self) {
        if self.surface.triangles.is_empty() {
            return;
        }
        self.known.clear();
        let mut surface = std::mem::take(&mut self.surface);
        let uvs = std::mem::take(&mut self.uvs);
        let n = surface.positions.len();
        // A part has UVs only if all of its vertices have them; normals likewise.
        if uvs.len() == n {
            let corners = surface.triangles.iter();
            surface.uvs = corners.map(|t| t.map(|i| uvs[i as usize])).collect();
        }
        if surface.normals.len() != n {
            surface.normals.clear();
        }
        let part = (self.name.clone(), self.material, surface);
        self.done.push(part);
    }

    /// Adds the face of these words; an error tells what is wrong with it.
    fn face(&mut self, words: &str) -> Result<(), String> {
        let mut corners: Vec<u32> = Vec::new();
        for word in words.split_whitespace() {
            let Some(numbers) = self.numbers(word) else {
                return Err("names a vertex that is not there; repair the face".into());
            };
            corners.push(self.vertex(numbers));
        }
        if corners.len() < 3 {
            let message =
                "is a face of fewer than 3 vertices; is the file cut off? Export the mesh again";
            return Err(message.into());
        }
        let positions = &self.surface.positions;
        let position = |&i: &u32| positions[i as usize].as_dvec3();
        let polygon: Vec<DVec3> = corners.iter().map(position).collect();
        let cut = self.triangulator.triangulate(&polygon)?;
        let cut = cut.into_iter().map(|t| t.map(|k| corners[k]));
        self.surface.triangles.extend(cut);
        Ok(())
    }

    /// The numbers, from 0, of the position, the UV and the normal that a word such as `1/2/3` names. Those of a list that is empty are none.
    fn numbers(&self, word: &str) -> Option<[Option<usize>; 3]> {
        let all = self.all;
        let counts = [all.positions.len(), all.uvs.len(), all.normals.len()];
        let mut numbers = [None; 3];
        for (k, part) in word.split('/').enumerate() {
            if part.is_empty() {
                continue;
            }
            let (count, read) = (*counts.get(k)?, self.read[k]);
            let number: i64 = part.parse().ok()?;
            if k > 0 && (number == 0 || count == 0) {
                continue;
            }
            let base = if number < 0 { read as i64 } else { -1 };
            let number = usize::try_from(base.checked_add(number)?).ok()?;
            numbers[k] = Some(number).filter(|n| *n < count);
            numbers[k]?;
        }
        numbers[0].map(|_| numbers)
    }

    /// The number in the open part of a vertex of the file.
    fn vertex(&mut self, numbers: [Option<usize>; 3]) -> u32 {
        let surface = &mut self.surface;
        *self.known.entry(numbers).or_insert_with(|| {
            let [position, uv, normal] = numbers;
            let position = position.unwrap_or_default();
            surface.positions.push(self.all.positions[position]);
            surface.colors.extend(self.all.colors.get(position));
            self.uvs.extend(uv.map(|i| self.all.uvs[i]));
            surface.normals.extend(normal.map(|i| self.all.normals[i]));
            surface.positions.len() as u32 - 1
        })
    }
}
