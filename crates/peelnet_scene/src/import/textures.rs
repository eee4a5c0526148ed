//! Textures that MTL files name.

use super::mtl::Libraries;
use crate::{
    error::shown,
    material::{Lighting, Material},
    texture::{Displacement, Maps, Texture, Wrap},
};
use peelnet_core::files::printable;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

/// Keys of the textures that are drawn, as exporters write them: the first of each stands for all.
const DRAWN: [&[&str]; 8] = [
    &["map_Kd"],
    &["map_d"],
    // A height field, or normals where it is not grey.
    &["map_Bump", "map_bump", "bump"],
    &["norm", "map_Norm", "map_Kn"],
    &["map_Pr"],
    &["map_Pm"],
    &["map_Ke"],
    &["disp", "map_disp", "map_Disp"],
];

pub(super) fn drawn_as(key: &str) -> Option<&'static str> {
    let keys = DRAWN.into_iter().find(|keys| keys.contains(&key))?;
    Some(keys[0])
}

/// The arguments of a statement such as `map_Bump -bm 0.5 -clamp on bricks.png`.
#[derive(Clone, Debug)]
struct Statement {
    file: PathBuf,
    /// Multiplies heights.
    strength: f32,
    /// Of heights: what is added to them, and what they are multiplied by.
    range: [f32; 2],
    clamp: bool,
}

impl Libraries<'_, '_> {
    /// A texture that was made; `None`, with a warning, where the scene has no room for it.
    fn drawn(&mut self, made: Result<Arc<Texture>, String>, what: &str) -> Option<Arc<Texture>> {
        made.map_err(|e| {
            let after = format!(" is not drawn: {e}");
            let warnings = &mut self.files.warnings;
            warnings.about("texture ", &printable(what), after);
        })
        .ok()
    }

    /// Reads a statement's arguments; `None`, with a warning, where it names no file.
    fn statement(&mut self, library: &Path, key: &str, text: &str) -> Option<Statement> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let mut rest = words.as_slice();
        let mut statement = Statement {
            file: PathBuf::new(),
            strength: 1.0,
            range: [0.0, 1.0],
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
                ("-mm", Some(base)) if drawn_as(key) == Some("disp") => {
                    let number = |w: Option<&&str>| w.and_then(|w| w.parse::<f32>().ok());
                    let gain = number(after.get(1)).unwrap_or(1.0);
                    statement.range = [number(Some(base)).unwrap_or(0.0), gain];
                }
                ("-clamp", Some(value)) => statement.clamp = *value == "on",
                _ => self.files.warnings.about(
                    format!("{}: not drawn: ", shown(library)),
                    &format!("option {} of {key}", printable(option)),
                    "",
                ),
            }
            rest = &after[taken.min(after.len())..];
        }
        if rest.is_empty() {
            self.files.warn(library, &format!("{key} names no file"));
            return None;
        }
        // Windows writes backslashes, which other systems do not read.
        let folder = library.parent().unwrap_or(Path::new("."));
        statement.file = folder.join(rest.join(" ").replace('\\', "/"));
        Some(statement)
    }

    /// A texture; `None`, and a warning, where it cannot be drawn.
    fn texture(&mut self, file: &Path) -> Option<Arc<Texture>> {
        // Names of one file are many, such as a/../a/b.png.
        let key = self.files.identity(file);
        if let Some(known) = self.textures.get(&key) {
            return known.clone();
        }
        let texture = self.files.texture(file).map(Arc::new).map_err(|e| {
            let after = format!(" {}; drawn without it", e.reason());
            self.files.warnings.about("", &shown(file), after);
        });
        let texture = texture.ok();
        self.textures.insert(key, texture.clone());
        texture
    }

    /// A material with the textures that `m`, of a library, names.
    pub fn put_on(&mut self, library: &Path, m: &tobj::Material, material: Material) -> Material {
        let mut material = material;
        let known = [
            ("map_Kd", &m.diffuse_texture),
            ("map_d", &m.dissolve_texture),
            ("map_Bump", &m.normal_texture),
        ];
        let known = known
            .into_iter()
            .filter_map(|(key, text)| Some((key, text.as_ref()?)));
        let others = m.unknown_param.iter().map(|(key, text)| (&**key, text));
        let statements: BTreeMap<&str, &String> = known.chain(others).collect();
        let mut found: BTreeMap<&str, (Statement, Arc<Texture>)> = BTreeMap::new();
        for (key, text) in statements {
            if let Some(kind) = drawn_as(key)
                && let Some(statement) = self.statement(library, key, text)
                && let Some(texture) = self.texture(&statement.file)
            {
                found.insert(kind, (statement, texture));
            }
        }
        let map = |kind| found.get(&kind).map(|(_, texture)| texture);
        let mut maps = Maps::NONE;
        if found.values().any(|(statement, _)| statement.clamp) {
            maps.wrap = [Wrap::Clamp; 2];
        }
        maps.color = self.color_map(map("map_Kd"), map("map_d"));
        if map("map_d").is_some() {
            material.blend = true;
        }
        maps.normal = match (map("norm"), found.get("map_Bump")) {
            (Some(normals), _) => Some(Arc::clone(normals)),
            (None, Some((statement, bump))) if bump.is_grey => {
                // Many strengths share the texture of the nearest power of two.
                let strength = Some(statement.strength).filter(|s| s.is_finite());
                let strength = strength.unwrap_or(1.0);
                let shared = strength.abs().log2().round().clamp(-3.0, 3.0).exp2();
                maps.normal_scale = (strength / shared).clamp(-100.0, 100.0);
                // White rises over black by an eightieth of the texture's width.
                let slope = shared * bump.size[0] as f32 / 80.0;
                let what = format!("normals by {slope}");
                let normals = || bump.normals_of_heights(slope);
                let made = self.files.made(&what, [Some(bump), None], normals);
                self.drawn(made, &format!("{what} of {}", bump.name))
            }
            (None, _) => map("map_Bump").cloned(),
        };
        let (rough, metal) = (map("map_Pr"), map("map_Pm"));
        if rough.is_some() || metal.is_some() {
            let what = "roughness and metallic";
            let texel = |rough: [u8; 4], metal: [u8; 4]| [255, rough[0], metal[0], 255];
            let made = self.files.joined(what, [rough, metal], texel);
            maps.metallic_roughness = self.drawn(made, what);
            if material.lighting != Lighting::Unlit {
                material.lighting = Lighting::Pbr;
            }
            if rough.is_some() && !m.unknown_param.contains_key("Pr") {
                material.roughness = 1.0;
            }
            if metal.is_some() && !m.unknown_param.contains_key("Pm") {
                material.metallic = 1.0;
            }
        }
        maps.displacement = found.get("disp").and_then(|(statement, map)| {
            let [base, gain] = statement.range;
            // Heights are base + gain × luminance, in the file's own lengths.
            let scale = gain * statement.strength;
            let middle = -base / gain;
            (scale.is_finite() && middle.is_finite()).then(|| Displacement {
                map: Arc::clone(map),
                scale,
                middle,
                level: None,
            })
        });
        maps.emissive = map("map_Ke").cloned();
        if maps.emissive.is_some() && m.emissive.is_none() {
            material.emission = [1.0; 3];
        }
        Material { maps, ..material }
    }

    /// Base colour with the opacity of `map_d`. Opacity in the colour's own file is dropped.
    fn color_map(
        &mut self,
        color: Option<&Arc<Texture>>,
        alpha: Option<&Arc<Texture>>,
    ) -> Option<Arc<Texture>> {
        let Some(alpha) = alpha else {
            let color = color?;
            if !color.has_alpha {
                return Some(Arc::clone(color));
            }
            let warnings = &mut self.files.warnings;
            let after = ": its opacity is not drawn; name it with map_d as well";
            warnings.about("texture ", &printable(&color.name), after);
            let opaque = || color.opaque();
            let made = self.files.made("colours", [Some(color), None], opaque);
            return self.drawn(made, &format!("colours of {}", color.name));
        };
        let by_alpha = alpha.has_alpha;
        let value = |t: [u8; 4]| if by_alpha { t[3] } else { t[0] };
        let texel = |c: [u8; 4], a: [u8; 4]| [c[0], c[1], c[2], value(a)];
        let both = [color, Some(alpha)];
        let made = self.files.joined("colours and opacity", both, texel);
        self.drawn(made, &format!("opacity of {}", alpha.name))
    }
}
