//! The images that MTL files name.

use crate::{Lighting, Maps, Material, Texture, Wrap};
use std::{
    collections::{BTreeMap, HashMap},
    path::{Path, PathBuf},
    sync::Arc,
};

/// What an image of an MTL file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Use {
    Color,
    Alpha,
    /// A height field, or normals where it is not grey.
    Bump,
    Normal,
    Roughness,
    Metallic,
    Emission,
}

pub(super) fn drawn_as(key: &str) -> Option<Use> {
    Some(match key {
        "map_Kd" => Use::Color,
        "map_d" => Use::Alpha,
        "map_Bump" | "map_bump" | "bump" => Use::Bump,
        "norm" | "map_Norm" | "map_Kn" => Use::Normal,
        "map_Pr" => Use::Roughness,
        "map_Pm" => Use::Metallic,
        "map_Ke" => Use::Emission,
        _ => return None,
    })
}

/// A statement such as `map_Bump -bm 0.5 -clamp on bricks.png`.
#[derive(Clone, Debug)]
struct Statement {
    file: PathBuf,
    /// Multiplies heights.
    strength: f32,
    clamp: bool,
}

/// The images that MTL files name, read once each.
#[derive(Default)]
pub(super) struct Images {
    of: HashMap<String, BTreeMap<Use, Statement>>,
    read: HashMap<PathBuf, Option<Arc<Texture>>>,
    pub warnings: Vec<String>,
    pub files: Vec<PathBuf>,
}

impl Images {
    /// Lists the images of an MTL's materials; the last statement of a kind counts.
    pub fn list(&mut self, library: &Path, text: &str) {
        let folder = library.parent().unwrap_or(Path::new("."));
        let mut material = String::new();
        for line in text.lines() {
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let Some((&key, mut rest)) = words.split_first() else {
                continue;
            };
            if key == "newmtl" {
                material = rest.join(" ");
            }
            let Some(kind) = drawn_as(key) else { continue };
            let mut statement = Statement {
                file: PathBuf::new(),
                strength: 1.0,
                clamp: false,
            };
            while let Some((option, after)) = rest.split_first()
                && option.starts_with('-')
            {
                let is_number = |w: &&&str| w.parse::<f32>().is_ok();
                let taken = match *option {
                    "-o" | "-s" | "-t" => after.iter().take(3).take_while(is_number).count(),
                    "-mm" => 2,
                    _ => 1,
                };
                match (*option, after.first()) {
                    ("-bm", Some(value)) => statement.strength = value.parse().unwrap_or(1.0),
                    ("-clamp", Some(value)) => statement.clamp = *value == "on",
                    _ => self.warnings.push(format!(
                        "{}: option {option} of {key} is not drawn",
                        library.display()
                    )),
                }
                rest = &after[taken.min(after.len())..];
            }
            if rest.is_empty() {
                self.warnings
                    .push(format!("{}: {key} names no file", library.display()));
                continue;
            }
            // Written on Windows, read anywhere.
            statement.file = folder.join(rest.join(" ").replace('\\', "/"));
            let all = self.of.entry(material.clone()).or_default();
            all.insert(kind, statement);
        }
    }

    /// An image; `None`, and a warning, where it cannot be drawn.
    fn image(&mut self, file: &Path) -> Option<Arc<Texture>> {
        if let Some(known) = self.read.get(file) {
            return known.clone();
        }
        let image = match Texture::load(file) {
            Ok(texture) => {
                self.files.push(file.to_owned());
                Some(Arc::new(texture))
            }
            Err(e) => {
                self.warnings.push(format!("{e}; drawn without it"));
                None
            }
        };
        self.read.insert(file.to_owned(), image.clone());
        image
    }

    /// A material with its images.
    pub fn put_on(&mut self, m: &tobj::Material, mut material: Material) -> Material {
        let Some(statements) = self.of.get(&m.name).cloned() else {
            return material;
        };
        let mut found: BTreeMap<Use, Arc<Texture>> = BTreeMap::new();
        for (kind, statement) in &statements {
            if let Some(image) = self.image(&statement.file) {
                found.insert(*kind, image);
            }
        }
        let mut maps = Maps::NONE;
        if statements.values().any(|s| s.clamp) {
            maps.wrap = [Wrap::Clamp; 2];
        }
        let opaque = |t: [u8; 4]| [t[0], t[1], t[2], 255];
        let of_alpha = |image: &Texture| {
            let by_alpha = image.has_alpha();
            move |t: [u8; 4]| if by_alpha { t[3] } else { t[0] }
        };
        maps.color = match (found.get(&Use::Color), found.get(&Use::Alpha)) {
            (None, None) => None,
            // Opacity is what `map_d` says, and nothing else.
            (Some(color), None) if !color.has_alpha() => Some(Arc::clone(color)),
            (Some(color), None) => Some(Arc::new(Texture::joined(color, color, |t, _| opaque(t)))),
            (None, Some(alpha)) => {
                let value = of_alpha(alpha);
                Some(Arc::new(Texture::joined(alpha, alpha, |t, _| {
                    [255, 255, 255, value(t)]
                })))
            }
            (Some(color), Some(alpha)) => {
                let value = of_alpha(alpha);
                let join = |c: [u8; 4], a| [c[0], c[1], c[2], value(a)];
                Some(Arc::new(Texture::joined(color, alpha, join)))
            }
        };
        if found.contains_key(&Use::Alpha) {
            material.blend = true;
        }
        let heights = |image: &Texture, strength: f32| {
            // A rise of white over black by an eightieth of the image's width.
            Arc::new(image.normals_of_heights(strength * image.size[0] as f32 / 80.0))
        };
        maps.normal = match (found.get(&Use::Normal), found.get(&Use::Bump)) {
            (Some(normals), _) => Some(Arc::clone(normals)),
            (None, Some(bump)) if bump.is_grey() => {
                Some(heights(bump, statements[&Use::Bump].strength))
            }
            (None, bump) => bump.cloned(),
        };
        let is_pbr = material.lighting != Lighting::Unlit;
        let of_key = |key: &str| m.unknown_param.contains_key(key);
        let white = Texture::of("white", [1, 1], |_, _| [255; 4]);
        let rough = found.get(&Use::Roughness);
        let metal = found.get(&Use::Metallic);
        if rough.is_some() || metal.is_some() {
            let values = Texture::joined(
                rough.map_or(&white, |t| t.as_ref()),
                metal.map_or(&white, |t| t.as_ref()),
                |rough, metal| [255, rough[0], metal[0], 255],
            );
            maps.metallic_roughness = Some(Arc::new(values));
            material.lighting = if is_pbr {
                Lighting::Pbr
            } else {
                material.lighting
            };
            if rough.is_some() && !of_key("Pr") {
                material.roughness = 1.0;
            }
            if metal.is_some() && !of_key("Pm") {
                material.metallic = 1.0;
            }
        }
        maps.emissive = found.get(&Use::Emission).cloned();
        if maps.emissive.is_some() && m.emissive.is_none() {
            material.emission = [1.0; 3];
        }
        Material { maps, ..material }
    }
}
