//! MTL files: material libraries.

use super::{
    obj::statements,
    textures::{Textures, drawn_as},
};
use crate::{
    error::{SceneError, shown},
    files::{FileKind, Files},
    material::{Lighting, Material},
    warnings::Warnings,
};
use peelnet_files::printable;
use std::{
    collections::{HashMap, HashSet},
    path::{Path, PathBuf},
    sync::Arc,
};

/// A line of a library.
pub(super) struct Statement {
    /// From 1.
    line: usize,
    pub key: String,
    /// What follows the key.
    pub rest: String,
}

/// A material of a library.
pub(super) struct Entry {
    /// The library.
    pub path: Arc<Path>,
    pub statements: Vec<Statement>,
    /// Its values, without textures.
    pub material: Material,
}

/// The material libraries of an OBJ file.
pub(super) struct Libraries<'a, 'f> {
    /// The OBJ file.
    path: &'a Path,
    lighting: Lighting,
    files: &'a mut Files<'f>,
    /// Those read so far: naming one again adds nothing.
    read: HashSet<PathBuf>,
    entries: Vec<Entry>,
    /// The last material of each name.
    numbers: HashMap<String, usize>,
    /// Names that no material had when they were met.
    unknown: Vec<String>,
    warnings: Warnings,
    /// Whether a library is missing.
    is_incomplete: bool,
}

impl<'a, 'f> Libraries<'a, 'f> {
    pub fn new(
        path: &'a Path,
        lighting: Lighting,
        files: &'a mut Files<'f>,
        warnings: Warnings,
    ) -> Self {
        Self {
            path,
            lighting,
            files,
            read: HashSet::new(),
            entries: Vec::new(),
            numbers: HashMap::new(),
            unknown: Vec::new(),
            warnings,
            is_incomplete: false,
        }
    }

    /// The number of the material of a name.
    pub fn find(&mut self, name: &str) -> Option<usize> {
        let number = self.numbers.get(name).copied();
        if number.is_none() {
            self.unknown.push(name.to_owned());
        }
        number
    }

    /// Reads a library. One that is missing is a warning.
    ///
    /// # Errors
    /// A value that makes no sense, with its line.
    pub fn load(&mut self, name: &str) -> Result<(), SceneError> {
        let file = self.path.parent().unwrap_or(Path::new("")).join(name);
        if !self.read.insert(file.clone()) {
            return Ok(());
        }
        let bytes = match self.files.read(&file, FileKind::Materials) {
            Err(SceneError::Read { source, .. }) => {
                self.is_incomplete = true;
                self.warnings.about(
                    format!("{}: cannot read material file ", shown(self.path)),
                    &shown(&file),
                    format!(" ({source}); default material used"),
                );
                return Ok(());
            }
            bytes => bytes?,
        };
        self.files.record(&file, &bytes);
        let text = statements(&file, &bytes, &mut self.warnings)?;
        let path: Arc<Path> = file.into();
        let first = self.entries.len();
        for (line, number) in text.lines().zip(1..) {
            let (key, rest) = line.split_once(' ').unwrap_or((line, ""));
            if key == "newmtl" {
                self.numbers.insert(rest.to_owned(), self.entries.len());
                self.entries.push(Entry {
                    path: Arc::clone(&path),
                    statements: Vec::new(),
                    material: Material {
                        name: rest.to_owned(),
                        ..Material::default_with(self.lighting)
                    },
                });
            } else if let Some(entry) = self.entries[first..].last_mut() {
                entry.statements.push(Statement {
                    line: number,
                    key: key.to_owned(),
                    rest: rest.trim().to_owned(),
                });
            }
        }
        for entry in &mut self.entries[first..] {
            entry.material = entry.values(self.lighting, &mut self.warnings)?;
        }
        Ok(())
    }

    /// All materials with their textures, and all warnings.
    pub fn materials(mut self) -> (Vec<Material>, Warnings) {
        if !self.is_incomplete {
            let is_unknown = |name: &&String| !self.numbers.contains_key(*name);
            for name in self.unknown.iter().filter(is_unknown) {
                self.warnings.about(
                    format!("{}: no material ", shown(self.path)),
                    &format!("'{}'", printable(name)),
                    " in its MTL files; default material used",
                );
            }
        }
        let mut textures = Textures::new(self.files, &mut self.warnings);
        let entries = self.entries.iter();
        let materials = entries.map(|entry| textures.put_on(entry)).collect();
        (materials, self.warnings)
    }
}

impl Entry {
    pub fn has(&self, key: &str) -> bool {
        self.statement(key).is_some()
    }

    /// The last statement of a key.
    fn statement(&self, key: &str) -> Option<&Statement> {
        self.statements.iter().rfind(|s| s.key == key)
    }

    /// The first three numbers of a key's statement; none without it.
    fn numbers(&self, key: &str) -> Result<Vec<f32>, SceneError> {
        let Some(Statement { rest, .. }) = self.statement(key) else {
            return Ok(Vec::new());
        };
        // The opacity of a halo is drawn all over the surface.
        let rest = rest.strip_prefix("-halo ").unwrap_or(rest);
        let words = rest.split_whitespace().take(3).map(str::parse);
        match words.collect::<Result<Vec<f32>, _>>() {
            Ok(numbers) if !numbers.is_empty() && numbers.iter().all(|x| x.is_finite()) => {
                Ok(numbers)
            }
            _ => Err(self.fail(key, "holds no finite number")),
        }
    }

    fn fail(&self, key: &str, what: &str) -> SceneError {
        let statement = self.statement(key);
        let (line, rest) = statement.map_or((0, ""), |s| (s.line, &s.rest));
        let message = format!("'{key} {}' {what}; repair it", printable(rest));
        SceneError::file(&self.path, Some(line), message)
    }

    fn number(&self, key: &str) -> Result<Option<f32>, SceneError> {
        Ok(self.numbers(key)?.first().copied())
    }

    fn opacity(&self, key: &str) -> Result<Option<f32>, SceneError> {
        match self.number(key)? {
            Some(x) if !(0.0..=1.0).contains(&x) => Err(self.fail(key, "must lie in 0 … 1")),
            x => Ok(x),
        }
    }

    /// A colour, of which one number is grey.
    fn color(&self, key: &str) -> Result<Option<[f32; 3]>, SceneError> {
        match self.numbers(key)?[..] {
            [] => Ok(None),
            [grey] => Ok(Some([grey; 3])),
            [r, g, b] => Ok(Some([r, g, b])),
            _ => Err(self.fail(key, "needs 1 or 3 numbers")),
        }
    }

    /// The material without its textures.
    fn values(&self, lighting: Lighting, warnings: &mut Warnings) -> Result<Material, SceneError> {
        let default = Material::default_with(lighting);
        let reflecting = [self.color("Kd")?, self.color("Ks")?];
        if reflecting.iter().flatten().flatten().any(|x| *x > 1.0) {
            let name = format!("'{}'", printable(&self.material.name));
            let before = format!("{}: colours above 1 are taken as 1: ", shown(&self.path));
            warnings.about(before, &name, "");
        }
        let reflecting = reflecting.map(|c| c.map(|c| c.map(|x| x.clamp(0.0, 1.0))));
        let [color, specular] = reflecting;
        let before = format!("{}: not drawn: ", shown(&self.path));
        let halo = self.statement("d").filter(|s| s.rest.starts_with("-halo"));
        if halo.is_some() {
            let message = "-halo (opacity is the same all over a surface)";
            warnings.add(format!("{before}{message}"));
        }
        for key in self.statements.iter().map(|s| &*s.key) {
            let is_texture = key.starts_with("map_") || matches!(key, "disp" | "decal" | "refl");
            if is_texture && drawn_as(key).is_none() {
                warnings.about(before.as_str(), &printable(key), "");
            }
        }
        let alpha = match (self.opacity("d")?, self.opacity("Tr")?) {
            (None, Some(transparency)) => 1.0 - transparency,
            (alpha, _) => alpha.unwrap_or(default.alpha),
        };
        // The extension of MTL for physically based shading (Exocortex 2013).
        let factor = |key: &str| {
            let value = self.number(key).ok().flatten();
            value.map(|x| x.clamp(0.0, 1.0))
        };
        let (roughness, metallic) = (factor("Pr"), factor("Pm"));
        let is_pbr = lighting != Lighting::Unlit && (roughness.is_some() || metallic.is_some());
        let emission = self.color("Ke")?.unwrap_or(default.emission);
        let shininess = self.number("Ns")?;
        Ok(Material {
            name: self.material.name.clone(),
            lighting: if is_pbr { Lighting::Pbr } else { lighting },
            metallic: metallic.unwrap_or(default.metallic),
            roughness: roughness.unwrap_or(default.roughness),
            emission: emission.map(|c| c.max(0.0)),
            color: color.unwrap_or(default.color),
            alpha,
            // Exporters mean no highlight by an exponent of 0, which would be one over the whole hemisphere.
            specular: match (shininess, specular) {
                (Some(exponent), _) if exponent <= 0.0 => 0.0,
                (_, Some([r, g, b])) => (r + g + b) / 3.0,
                (_, None) => default.specular,
            },
            shininess: shininess.unwrap_or(default.shininess).max(1.0),
            ..default
        })
    }
}
