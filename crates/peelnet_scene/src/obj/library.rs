//! MTL files: material libraries.

use super::text;
use crate::{
    error::{SceneError, shown},
    material::{Lighting, Material},
    warnings::Warnings,
};
use peelnet_files::printable;
use std::{collections::BTreeSet, path::Path};

/// A material library as `tobj` returns it: materials, and their numbers by name.
pub(super) type Library = (
    Vec<tobj::Material>,
    std::collections::HashMap<String, usize>,
);

/// Reads a library.
///
/// # Errors
/// A statement that cannot be read, or whose numbers make no sense, with its line.
pub(super) fn read(
    path: &Path,
    text: &str,
    warnings: &mut Warnings,
) -> Result<Library, SceneError> {
    let fail = |line: usize, message: String| SceneError::Mesh {
        path: path.to_owned(),
        line: Some(line),
        message: format!("{message}; repair the line"),
    };
    // tobj panics on a colour of fewer than three numbers, so these lines must not reach it.
    let short = text.lines().position(is_short_color);
    if let Some(i) = short {
        return Err(fail(i + 1, unreadable(line_at(text, i))));
    }
    let repaired = repaired(text);
    if repaired.has_halo {
        warnings.add(format!(
            "{}: not drawn: -halo (opacity is the same all over a surface)",
            shown(path)
        ));
    }
    let mut unread = repaired.text.as_bytes();
    let mut library = match tobj::load_mtl_buf(&mut unread) {
        Ok(library) => library,
        Err(_) => {
            let line = text::last_line(&repaired.text, unread);
            return Err(fail(line, unreadable(line_at(text, line - 1))));
        }
    };
    if library.0.iter().any(|m| fault(m).is_some()) {
        // tobj does not say on which line a value was: its parser, on a line alone, does.
        for (i, line) in repaired.text.lines().enumerate() {
            let alone = tobj::load_mtl_buf(&mut format!("newmtl x\n{line}").as_bytes());
            let materials = alone.map(|(materials, _)| materials).unwrap_or_default();
            if let Some(fault) = materials.iter().find_map(fault) {
                return Err(fail(i + 1, fault.message(line)));
            }
        }
    }
    for m in &mut library.0 {
        let bright = [m.diffuse, m.specular]
            .iter()
            .flatten()
            .flatten()
            .any(|x| *x > 1.0);
        if bright {
            let name = format!("'{}'", printable(&m.name));
            let before = format!("{}: colours above 1 are taken as 1: ", shown(path));
            warnings.about(before, &name, "");
        }
        for color in [&mut m.diffuse, &mut m.specular].into_iter().flatten() {
            *color = color.map(|x| x.clamp(0.0, 1.0));
        }
    }
    Ok(library)
}

/// A library's text that `tobj` reads right.
struct Repaired {
    text: String,
    has_halo: bool,
}

/// Rewrites what `tobj` does not read, line by line: colours of one number, which are grey, and the opacity of a halo.
fn repaired(text: &str) -> Repaired {
    let mut out = String::with_capacity(text.len());
    let mut has_halo = false;
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let all = (words.next(), words.next(), words.next(), words.next());
        match all {
            (Some(key @ ("Ka" | "Kd" | "Ks" | "Ke")), Some(grey), None, None) => {
                out.push_str(&format!("{key} {grey} {grey} {grey}"));
            }
            (Some("d"), Some("-halo"), Some(factor), None) => {
                has_halo = true;
                out.push_str(&format!("d {factor}"));
            }
            _ => out.push_str(line),
        }
        out.push('\n');
    }
    Repaired {
        text: out,
        has_halo,
    }
}

fn line_at(text: &str, index: usize) -> &str {
    text.lines().nth(index).unwrap_or_default()
}

fn is_short_color(line: &str) -> bool {
    let mut words = line.split_whitespace();
    let is_color = matches!(words.next(), Some("Ka" | "Kd" | "Ks" | "Ke"));
    is_color && matches!(words.count(), 0 | 2)
}

/// The message for a line that `tobj` cannot read.
fn unreadable(line: &str) -> String {
    match line.split_whitespace().next() {
        Some(key @ ("Ka" | "Kd" | "Ks" | "Ke")) => {
            format!("'{key}' needs 1 or 3 numbers, not '{}'", printable(line))
        }
        Some(key @ ("d" | "Ns" | "Ni" | "illum")) => {
            format!("'{key}' needs a number, not '{}'", printable(line))
        }
        Some("newmtl") => "a material needs a name".into(),
        _ => format!("'{}' cannot be read", printable(line)),
    }
}

/// What is wrong with a value.
#[derive(Clone, Copy)]
enum Fault {
    NotANumber,
    NotFinite,
    OutOfRange,
}

impl Fault {
    fn message(self, line: &str) -> String {
        let line = printable(line);
        match self {
            Self::NotANumber => format!("'{line}' holds no number"),
            Self::NotFinite => format!("'{line}' is not finite"),
            Self::OutOfRange => format!("{line} must lie in 0 … 1"),
        }
    }
}

/// The first value of a material that makes no sense.
fn fault(m: &tobj::Material) -> Option<Fault> {
    let transparency = match transparency(m) {
        Some(Err(())) => return Some(Fault::NotANumber),
        Some(Ok(x)) => Some(x),
        None => None,
    };
    let colors = [m.ambient, m.diffuse, m.specular, m.emissive];
    let opacities = [m.dissolve, transparency];
    let numbers = [m.shininess, m.optical_density];
    let all = colors.iter().flatten().flatten();
    let mut all = all.chain(opacities.iter().chain(&numbers).flatten());
    if !all.all(|x| x.is_finite()) {
        return Some(Fault::NotFinite);
    }
    let mut opacities = opacities.iter().flatten();
    (!opacities.all(|x| (0.0..=1.0).contains(x))).then_some(Fault::OutOfRange)
}

/// `Tr`, the opposite of `d`, which `tobj` leaves as text.
fn transparency(m: &tobj::Material) -> Option<Result<f32, ()>> {
    let text = m.unknown_param.get("Tr")?;
    let word = text.split_whitespace().next().unwrap_or_default();
    Some(word.parse().map_err(|_| ()))
}

/// Statements of textures that are read and not drawn.
pub(super) fn not_drawn(materials: &[tobj::Material]) -> BTreeSet<&str> {
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
            is_texture && super::textures::drawn_as(key).is_none()
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
