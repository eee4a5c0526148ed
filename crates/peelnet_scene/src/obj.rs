//! Wavefront OBJ and MTL files, through `tobj`.
//!
//! The parser's errors have no line numbers, it takes NaN for a number, panics on a short colour, and cuts every polygon
//! as a fan. A first walk over the text checks what a user can get wrong — numbers, indices, faces, colours — and names
//! the line; polygons are cut into triangles in the text; then the parser does the rest.

mod images;

use crate::{Lighting, Material, Mesh, Part, SceneError, mesh::Corners, polygons};
use glam::{DVec3, Vec2, Vec3};
use images::{Images, drawn_as};
use std::{
    cell::RefCell,
    collections::{BTreeSet, HashMap},
    fs,
    path::{Path, PathBuf},
};

/// A mesh file's contents.
#[derive(Clone, Debug)]
pub struct LoadedObj {
    /// The mesh.
    pub mesh: Mesh,
    /// What was missing or mended.
    pub warnings: Vec<String>,
    /// Every file that was read, the OBJ first.
    pub files: Vec<PathBuf>,
}

/// Reads an OBJ file and the MTL files it names.
///
/// Polygons are triangulated, missing or unusable normals computed, degenerate triangles left out with a warning. A
/// missing MTL, or a name that no MTL has, is a warning and a default material.
///
/// # Errors
/// A file that cannot be read, is empty or cut off, or holds numbers or indices that make no sense: with its line.
pub fn load_obj(path: &Path, lighting: Lighting) -> Result<LoadedObj, SceneError> {
    let (text, told) = read_text(path)?;
    let text = plain(&text);
    let facts = check(path, &text)?;
    let text = triangulated(&text);
    let mut warnings: Vec<String> = told.into_iter().collect();
    let missing = RefCell::new(Vec::new());
    let bad_library = RefCell::new(None);
    let images = RefCell::new(Images::default());
    let files = RefCell::new(vec![path.to_owned()]);
    let folder = path.parent().unwrap_or(Path::new("."));
    let options = tobj::LoadOptions {
        triangulate: true,
        single_index: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let (models, materials) = tobj::load_obj_buf(&mut text.as_bytes(), &options, |name| {
        let file = folder.join(name);
        // Whatever is wrong, the parser goes on with an empty library, and we tell afterwards.
        let empty = Ok((Vec::new(), Default::default()));
        match read_text(&file) {
            Ok((text, told)) => {
                missing.borrow_mut().extend(told);
                let text = plain(&text);
                files.borrow_mut().push(file.clone());
                match check_library(&file, &text) {
                    Ok(warnings) => {
                        missing.borrow_mut().extend(warnings);
                        images.borrow_mut().list(&file, &text);
                        tobj::load_mtl_buf(&mut text.as_bytes())
                    }
                    Err(e) => {
                        bad_library.borrow_mut().get_or_insert(e);
                        empty
                    }
                }
            }
            Err(SceneError::Read { source, .. }) => {
                missing.borrow_mut().push(format!(
                    "{}: cannot read material file {} ({source}); default material used",
                    path.display(),
                    file.display()
                ));
                empty
            }
            Err(e) => {
                bad_library.borrow_mut().get_or_insert(e);
                empty
            }
        }
    })
    .map_err(|e| SceneError::Mesh {
        path: path.to_owned(),
        line: None,
        message: format!("{e}; export the mesh again"),
    })?;
    if let Some(e) = bad_library.into_inner() {
        return Err(e);
    }
    let unreadable = missing.borrow().iter().any(|w| w.contains("cannot read"));
    warnings.extend(missing.into_inner());
    let materials = materials.map_err(|e| SceneError::Mesh {
        path: path.to_owned(),
        line: None,
        message: format!(
            "its material file cannot be used: {e}; mend the MTL or remove the mtllib line"
        ),
    })?;
    let known: BTreeSet<&str> = materials.iter().map(|m| m.name.as_str()).collect();
    if !unreadable {
        for name in facts
            .materials
            .iter()
            .filter(|n| !known.contains(n.as_str()))
        {
            warnings.push(format!(
                "{}: no material '{name}' in its MTL files; default material used",
                path.display()
            ));
        }
    }
    let mut images = images.into_inner();
    let finished: Vec<Material> = materials
        .iter()
        .map(|m| images.put_on(m, material(m, lighting)))
        .collect();
    warnings.append(&mut images.warnings);
    files.borrow_mut().append(&mut images.files);
    let mut mesh = Mesh::empty();
    let mut bad_places = 0usize;
    let (mut degenerate, mut bad_normals) = (0usize, 0usize);
    let areas = area_sums(&models);
    for model in &models {
        let m = &model.mesh;
        let vectors =
            |flat: &[f32]| -> Vec<Vec3> { flat.chunks_exact(3).map(Vec3::from_slice).collect() };
        let positions = vectors(&m.positions);
        let mut triangles = Vec::with_capacity(m.indices.len() / 3);
        for t in m.indices.chunks_exact(3) {
            let t = [t[0], t[1], t[2]];
            let [a, b, c] = t.map(|i| positions[i as usize]);
            // Exactly zero, not small: a sliver is a triangle.
            if (b - a).cross(c - a) == Vec3::ZERO {
                degenerate += 1;
            } else {
                triangles.push(t);
            }
        }
        let smooth: Vec<Vec3> = positions
            .iter()
            .map(|p| {
                areas
                    .get(&place(*p))
                    .map_or(Vec3::Z, |n| n.normalize_or(Vec3::Z))
            })
            .collect();
        let given = vectors(&m.normals);
        let normals: Vec<Vec3> = if given.len() == positions.len() {
            given
                .iter()
                .zip(&smooth)
                .map(|(n, s)| {
                    n.try_normalize().unwrap_or_else(|| {
                        bad_normals += 1;
                        *s
                    })
                })
                .collect()
        } else {
            smooth
        };
        if triangles.is_empty() {
            continue;
        }
        let uvs: Vec<Vec2> = m
            .texcoords
            .chunks_exact(2)
            .map(|uv| {
                let uv = Vec2::new(uv[0], 1.0 - uv[1]);
                bad_places += usize::from(!uv.is_finite());
                if uv.is_finite() { uv } else { Vec2::ZERO }
            })
            .collect();
        let colors: Vec<[f32; 4]> = m
            .vertex_color
            .chunks_exact(3)
            .map(|c| {
                [
                    c[0].clamp(0.0, 1.0),
                    c[1].clamp(0.0, 1.0),
                    c[2].clamp(0.0, 1.0),
                    1.0,
                ]
            })
            .collect();
        let n = positions.len();
        let corners = Corners {
            uvs: (uvs.len() == n).then_some(uvs),
            colors: (colors.len() == n).then_some(colors),
            positions,
            normals,
            triangles,
        };
        let part = Part {
            name: model.name.clone(),
            triangles: 0..0,
            material: m
                .material_id
                .and_then(|i| finished.get(i).cloned())
                .unwrap_or_else(|| Material::default_with(lighting)),
        };
        if let Some(lost) = mesh.push(corners, part) {
            warnings.push(format!("{}: {lost}", path.display()));
        }
    }
    if bad_places > 0 {
        warnings.push(format!(
            "{}: {bad_places} texture coordinates were not finite and are taken as 0",
            path.display()
        ));
    }
    if degenerate > 0 {
        warnings.push(format!(
            "{}: {degenerate} triangles without area left out",
            path.display()
        ));
    }
    if bad_normals > 0 {
        warnings.push(format!(
            "{}: {bad_normals} normals were zero and were computed from the triangles",
            path.display()
        ));
    }
    if mesh.triangles.is_empty() {
        return Err(SceneError::Mesh {
            path: path.to_owned(),
            line: None,
            message: "holds no triangle with an area; export the mesh again".into(),
        });
    }
    Ok(LoadedObj {
        mesh,
        warnings,
        files: files.into_inner(),
    })
}

/// A file's text, and what was noticed: UTF-8, or Latin-1 as old exporters write it.
fn read_text(path: &Path) -> Result<(String, Option<String>), SceneError> {
    let bytes = fs::read(path).map_err(|source| SceneError::Read {
        path: path.to_owned(),
        source,
    })?;
    // Old systems end lines with a carriage return alone, which the parser takes for a blank.
    let lines = |text: String| text.replace("\r\n", "\n").replace('\r', "\n");
    let e = match String::from_utf8(bytes) {
        Ok(text) => return Ok((lines(text), None)),
        Err(e) => e,
    };
    let good = e.utf8_error().valid_up_to();
    let bytes = e.into_bytes();
    let line = 1 + bytes[..good].iter().filter(|&&b| b == b'\n').count();
    // No text has these: it is UTF-16, or no text at all.
    if bytes.contains(&0) {
        return Err(SceneError::Mesh {
            path: path.to_owned(),
            line: Some(line),
            message: "is not UTF-8 text; is it an OBJ file? Save it as plain text".into(),
        });
    }
    let told = format!(
        "{}:{line}: is not UTF-8 and is read as Latin-1; save it as UTF-8 where names look wrong",
        path.display()
    );
    Ok((
        lines(bytes.into_iter().map(char::from).collect()),
        Some(told),
    ))
}

/// The text without comments and with continued lines joined; every line keeps its number.
fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut owed = 0;
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or("").trim();
        if let Some(start) = line.strip_suffix('\\') {
            out.push_str(start);
            out.push(' ');
            owed += 1;
        } else {
            // The parser splits some lines at blanks only.
            out.extend(line.chars().map(|c| if c == '\t' { ' ' } else { c }));
            out.extend(std::iter::repeat_n('\n', owed + 1));
            owed = 0;
        }
    }
    out
}

/// The text with every polygon cut into triangles. [`check`] has passed, so indices are in range.
fn triangulated(text: &str) -> String {
    let mut positions: Vec<DVec3> = Vec::new();
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        if words.next() == Some("v") {
            let mut number = || words.next().and_then(|w| w.parse().ok()).unwrap_or(0.0);
            positions.push(DVec3::new(number(), number(), number()));
        }
    }
    let numbers = |line: &str| line.split_ascii_whitespace().count() - 1;
    let is_position = |line: &str| line.starts_with("v ");
    // The parser wants a colour for every position or for none.
    let colored = text.lines().any(|l| is_position(l) && numbers(l) == 6);
    let mut out = String::with_capacity(text.len());
    let mut seen = 0i64;
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        let key = words.next();
        seen += i64::from(key == Some("v"));
        let corners: Vec<&str> = words.collect();
        if key == Some("f") && corners.len() > 3 {
            let places: Vec<DVec3> = corners
                .iter()
                .map(|c| {
                    let index: i64 = c
                        .split('/')
                        .next()
                        .and_then(|w| w.parse().ok())
                        .unwrap_or(1);
                    let index = if index < 0 { seen + index } else { index - 1 };
                    positions.get(index as usize).copied().unwrap_or_default()
                })
                .collect();
            for [a, b, c] in polygons::triangulate(&places) {
                out.push_str(&format!("f {} {} {}\n", corners[a], corners[b], corners[c]));
            }
        } else {
            out.push_str(line);
            // A name is missing: no material of that name, and not the parser's refusal.
            if line.trim() == "usemtl" {
                out.push_str(" none");
            }
            if colored && is_position(line) && numbers(line) == 3 {
                out.push_str(" 1 1 1");
            }
            out.push('\n');
        }
    }
    out
}

/// A position as a key; −0 and 0 are one place.
fn place(p: Vec3) -> [u32; 3] {
    p.to_array().map(|x| (x + 0.0).to_bits())
}

/// The sum of the adjacent triangles' area vectors at every place of the file: groups and texture seams split corners,
/// but not the surface.
fn area_sums(models: &[tobj::Model]) -> HashMap<[u32; 3], Vec3> {
    let mut sums: HashMap<[u32; 3], Vec3> = HashMap::new();
    for model in models {
        let m = &model.mesh;
        for t in m.indices.chunks_exact(3) {
            let [a, b, c] =
                [t[0], t[1], t[2]].map(|i| Vec3::from_slice(&m.positions[3 * i as usize..]));
            let area = (b - a).cross(c - a);
            for p in [a, b, c] {
                *sums.entry(place(p)).or_default() += area;
            }
        }
    }
    sums
}

/// Checks an MTL's numbers, line by line; returns warnings about what is not drawn.
fn check_library(path: &Path, text: &str) -> Result<Vec<String>, SceneError> {
    let mut textures = BTreeSet::new();
    for (i, line) in text.lines().enumerate() {
        let mut words = line.split_ascii_whitespace();
        let Some(key) = words.next() else { continue };
        let wanted = match key {
            "Ka" | "Kd" | "Ks" | "Ke" => 3,
            "d" | "Tr" | "Ns" | "Ni" => 1,
            _ => {
                let is_image = key.starts_with("map_") || matches!(key, "disp" | "decal" | "refl");
                if is_image && drawn_as(key).is_none() {
                    textures.insert(key.to_owned());
                }
                continue;
            }
        };
        let fail = |message: String| SceneError::Mesh {
            path: path.to_owned(),
            line: Some(i + 1),
            message: format!("{message}; repair the line"),
        };
        let numbers: Vec<f32> = words.map_while(|w| w.parse().ok()).collect();
        if numbers.len() < wanted {
            return Err(fail(format!(
                "'{key}' needs {wanted} numbers, not '{line}'"
            )));
        }
        if numbers.iter().any(|x| !x.is_finite()) {
            return Err(fail(format!("'{line}' is not finite")));
        }
        if matches!(key, "d" | "Tr") && !(0.0..=1.0).contains(&numbers[0]) {
            return Err(fail(format!("{key} {} must lie in 0 … 1", numbers[0])));
        }
    }
    Ok(if textures.is_empty() {
        Vec::new()
    } else {
        let names: Vec<_> = textures.into_iter().collect();
        vec![format!(
            "{}: not drawn: {}",
            path.display(),
            names.join(", ")
        )]
    })
}

struct Facts {
    /// Names after `usemtl`.
    materials: BTreeSet<String>,
}

/// Checks numbers, faces and indices, line by line.
fn check(path: &Path, text: &str) -> Result<Facts, SceneError> {
    let fail = |line: usize, message: String| SceneError::Mesh {
        path: path.to_owned(),
        line: Some(line),
        message,
    };
    // Positive indices may point ahead, so the totals come first.
    let total = |key: &str| {
        text.lines()
            .filter(|l| l.split_ascii_whitespace().next() == Some(key))
            .count() as i64
    };
    let totals = [total("v"), total("vt"), total("vn")];
    let mut seen = [0i64; 3];
    let mut faces = 0;
    let mut materials = BTreeSet::new();
    for (i, line) in text.lines().enumerate() {
        let number = i + 1;
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some(key @ ("v" | "vt" | "vn")) => {
                let kind = ["v", "vt", "vn"]
                    .iter()
                    .position(|&k| k == key)
                    .unwrap_or(0);
                seen[kind] += 1;
                if key == "vt" {
                    continue;
                }
                let values: Vec<&str> = words.collect();
                if values.len() < 3 {
                    return Err(fail(
                        number,
                        format!(
                            "'{key}' has {} numbers instead of 3; is the file cut off?",
                            values.len()
                        ),
                    ));
                }
                // Behind a position's three numbers stand its w, or a colour.
                for word in &values {
                    match word.parse::<f32>() {
                        Ok(x) if x.is_finite() => {}
                        Ok(_) => {
                            let what = if key == "v" { "position" } else { "normal" };
                            return Err(fail(
                                number,
                                format!(
                                    "{what} '{word}' is not finite; repair the mesh and export it again"
                                ),
                            ));
                        }
                        Err(_) => {
                            return Err(fail(
                                number,
                                format!("'{word}' is not a number; repair the line"),
                            ));
                        }
                    }
                }
                let number_at = |k: usize| values[k].parse::<f32>().unwrap_or(0.0);
                let at_infinity = |w: f32| (0..3).any(|k| !(number_at(k) / w).is_finite());
                if key == "v" && values.len() == 4 && at_infinity(number_at(3)) {
                    let message = format!(
                        "a position with w = {} lies at infinity; repair the line",
                        values[3]
                    );
                    return Err(fail(number, message));
                }
            }
            Some("f") => {
                faces += 1;
                let corners: Vec<&str> = words.collect();
                if corners.len() < 3 {
                    return Err(fail(
                        number,
                        format!("a face of {} corners; is the file cut off?", corners.len()),
                    ));
                }
                for corner in corners {
                    for (kind, word) in corner.split('/').enumerate() {
                        if word.is_empty() && kind == 1 {
                            continue;
                        }
                        let index: i64 = word.parse().map_err(|_| {
                            fail(
                                number,
                                format!("'{corner}' is not an index; repair the line"),
                            )
                        })?;
                        let names = ["vertices", "texture coordinates", "normals"];
                        let valid = kind < 3
                            && ((1..=totals[kind]).contains(&index)
                                || (-seen[kind]..0).contains(&index));
                        if !valid {
                            return Err(fail(
                                number,
                                format!(
                                    "index {index} points at none of the {} {}; repair the face",
                                    totals.get(kind).copied().unwrap_or(0),
                                    names.get(kind).unwrap_or(&"fields of a corner")
                                ),
                            ));
                        }
                    }
                }
            }
            Some("usemtl") => {
                materials.insert(words.collect::<Vec<_>>().join(" "));
            }
            _ => {}
        }
    }
    if faces == 0 {
        return Err(SceneError::Mesh {
            path: path.to_owned(),
            line: None,
            message: "holds no faces; is the file empty or cut off?".into(),
        });
    }
    Ok(Facts { materials })
}

fn material(m: &tobj::Material, lighting: Lighting) -> Material {
    let default = Material::default_with(lighting);
    // `Tr` is the opposite of `d`; the parser leaves it to us.
    let transparency = m
        .unknown_param
        .get("Tr")
        .and_then(|t| t.trim().parse::<f32>().ok());
    let alpha = m
        .dissolve
        .or(transparency.map(|t| 1.0 - t))
        .unwrap_or(default.alpha);
    // The extension of MTL for physically based shading (Exocortex 2013).
    let factor = |key: &str| {
        let value: Option<f32> = m.unknown_param.get(key).and_then(|t| t.trim().parse().ok());
        value.filter(|x| x.is_finite()).map(|x| x.clamp(0.0, 1.0))
    };
    let (roughness, metallic) = (factor("Pr"), factor("Pm"));
    let is_pbr = lighting != Lighting::Unlit && (roughness.is_some() || metallic.is_some());
    let emission = m.emissive.unwrap_or(default.emission);
    let emission = emission.map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 });
    Material {
        name: m.name.clone(),
        lighting: if is_pbr { Lighting::Pbr } else { lighting },
        metallic: metallic.unwrap_or(default.metallic),
        roughness: roughness.unwrap_or(default.roughness),
        emission,
        color: m.diffuse.unwrap_or(default.color),
        alpha: if alpha.is_finite() {
            alpha.clamp(0.0, 1.0)
        } else {
            1.0
        },
        specular: m
            .specular
            .map_or(default.specular, |s| (s[0] + s[1] + s[2]) / 3.0),
        shininess: m.shininess.unwrap_or(default.shininess).max(1.0),
        ..default
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(files: &[(&str, &[u8])]) -> Result<LoadedObj, SceneError> {
        let folder = tempfile::tempdir().expect("temporary folder");
        for (name, bytes) in files {
            fs::write(folder.path().join(name), bytes).expect("writes");
        }
        load_obj(&folder.path().join(files[0].0), Lighting::Unlit)
    }

    const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn polygons_negative_indices_groups_and_materials() {
        let obj = format!(
            "mtllib a.mtl\n{QUAD}g left\nusemtl glass\nf 1 2 3 4\ng right\nusemtl fog\nf -4 -3 -2\n"
        );
        let mtl = b"newmtl glass\nKd 0.25 0.5 1\nd 0.3\nnewmtl fog\nKd 1 1 1\nTr 0.9\n";
        let loaded = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl)]).expect("loads");
        let m = &loaded.mesh;
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        assert_eq!(loaded.files.len(), 2);
        assert_eq!(m.triangles.len(), 3);
        assert_eq!(m.parts.len(), 2);
        assert_eq!(
            (m.parts[0].name.as_str(), m.parts[0].material.alpha),
            ("left", 0.3)
        );
        assert_eq!(m.parts[0].material.color, [0.25, 0.5, 1.0]);
        assert!((m.parts[1].material.alpha - 0.1).abs() < 1e-6);
        assert!(m.normals.iter().all(|n| *n == Vec3::Z));
    }

    /// An L-shaped face (concave), comments behind data, a continued line, and a texture that is not there.
    #[test]
    fn what_exporters_write() {
        let obj = "mtllib\ta.mtl # library\nv 0 0 0 # origin\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nusemtl\tbrass\nf 1 2 3 \\\n4 5 6\n";
        let mtl = b"newmtl brass\nKd 1 0 0 # red\nmap_Kd brass.png\n";
        let loaded = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl)]).expect("loads");
        let m = &loaded.mesh;
        let area: f32 = m
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| m.positions[i as usize]);
                (b - a).cross(c - a).z / 2.0
            })
            .sum();
        assert_eq!((m.triangles.len(), area), (4, 3.0));
        assert_eq!(m.parts[0].material.color, [1.0, 0.0, 0.0]);
        assert_eq!(loaded.warnings.len(), 1);
        assert!(
            loaded.warnings[0].contains("brass.png"),
            "{:?}",
            loaded.warnings
        );
    }

    #[test]
    fn bad_materials_name_their_line() {
        let obj = format!("mtllib a.mtl\n{QUAD}usemtl m\nf 1 2 3\n");
        for (mtl, expected) in [
            ("newmtl m\nKd 1 0\n", "a.mtl:2: 'Kd' needs 3 numbers"),
            ("newmtl m\nd nan\n", "a.mtl:2: 'd nan' is not finite"),
            ("newmtl m\n\nTr 1.5\n", "a.mtl:3: Tr 1.5 must lie in 0 … 1"),
        ] {
            let e = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())]).expect_err(mtl);
            assert!(e.to_string().contains(expected), "{e}");
        }
    }

    /// Corners that a texture seam splits keep one normal: the surface is smooth there.
    #[test]
    fn physically_based_values_and_emission() {
        let mtl = b"newmtl m\nKd 1 0 0\nPr 0.3\nPm 0.8\nKe 2 0 1\n";
        let obj = format!("mtllib a.mtl\n{QUAD}usemtl m\nf 1 2 3\n");
        let loaded = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl)]).expect("loads");
        let m = &loaded.mesh.parts[0].material;
        assert_eq!(
            (m.roughness, m.metallic, m.emission),
            (0.3, 0.8, [2.0, 0.0, 1.0])
        );
        // Unlit scenes stay unlit; these tests load so, or with Phong.
        assert_ne!(m.lighting, Lighting::Phong);
    }

    #[test]
    fn seams_do_not_split_normals() {
        let obj =
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 4/2 2/2\n";
        let loaded = load(&[("a.obj", obj.as_bytes())]).expect("loads");
        let m = &loaded.mesh;
        let at_origin: Vec<Vec3> = (0..m.positions.len())
            .filter(|&i| m.positions[i] == Vec3::ZERO)
            .map(|i| m.normals[i])
            .collect();
        assert_eq!(at_origin.len(), 2);
        assert_eq!(at_origin[0], at_origin[1]);
    }

    /// Images of all kinds, options, an opacity of its own, heights as normals, colours of corners, Latin-1; what is not drawn is told.
    #[test]
    fn images_of_materials() {
        let picture = |texels: [[u8; 4]; 2]| {
            let mut bytes = std::io::Cursor::new(Vec::new());
            let image = image::RgbaImage::from_raw(2, 1, texels.concat()).expect("two texels");
            let done = image.write_to(&mut bytes, image::ImageFormat::Png);
            done.map(|()| bytes.into_inner()).expect("encodes")
        };
        let color = picture([[200, 0, 0, 9], [0, 100, 0, 9]]);
        let leaf = picture([[0, 0, 0, 255], [255, 255, 255, 255]]);
        let mtl = b"newmtl m\nKd 1 1 1\nmap_Kd -clamp on a b.png\nmap_d leaf.png\nmap_Bump -bm 2 -s 2 2 leaf.png\nmap_Pr leaf.png\nmap_Ke a b.png\nmap_Ks gone.png\n# caf\xe9\n";
        let obj = "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n";
        let files: [(&str, &[u8]); 4] = [
            ("a.obj", obj.as_bytes()),
            ("a.mtl", mtl),
            ("a b.png", &color),
            ("leaf.png", &leaf),
        ];
        let loaded = load(&files).expect("loads");
        let mesh = &loaded.mesh;
        let m = &mesh.parts[0].material;
        // Opacity comes of map_d alone, whatever the colour's file holds.
        let color = m.maps.color.as_ref().expect("a map");
        assert_eq!(color.texels, [[200, 0, 0, 0], [0, 100, 0, 255]]);
        assert!(m.blend && m.maps.wrap == [crate::Wrap::Clamp; 2]);
        assert_eq!(m.maps.normal.as_ref().map(|n| n.size), Some([2, 1]));
        let values = m.maps.metallic_roughness.as_ref().expect("a map");
        assert_eq!((values.texels[1], m.roughness), ([255, 255, 255, 255], 1.0));
        assert_eq!(m.emission, [1.0; 3]);
        // v runs down.
        assert_eq!(mesh.uvs[0][2], Vec2::new(1.0, 0.0));
        assert_eq!(
            mesh.colors[..3],
            [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [1.0; 4]]
        );
        let told = loaded.warnings.join("\n");
        for word in ["option -s of map_Bump", "map_Ks", "Latin-1"] {
            assert!(told.contains(word), "{word}: {told}");
        }
        assert_eq!(
            (loaded.warnings.len(), loaded.files.len()),
            (3, 4),
            "{told}"
        );
    }

    #[test]
    fn a_missing_mtl_is_survived() {
        let obj = format!("mtllib gone.mtl\n{QUAD}usemtl glass\nf 1 2 3 4\n");
        let loaded = load(&[("a.obj", obj.as_bytes())]).expect("loads");
        assert_eq!(loaded.warnings.len(), 1);
        assert!(
            loaded.warnings[0].contains("gone.mtl"),
            "{:?}",
            loaded.warnings
        );
        assert_eq!(loaded.mesh.parts[0].material.color, [0.8; 3]);
    }

    #[test]
    fn bad_normals_are_computed_and_flat_triangles_left_out() {
        let obj =
            format!("{QUAD}vn 0 0 0\nvn 0 0 -0\nvn 0 0 -2\nf 1//1 2//2 3//3\nf 1//1 1//1 2//2\n");
        let loaded = load(&[("a.obj", obj.as_bytes())]).expect("loads");
        assert_eq!(loaded.mesh.triangles.len(), 1);
        assert_eq!(loaded.warnings.len(), 2, "{:?}", loaded.warnings);
        for n in &loaded.mesh.normals {
            assert!((n.length() - 1.0).abs() < 1e-6);
        }
    }

    /// Each bad file gives one error that names the file, the line and the mend.
    #[test]
    fn bad_files() {
        let cases: [(&str, Vec<u8>, &str); 11] = [
            (
                "NaN position",
                b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(),
                "a.obj:2: position 'nan'",
            ),
            (
                "NaN normal",
                format!("{QUAD}vn 0 nan 0\nf 1//1 2//1 3//1\n").into_bytes(),
                "a.obj:5: normal 'nan'",
            ),
            (
                "NaN w",
                b"v 0 0 0\nv 1 0 0 nan\nv 0 1 0\nf 1 2 3\n".to_vec(),
                "a.obj:2: position 'nan'",
            ),
            (
                "tiny w",
                b"v 0 0 0\nv 1 0 0 1e-42\nv 0 1 0\nf 1 2 3\n".to_vec(),
                "a.obj:2: a position with w = 1e-42",
            ),
            (
                "word",
                b"v 0 zero 0\nf 1 1 1\n".to_vec(),
                "a.obj:1: 'zero' is not a number",
            ),
            (
                "beyond",
                format!("{QUAD}f 1 2 5\n").into_bytes(),
                "a.obj:5: index 5 points at none of the 4 vertices",
            ),
            (
                "zero",
                format!("{QUAD}f 0 1 2\n").into_bytes(),
                "a.obj:5: index 0",
            ),
            (
                "too far back",
                format!("{QUAD}f -1 -2 -5\n").into_bytes(),
                "a.obj:5: index -5",
            ),
            ("empty", Vec::new(), "a.obj: holds no faces"),
            (
                "cut off",
                format!("{QUAD}f 1 2").into_bytes(),
                "a.obj:5: a face of 2 corners",
            ),
            (
                "UTF-16",
                vec![b'v', 0, b'\n', 0, 0xff, 0xfe],
                "a.obj:2: is not UTF-8",
            ),
        ];
        for (name, bytes, expected) in cases {
            let e = load(&[("a.obj", &bytes)]).expect_err(name).to_string();
            assert!(e.contains(expected), "{name}: {e}");
            assert!(
                e.contains("repair") || e.contains('?'),
                "{name} names no mend: {e}"
            );
        }
        assert!(matches!(
            load_obj(Path::new("no/such.obj"), Lighting::Unlit),
            Err(SceneError::Read { .. })
        ));
    }
}
