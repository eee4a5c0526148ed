//! MTL files: material libraries, read by `tobj` behind a check.

use super::{obj::statements, textures::drawn_as};
use crate::{
    error::{SceneError, shown},
    files::{Files, MAX_TEXT},
    material::{Lighting, Material},
    texture::Texture,
    warnings::Warnings,
};
use peelnet_core::files::{MAX_SHOWN, printable};
use std::{
    collections::{HashMap, HashSet},
    fmt::Write,
    path::{Path, PathBuf},
    sync::Arc,
};

/// The material libraries of an OBJ file.
pub(super) struct Libraries<'a, 'f> {
    /// The OBJ file.
    path: &'a Path,
    pub files: &'a mut Files<'f>,
    /// Textures by their files; `None` for those that cannot be drawn.
    pub textures: HashMap<String, Option<Arc<Texture>>>,
    /// Numbers of materials by their names, for each library.
    numbers: HashMap<String, HashMap<String, usize>>,
    materials: Vec<Material>,
    /// Whether a library is missing.
    is_incomplete: bool,
}

/// Opacity and its complement differ by so much where a file rounds both to two digits.
const ROUNDED: f32 = 0.011;

impl<'a, 'f> Libraries<'a, 'f> {
    pub fn new(path: &'a Path, files: &'a mut Files<'f>) -> Self {
        Self {
            path,
            files,
            textures: HashMap::new(),
            numbers: HashMap::new(),
            materials: Vec::new(),
            is_incomplete: false,
        }
    }

    fn file(&self, name: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(name)
    }

    /// The numbers of a library's materials.
    pub fn names(&self, name: &Path) -> HashMap<String, usize> {
        let numbers = self.numbers.get(&self.files.identity(&self.file(name)));
        numbers.cloned().unwrap_or_default()
    }

    /// Reads a library and its textures; returns whether it is a new one. One that is missing is a warning.
    ///
    /// # Errors
    /// A value that makes no sense, with its line.
    pub fn load(&mut self, name: &str) -> Result<bool, SceneError> {
        let file = self.file(Path::new(name));
        // Names of one file are many.
        let key = self.files.identity(&file);
        if self.numbers.contains_key(&key) {
            return Ok(false);
        }
        let files = &mut *self.files;
        let bytes = match files.read(&file, MAX_TEXT) {
            Err(SceneError::Read { source, .. }) => {
                self.is_incomplete = true;
                files.warnings.about(
                    format!("{}: cannot read material file ", shown(self.path)),
                    &shown(&file),
                    format!(" ({source}); default material used"),
                );
                self.numbers.insert(key, HashMap::new());
                return Ok(true);
            }
            bytes => bytes?,
        };
        let (lighting, warnings) = (files.lighting, &mut files.warnings);
        let text = check(&file, &statements(&file, &bytes, warnings)?, warnings)?;
        let (materials, mut numbers) = tobj::load_mtl_buf(&mut text.as_bytes())
            .map_err(|e| SceneError::file(&file, None, format!("{e}; repair it")))?;
        let first = self.materials.len();
        numbers.values_mut().for_each(|number| *number += first);
        for m in &materials {
            if let (Some(d), Some(tr)) = (m.dissolve, number(m, "Tr"))
                && (d + tr - 1.0).abs() > ROUNDED
            {
                let before = format!("{}: d is drawn and not Tr, which disagrees: ", shown(&file));
                self.files.warnings.about(before, &printable(&m.name), "");
            }
            let colors = [m.diffuse, m.specular].into_iter().flatten().flatten();
            let finish = ["Pr", "Pm"].into_iter().filter_map(|key| number(m, key));
            let mut shares = colors.chain(finish);
            let is_dark = m.emissive.is_some_and(|e| e.iter().any(|x| *x < 0.0));
            if is_dark || shares.any(|x| !(0.0..=1.0).contains(&x)) {
                self.files.warnings.clamped(&file, &m.name);
            }
            let material = self.put_on(&file, m, material(m, lighting));
            self.materials.push(material);
        }
        self.numbers.insert(key, numbers);
        Ok(true)
    }

    /// All materials. Names among those that the file uses which no library has are a warning.
    pub fn finish<'n>(self, named: impl Iterator<Item = &'n str>) -> Vec<Material> {
        let mut known = HashSet::new();
        for m in &self.materials {
            if !known.insert(&*m.name) {
                let before = format!("{}: materials of one name: ", shown(self.path));
                let warnings = &mut self.files.warnings;
                warnings.about(before, &printable(&m.name), "; the last is drawn");
            }
        }
        for name in named.filter(|name| !self.is_incomplete && !known.contains(name)) {
            self.files.warnings.about(
                format!("{}: no material ", shown(self.path)),
                &format!("'{}'", printable(name)),
                " in its MTL files; default material used",
            );
        }
        self.materials
    }
}

/// Refuses, with its line, what `tobj` would misread or panic on. The text that is left has colours of three numbers, and none of the
/// statements that are not drawn.
fn check(path: &Path, text: &str, warnings: &mut Warnings) -> Result<String, SceneError> {
    let mut out = String::with_capacity(text.len());
    for (line, number) in text.lines().zip(1..) {
        let (key, rest) = line.split_once(' ').unwrap_or((line, ""));
        let fault = |what: &str| {
            let message = format!("'{}' {what}; repair it", printable(line));
            SceneError::file(path, Some(number), message)
        };
        match key {
            "Kd" | "Ks" | "Ke" | "d" | "Tr" | "Ns" | "Pr" | "Pm" => {
                let halo = rest.strip_prefix("-halo ");
                if halo.is_some() {
                    warnings.not_drawn(path, "-halo (opacity is the same all over a surface)");
                }
                let words = halo.unwrap_or(rest).split_whitespace().take(3);
                let numbers: Vec<f32> =
                    words.map(|word| word.parse().unwrap_or(f32::NAN)).collect();
                if numbers.is_empty() || !numbers.iter().all(|x| x.is_finite()) {
                    return Err(fault("holds no finite number"));
                }
                let [r, g, b] = match numbers[..] {
                    [r, g, b] => [r, g, b],
                    [_, _] if key.starts_with('K') => return Err(fault("needs 1 or 3 numbers")),
                    _ => [numbers[0]; 3],
                };
                if matches!(key, "d" | "Tr") && !(0.0..=1.0).contains(&r) {
                    return Err(fault("must lie in 0 … 1"));
                }
                let _ = write!(out, "{key} {r} {g} {b}");
            }
            // tobj refuses a material without a name.
            "newmtl" if rest.len() > MAX_SHOWN => {
                return Err(fault("has a name of more than 200 bytes"));
            }
            "newmtl" if rest.is_empty() => out += "newmtl unnamed",
            // Not read, and tobj would refuse what makes no sense there.
            "Ka" | "Ni" | "illum" => {}
            _ if drawn_as(key).is_some() && rest.is_empty() => {
                warnings.add(format!("{}: {key} names no file", shown(path)));
            }
            // A filter that lets everything through.
            "Tf" if rest.split_whitespace().all(|word| word.parse() == Ok(1.0)) => {}
            "" | "newmtl" => out += line,
            _ if drawn_as(key).is_some() => out += line,
            _ => warnings.not_drawn(path, key),
        }
        out.push('\n');
    }
    Ok(out)
}

/// The first number of a statement that `tobj` does not know.
fn number(m: &tobj::Material, key: &str) -> Option<f32> {
    let word = m.unknown_param.get(key)?.split_whitespace().next()?;
    word.parse().ok().filter(|x: &f32| x.is_finite())
}

/// A material without its textures.
fn material(m: &tobj::Material, lighting: Lighting) -> Material {
    let default = Material::default_with(lighting);
    // The extension of MTL for physically based shading (Exocortex 2013).
    let [roughness, metallic] = ["Pr", "Pm"].map(|key| number(m, key).map(|x| x.clamp(0.0, 1.0)));
    let is_pbr = lighting != Lighting::Unlit && (roughness.is_some() || metallic.is_some());
    let [color, specular] =
        [m.diffuse, m.specular].map(|c| c.map(|c| c.map(|x| x.clamp(0.0, 1.0))));
    let transparency = number(m, "Tr");
    let alpha = m.dissolve.or(transparency.map(|x| 1.0 - x));
    Material {
        name: m.name.clone(),
        lighting: if is_pbr { Lighting::Pbr } else { lighting },
        metallic: metallic.unwrap_or(default.metallic),
        roughness: roughness.unwrap_or(default.roughness),
        emission: m.emissive.unwrap_or(default.emission).map(|c| c.max(0.0)),
        color: color.unwrap_or(default.color),
        alpha: alpha.unwrap_or(default.alpha),
        // Exporters mean no highlight by an exponent of 0, which would be one over the whole hemisphere.
        specular: match (m.shininess, specular) {
            (Some(exponent), _) if exponent <= 0.0 => 0.0,
            (_, Some([r, g, b])) => (r + g + b) / 3.0,
            (_, None) => default.specular,
        },
        shininess: m.shininess.unwrap_or(default.shininess).max(1.0),
        ..default
    }
}
