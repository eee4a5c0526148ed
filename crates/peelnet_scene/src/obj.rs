//! Wavefront OBJ and MTL files, read by `tobj`.
//!
//! `tobj` is the only parser. What it lacks is added around it: encodings, comments and continued lines before it (`text`), the few
//! statements that it would misread (`repair`), and behind it checks of the values that it returns, polygons cut into triangles
//! (`polygons`), and the line of an error (`fault`).

mod fault;
mod library;
mod repair;
#[cfg(test)]
mod tests;
mod text;
mod textures;

use crate::{
    error::{SceneError, shown},
    files::{FileKind, Files},
    material::{Lighting, Material},
    mesh::{Mesh, NO_UVS, Part, PartGeometry, key_of},
    polygons::Triangulator,
    warnings::Warnings,
};
use glam::{DVec3, Vec2, Vec3};
use peelnet_files::printable;
use std::{
    cell::RefCell,
    collections::{HashMap, HashSet},
    io,
    path::{Path, PathBuf},
};
use textures::Textures;

/// A mesh file's contents.
#[derive(Clone, Debug)]
pub struct LoadedObj {
    /// The mesh.
    pub mesh: Mesh,
    /// What is missing or was repaired.
    pub warnings: Vec<String>,
    /// Every file that was read, the OBJ first.
    pub files: Vec<PathBuf>,
}

/// Reads an OBJ file and the MTL files and textures that it names.
///
/// Polygons are triangulated, missing or unusable normals computed, degenerate triangles left out with a warning. A
/// missing MTL, or a name that no MTL has, is a warning and a default material.
///
/// # Errors
/// A file that cannot be read, is empty or cut off, or holds numbers or indices that make no sense: with its line.
pub fn load_obj(path: &Path, lighting: Lighting) -> Result<LoadedObj, SceneError> {
    load(path, lighting, &mut Files::new(&peelnet_files::read))
}

/// The same with a function that reads files: from an archive, or from memory.
///
/// # Errors
/// See [`load_obj`].
pub fn load_obj_from(
    path: &Path,
    lighting: Lighting,
    read: impl Fn(&Path) -> io::Result<Vec<u8>>,
) -> Result<LoadedObj, SceneError> {
    load(path, lighting, &mut Files::new(&|path, _| read(path)))
}

fn warnings_of(first: Option<String>) -> Warnings {
    let mut warnings = Warnings::default();
    if let Some(first) = first {
        warnings.add(first);
    }
    warnings
}

/// Whether a position or normal is written with other letters than those of an exponent, as `nan` and `inf` are.
fn is_not_numeric(line: &str) -> bool {
    let numbers = line.strip_prefix("v ").or_else(|| line.strip_prefix("vn "));
    let is_word = |b: u8| b.is_ascii_alphabetic() && !b.eq_ignore_ascii_case(&b'e');
    numbers.is_some_and(|n| n.bytes().any(is_word))
}

/// Reads an OBJ file.
pub(crate) fn load(
    path: &Path,
    lighting: Lighting,
    files: &mut Files<'_>,
) -> Result<LoadedObj, SceneError> {
    let fail = |line: Option<usize>, message: String| SceneError::Mesh {
        path: path.to_owned(),
        line,
        message,
    };
    let first = files.used().len();
    let bytes = files.read(path, FileKind::Mesh)?;
    files.record(path, &bytes);
    let (text, warning) = text::decode(path, &bytes)?;
    let text = text::statements(&text);
    // Of a bad file, the first line that is wrong.
    let bad = |(line, message): (usize, String)| {
        let (line, message) = fault::first(&text).unwrap_or((line, message));
        fail(Some(line), message)
    };
    let repaired = repair::repaired(&text).map_err(bad)?;
    let options = tobj::LoadOptions {
        single_index: true,
        // Points and lines are kept only to be refused: faces that were cut off.
        ..tobj::LoadOptions::default()
    };
    let libraries = RefCell::new(Libraries {
        path,
        files,
        read: HashSet::new(),
        owners: Vec::new(),
        warnings: warnings_of(warning),
        is_incomplete: false,
        error: None,
    });
    let mut unread = repaired.text.as_bytes();
    let loaded = tobj::load_obj_buf(&mut unread, &options, |name| {
        libraries.borrow_mut().load(name)
    });
    let libraries = libraries.into_inner();
    let (models, materials) = loaded.map_err(|e| {
        let line = text::last_line(&repaired.text, unread);
        bad((line, format!("{e}; export the mesh again")))
    })?;
    if let Some(e) = libraries.error {
        return Err(e);
    }
    if !models.iter().all(|m| is_sound(&m.mesh)) {
        let message = "a number is not finite, or a face has fewer than 3 vertices";
        return Err(bad((1, format!("{message}; export the mesh again"))));
    }
    // tobj drops what no face uses, but a file with such a number is damaged.
    if text.lines().any(is_not_numeric) {
        let message = "a number is not finite; repair the mesh and export it again";
        return Err(bad((1, message.into())));
    }
    if models.iter().all(|m| m.mesh.indices.is_empty()) {
        let message = "holds no faces; is the file empty or cut off?";
        return Err(fail(None, message.into()));
    }
    let materials = materials.unwrap_or_default();
    let mut warnings = libraries.warnings;
    if !libraries.is_incomplete {
        let known: HashSet<&str> = materials.iter().map(|m| m.name.as_str()).collect();
        let all = repaired.materials.iter();
        for name in all.filter(|name| !known.contains(name.as_str())) {
            warnings.about(
                format!("{}: no material ", shown(path)),
                &format!("'{}'", printable(name)),
                " in its MTL files; default material used",
            );
        }
    }
    let mut textures = Textures::new(&mut warnings);
    let materials: Vec<Material> = materials
        .iter()
        .zip(&libraries.owners)
        .map(|(m, owner)| {
            textures.put_on(libraries.files, owner, m, library::material(m, lighting))
        })
        .collect();
    let material = |model: &tobj::Model| {
        let id = model.mesh.material_id;
        id.and_then(|i| materials.get(i).cloned())
            .unwrap_or_else(|| Material::default_with(lighting))
    };
    let mesh = assemble(&models, material, &shown(path), &mut warnings);
    if mesh.triangles.is_empty() {
        let message = "holds no triangle with an area; export the mesh again";
        return Err(fail(None, message.into()));
    }
    Ok(LoadedObj {
        mesh,
        warnings: warnings.texts(),
        files: libraries.files.used()[first..].to_vec(),
    })
}

/// The material libraries of an OBJ file, read as `tobj` meets their names.
struct Libraries<'a, 'f> {
    /// The OBJ file.
    path: &'a Path,
    files: &'a mut Files<'f>,
    /// Those read so far: naming one again adds nothing, and tobj asks for it all the same.
    read: HashSet<PathBuf>,
    /// The library of each material, in `tobj`'s order.
    owners: Vec<PathBuf>,
    warnings: Warnings,
    /// Whether a library is missing.
    is_incomplete: bool,
    /// The first error. `tobj` continues after an error of a library, and its own errors hold no message.
    error: Option<SceneError>,
}

impl Libraries<'_, '_> {
    fn load(&mut self, name: &Path) -> tobj::MTLLoadResult {
        self.read(name).map_err(|e| {
            self.error.get_or_insert(e);
            tobj::LoadError::ReadError
        })
    }

    fn read(&mut self, name: &Path) -> Result<library::Library, SceneError> {
        let file = self.path.parent().unwrap_or(Path::new(".")).join(name);
        if !self.read.insert(file.clone()) {
            return Ok(library::Library::default());
        }
        let bytes = match self.files.read(&file, FileKind::Materials) {
            Err(SceneError::Read { source, .. }) => {
                self.is_incomplete = true;
                self.warnings.about(
                    format!("{}: cannot read material file ", shown(self.path)),
                    &shown(&file),
                    format!(" ({source}); default material used"),
                );
                return Ok(library::Library::default());
            }
            bytes => bytes?,
        };
        self.files.record(&file, &bytes);
        let (text, warning) = text::decode(&file, &bytes)?;
        if let Some(warning) = warning {
            self.warnings.add(warning);
        }
        let library = library::read(&file, &text::statements(&text), &mut self.warnings)?;
        for name in library::not_drawn(&library.0) {
            let before = format!("{}: not drawn: ", shown(&file));
            self.warnings.about(before, &printable(name), "");
        }
        let owners = std::iter::repeat_n(file, library.0.len());
        self.owners.extend(owners);
        Ok(library)
    }
}

/// Whether a mesh has finite numbers, and faces of three vertices or more.
fn is_sound(mesh: &tobj::Mesh) -> bool {
    let numbers = [&mesh.positions, &mesh.normals, &mesh.vertex_color];
    mesh.face_arities.iter().all(|n| *n >= 3)
        && numbers.into_iter().flatten().all(|x| x.is_finite())
}

/// The mesh of all models of a file.
fn assemble(
    models: &[tobj::Model],
    material: impl Fn(&tobj::Model) -> Material,
    file: &str,
    warnings: &mut Warnings,
) -> Mesh {
    let mut triangulator = Triangulator::new();
    let triangles: Vec<Vec<[u32; 3]>> = models
        .iter()
        .map(|model| triangles(&model.mesh, &mut triangulator))
        .collect();
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
    mesh
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
fn triangles(mesh: &tobj::Mesh, triangulator: &mut Triangulator) -> Vec<[u32; 3]> {
    // tobj lists no arities where all faces are triangles.
    if mesh.face_arities.is_empty() {
        let triangles = mesh.indices.chunks_exact(3);
        return triangles.map(|t| [t[0], t[1], t[2]]).collect();
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
        let cut = triangulator.triangulate(&vertices);
        triangles.extend(cut.into_iter().map(|t| t.map(|i| face[i])));
    }
    triangles
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
