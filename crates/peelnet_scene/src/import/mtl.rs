//! MTL files: material libraries, read by `tobj`.

use super::{obj::statements, textures::drawn_as};
use crate::{
    error::{SceneError, shown},
    files::{FileKind, Files},
    material::{Lighting, Material},
    warnings::Warnings,
};
use peelnet_files::printable;
use std::{
    collections::{BTreeSet, HashMap, HashSet},
    path::{Path, PathBuf},
};

/// A material library as `tobj` returns it: materials, and their numbers by name.
type Library = (Vec<tobj::Material>, HashMap<String, usize>);

/// The material libraries of an OBJ file, read as `tobj` meets their names.
pub(super) struct Libraries<'a, 'f> {
    /// The OBJ file.
    path: &'a Path,
    pub files: &'a mut Files<'f>,
    /// Those read so far: naming one again adds nothing, and tobj asks for it all the same.
    read: HashSet<PathBuf>,
    /// The library of each material, in `tobj`'s order.
    pub owners: Vec<PathBuf>,
    pub warnings: Warnings,
    /// Whether a library is missing.
    pub is_incomplete: bool,
    /// The first error. `tobj` continues after an error of a library, and its own errors hold no message.
    pub error: Option<SceneError>,
}

impl<'a, 'f> Libraries<'a, 'f> {
    pub fn new(path: &'a Path, files: &'a mut Files<'f>, warnings: Warnings) -> Self {
        Self {
            path,
            files,
            read: HashSet::new(),
            owners: Vec::new(),
            warnings,
            is_incomplete: false,
            error: None,
        }
    }

    pub fn load(&mut self, name: &Path) -> tobj::MTLLoadResult {
        self.read(name).map_err(|e| {
            self.error.get_or_insert(e);
            tobj::LoadError::ReadError
        })
    }

    fn read(&mut self, name: &Path) -> Result<Library, SceneError> {
        let file = self.path.parent().unwrap_or(Path::new("")).join(name);
        if !self.read.insert(file.clone()) {
            return Ok(Library::default());
        }
        let bytes = match self.files.read(&file, FileKind::Materials) {
            Err(SceneError::Read { source, .. }) => {
                self.is_incomplete = true;
                self.warnings.about(
                    format!("{}: cannot read material file ", shown(self.path)),
                    &shown(&file),
                    format!(" ({source}); default material used"),
                );
                return Ok(Library::default());
            }
            bytes => bytes?,
        };
        self.files.record(&file, &bytes);
        let text = statements(&file, &bytes, &mut self.warnings)?;
        let library = parse(&file, &text, &mut self.warnings)?;
        for name in not_drawn(&library.0) {
            let before = format!("{}: not drawn: ", shown(&file));
            self.warnings.about(before, &printable(name), "");
        }
        let owners = std::iter::repeat_n(file, library.0.len());
        self.owners.extend(owners);
        Ok(library)
    }
}

/// Reads a library.
///
/// # Errors
/// A statement that cannot be read, with its line, or a material whose numbers make no sense, with its name.
fn parse(path: &Path, text: &str, warnings: &mut Warnings) -> Result<Library, SceneError> {
    let fail = |line: Option<usize>, message: String| SceneError::Mesh {
        path: path.to_owned(),
        line,
        message: format!("{message}; repair it"),
    };
    // What tobj does not read, or panics on: colours of one number, which are grey, or of two, and the opacity of a halo.
    let mut rewritten = String::with_capacity(text.len());
    for (line, number) in text.lines().zip(1..) {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            [key @ ("Ka" | "Kd" | "Ks" | "Ke"), grey] => {
                rewritten += &format!("{key} {grey} {grey} {grey}");
            }
            ["Ka" | "Kd" | "Ks" | "Ke"] | ["Ka" | "Kd" | "Ks" | "Ke", _, _] => {
                let message = format!("'{}' needs 1 or 3 numbers", printable(line));
                return Err(fail(Some(number), message));
            }
            ["d", "-halo", factor] => {
                rewritten += &format!("d {factor}");
                let message = "-halo (opacity is the same all over a surface)";
                warnings.add(format!("{}: not drawn: {message}", shown(path)));
            }
            _ => rewritten += line,
        }
        rewritten.push('\n');
    }
    let mut unread = rewritten.as_bytes();
    let loaded = tobj::load_mtl_buf(&mut unread);
    let mut library = loaded.map_err(|_| {
        // It stops reading where it fails.
        let read = &rewritten.as_bytes()[..rewritten.len() - unread.len()];
        let line = read.iter().filter(|&&b| b == b'\n').count().max(1);
        let shown = printable(text.lines().nth(line - 1).unwrap_or_default());
        fail(Some(line), format!("'{shown}' cannot be read"))
    })?;
    for m in &mut library.0 {
        if let Some(what) = fault(m) {
            let name = printable(&m.name);
            return Err(fail(None, format!("material '{name}': {what}")));
        }
        for color in [&mut m.diffuse, &mut m.specular].into_iter().flatten() {
            if color.iter().any(|x| *x > 1.0) {
                let name = format!("'{}'", printable(&m.name));
                let before = format!("{}: colours above 1 are taken as 1: ", shown(path));
                warnings.about(before, &name, "");
            }
            *color = color.map(|x| x.clamp(0.0, 1.0));
        }
    }
    Ok(library)
}

/// What makes no sense of a material's values.
fn fault(m: &tobj::Material) -> Option<&'static str> {
    let transparency = transparency(m);
    if matches!(transparency, Some(Err(()))) {
        return Some("Tr is not a number");
    }
    let colors = [m.ambient, m.diffuse, m.specular, m.emissive];
    let opacities = [m.dissolve, transparency.and_then(Result::ok)];
    let numbers = [m.shininess, m.optical_density];
    let all = colors.iter().flatten().flatten();
    let mut all = all.chain(opacities.iter().chain(&numbers).flatten());
    if !all.all(|x| x.is_finite()) {
        return Some("a number is not finite");
    }
    let mut opacities = opacities.iter().flatten();
    (!opacities.all(|x| (0.0..=1.0).contains(x))).then_some("d and Tr must lie in 0 … 1")
}

/// `Tr`, the opposite of `d`, which `tobj` leaves as text.
fn transparency(m: &tobj::Material) -> Option<Result<f32, ()>> {
    let text = m.unknown_param.get("Tr")?;
    let word = text.split_whitespace().next().unwrap_or_default();
    Some(word.parse().map_err(|_| ()))
}

/// Statements of textures that are read and not drawn.
fn not_drawn(materials: &[tobj::Material]) -> BTreeSet<&str> {
    let mut found = BTreeSet::new();
    for m in materials {
        for (key, texture) in [
            ("map_Ka", &m.ambient_texture),
            ("map_Ks", &m.specular_texture),
            ("map_Ns", &m.shininess_texture),
        ] {
            found.extend(texture.as_ref().map(|_| key));
        }
        let others = m.unknown_param.keys().map(String::as_str);
        found.extend(others.filter(|key| {
            let is_texture = key.starts_with("map_") || matches!(*key, "disp" | "decal" | "refl");
            is_texture && drawn_as(key).is_none()
        }));
    }
    found
}

/// A material without its textures.
pub(super) fn material(m: &tobj::Material, lighting: Lighting) -> Material {
    let default = Material::default_with(lighting);
    let transparency = transparency(m).and_then(Result::ok);
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
    Material {
        name: m.name.clone(),
        lighting: if is_pbr { Lighting::Pbr } else { lighting },
        metallic: metallic.unwrap_or(default.metallic),
        roughness: roughness.unwrap_or(default.roughness),
        emission: emission.map(|c| c.max(0.0)),
        color: m.diffuse.unwrap_or(default.color),
        alpha: alpha.clamp(0.0, 1.0),
        // Exporters mean no highlight by an exponent of 0, which would be one over the whole hemisphere.
        specular: match (m.shininess, m.specular) {
            (Some(exponent), _) if exponent <= 0.0 => 0.0,
            (_, Some([r, g, b])) => (r + g + b) / 3.0,
            (_, None) => default.specular,
        },
        shininess: m.shininess.unwrap_or(default.shininess).max(1.0),
        ..default
    }
}
