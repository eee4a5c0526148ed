//! A scene file with the changes that somebody made to the scene while looking at it.

use super::raw::RawObject;
use crate::{
    camera::Camera,
    effects::MaterialFlags,
    error::SceneError,
    material::{Material, NUMBERS},
    scatter::from_fixed_axes,
    scene::{Light, Object, Scene, Source},
};
use glam::{Mat4, Quat, Vec3};
use peelnet_core::files::printable;
use serde::Deserialize;
use toml::{Table, Value};

/// A scene file's text, and what of the changes it cannot say.
#[derive(Clone, Debug, PartialEq)]
pub struct Edited {
    /// The text. Names of files in it are relative to where the scene was read from.
    pub text: String,
    /// What is not in it, a line each; empty where everything is.
    pub left_out: Vec<String>,
}

/// How far a transform may be from one that a scene file can say, as a share of its largest entry: rounding of a few 32-bit products.
const CLOSE: f32 = 1e-4;

impl Scene {
    /// The text of a scene file that shows this scene. `text` is that of the scene file it was loaded from, as `loaded`; a mesh file has
    /// none. Objects, materials and lights that differ are written into it; comments are lost. `view`, where there is one, becomes the
    /// only camera.
    ///
    /// # Errors
    /// A text that is no scene file.
    pub fn edited(
        &self,
        loaded: &Self,
        text: Option<&str>,
        view: Option<&Camera>,
    ) -> Result<Edited, SceneError> {
        let mut table = match text {
            Some(text) => text
                .parse::<Table>()
                .map_err(|e| SceneError::file(&self.source, Some(1), e.message()))?,
            None => mesh_scene(self),
        };
        let mut left_out = Vec::new();
        if let Some(camera) = view {
            for key in ["camera", "view", "orbit"] {
                table.remove(key);
            }
            table.insert("camera".into(), camera_table(camera).into());
        }
        if self.lights != loaded.lights {
            // An empty list is the same as none.
            table.insert("light".into(), list(&self.lights, light_table));
        }
        if !loaded.timeline.is_empty() && self.time != loaded.timeline[0].time {
            left_out.push(format!(
                "the time {}: a scene file begins at its first state",
                self.time
            ));
        }
        let changed = self.objects.iter().zip(&loaded.objects).enumerate();
        for (number, (now, before)) in changed {
            let mut objects = table.get_mut("object").and_then(Value::as_array_mut);
            let own = objects.as_mut().and_then(|list| list.get_mut(number));
            let name = printable(&now.name).to_string();
            let is_moved = now.world_from_object != before.world_from_object;
            match own.and_then(Value::as_table_mut) {
                // A mesh file with several objects is one object of a scene file.
                Some(own) if text.is_some() || self.objects.len() == 1 => {
                    left_out.extend(write_object(own, now, before, &name));
                }
                _ if is_moved || now.materials != before.materials => {
                    left_out.push(format!("changes of {name}: it is no [[object]] of its own"));
                }
                _ => {}
            }
        }
        let text = toml::to_string(&table)
            .map_err(|e| SceneError::value(&self.source, "scene", e.to_string()))?;
        Ok(Edited { text, left_out })
    }
}

/// A scene of a mesh file alone, with the scene's cameras and lights.
fn mesh_scene(scene: &Scene) -> Table {
    let file = scene.source.file_name().unwrap_or_default();
    let object = table([("mesh", file.to_string_lossy().into_owned().into())]);
    table([
        ("name", scene.name.clone().into()),
        ("background", numbers(scene.background)),
        ("view", list(&scene.views, camera_table)),
        ("light", list(&scene.lights, light_table)),
        ("object", Value::Array(vec![object.into()])),
    ])
}

fn table<const N: usize>(values: [(&str, Value); N]) -> Table {
    let values = values.map(|(key, value)| (key.to_owned(), value));
    values.into_iter().collect()
}

fn list<T>(all: &[T], table: impl Fn(&T) -> Table) -> Value {
    Value::Array(all.iter().map(table).map(Value::Table).collect())
}

/// The shortest decimal number that is this one in 32 bits.
fn number(x: f32) -> Value {
    // A finite number's text is a number.
    Value::Float(x.to_string().parse().unwrap_or(f64::from(x)))
}

fn numbers(x: impl Into<[f32; 3]>) -> Value {
    Value::Array(x.into().map(number).to_vec())
}

fn camera_table(camera: &Camera) -> Table {
    table([
        ("position", numbers(camera.position)),
        ("target", numbers(camera.target)),
        ("up", numbers(camera.up)),
        ("fov_y", number(camera.fov_y_degrees)),
        ("near", number(camera.near)),
        ("far", number(camera.far)),
    ])
}

fn light_table(light: &Light) -> Table {
    let source = match light.source {
        Source::Point(position) => ("position", numbers(position)),
        // A scene file says where the light goes, not where it comes from.
        Source::Toward(from) => ("direction", numbers(-from)),
    };
    let color = ("color", numbers(light.color));
    table([source, color, ("intensity", number(light.intensity))])
}

/// Writes the changes of an object; returns what a scene file cannot say of them.
fn write_object(own: &mut Table, now: &Object, before: &Object, name: &str) -> Vec<String> {
    let mut left_out = Vec::new();
    if now.world_from_object != before.world_from_object {
        // What a mesh's `fit` does comes first, and stays.
        let said = RawObject::deserialize(own.clone());
        let said = said.map_or(Mat4::IDENTITY, |raw| raw.placed());
        let wanted = now.world_from_object * before.world_from_object.inverse() * said;
        match similarity(wanted) {
            Some((scale, rotation, translation)) => {
                own.insert("scale".into(), number(scale));
                own.insert("rotate".into(), numbers(from_fixed_axes(rotation)));
                own.insert("translate".into(), numbers(translation));
            }
            None => left_out.push(format!(
                "the transform of {name}: a scene file scales all axes alike"
            )),
        }
    }
    match (now.materials.as_slice(), before.materials.as_slice()) {
        (now, before) if now == before => {}
        ([now], [before]) => {
            let table = own.entry("material").or_insert(Table::new().into());
            if let Some(table) = table.as_table_mut() {
                write_material(table, now, before);
            }
            if now.maps != before.maps {
                left_out.push(format!(
                    "textures of {name} that its mesh file brings stay: a scene file adds textures"
                ));
            }
        }
        _ => left_out.push(format!(
            "materials of {name}: its mesh has several, and a scene file sets all of them alike"
        )),
    }
    left_out
}

fn largest(matrix: Mat4) -> f32 {
    let entries = matrix.to_cols_array().map(f32::abs);
    entries.into_iter().fold(0.0, f32::max)
}

/// A transform as one scale for all axes, a rotation and a translation.
fn similarity(matrix: Mat4) -> Option<(f32, Quat, Vec3)> {
    let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
    // A mirrored object has a negative scale of its first axis; a scene file mirrors all three.
    let (scale, rotation) = if scale.x < 0.0 {
        let turned = Mat4::from_quat(rotation) * Mat4::from_scale(-scale);
        let (s, r, _) = turned.to_scale_rotation_translation();
        (-s, r)
    } else {
        (scale, rotation)
    };
    let again = Mat4::from_translation(translation)
        * Mat4::from_quat(rotation)
        * Mat4::from_scale(Vec3::splat(scale.x));
    let close = again.abs_diff_eq(matrix, CLOSE * largest(matrix));
    (close && scale.x != 0.0 && matrix.is_finite()).then_some((scale.x, rotation, translation))
}

fn write_material(table: &mut Table, now: &Material, before: &Material) {
    if now.lighting != before.lighting {
        let name = format!("{:?}", now.lighting).to_lowercase();
        table.insert("lighting".into(), name.into());
    }
    if now.double_sided != before.double_sided {
        table.insert("double_sided".into(), now.double_sided.into());
    }
    for number in NUMBERS {
        let [values, old] = [now, before].map(number.values);
        let value = match *values {
            [x] => self::number(x),
            _ => Value::Array(values.iter().copied().map(self::number).collect()),
        };
        if values != old {
            table.insert(number.key.into(), value);
        }
    }
    if now.maps != before.maps {
        let maps = MaterialFlags::MAPS.into_iter().zip(now.maps.all());
        // A key of a scene file is the feature that it needs.
        for (flag, _) in maps.filter(|(_, map)| map.is_none()) {
            for key in flag.features() {
                table.remove(key);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{material::Lighting, suite};

    fn saved(scene: &Scene, loaded: &Scene, text: Option<&str>, view: Option<&Camera>) -> Edited {
        scene.edited(loaded, text, view).expect("writes")
    }

    fn read(text: &str) -> Scene {
        Scene::from_bytes("edited.toml", |_| Ok(text.into())).expect("reads")
    }

    /// What is written reads back as what was shown.
    #[test]
    fn changes_come_back() {
        let loaded = suite::load("cups").expect("loads");
        let text = suite::find("cups").expect("ships").text;
        let mut scene = loaded.clone();
        let turn = Mat4::from_rotation_y(0.7) * Mat4::from_scale(Vec3::splat(1.5));
        for (number, by) in [
            (0, Mat4::from_translation(Vec3::new(0.25, -1.0, 2.0))),
            (1, turn),
            (2, Mat4::from_scale(Vec3::NEG_ONE)),
        ] {
            let object = &mut scene.objects[number];
            object.world_from_object = by * object.world_from_object;
        }
        let material = &mut scene.objects[1].materials[0];
        (material.alpha, material.color) = (0.125, [0.1, 0.2, 0.3]);
        material.double_sided = !material.double_sided;
        material.lighting = Lighting::Pbr;
        scene.lights[0].intensity = 2.5;
        scene.lights.push(Light {
            source: Source::Toward(Vec3::new(0.6, 0.8, 0.0)),
            color: [1.0, 0.5, 0.25],
            intensity: 0.5,
        });
        let mut camera = loaded.views[1];
        camera.position.x += 0.1;
        let edited = saved(&scene, &loaded, Some(text), Some(&camera));
        assert_eq!(edited.left_out, [] as [String; 0]);
        let back = read(&edited.text);
        assert_eq!(back.views, [camera]);
        assert_eq!(back.lights.len(), scene.lights.len());
        for (a, b) in back.lights.iter().zip(&scene.lights) {
            let [x, y] = [a, b].map(|l| match l.source {
                Source::Point(p) | Source::Toward(p) => p,
            });
            assert!((x - y).length() < 1e-6 && a.intensity == b.intensity && a.color == b.color);
        }
        assert_eq!(back.objects.len(), scene.objects.len());
        for (a, b) in back.objects.iter().zip(&scene.objects) {
            assert_eq!(a.materials, b.materials, "{}", a.name);
            let [x, y] = [a, b].map(|o| o.world_from_object);
            assert!(x.abs_diff_eq(y, CLOSE * largest(y)), "{}: {x} {y}", a.name);
        }
    }

    /// Without a change the file says the same, for every scene that ships.
    #[test]
    fn nothing_changed_is_the_same_scene() {
        for file in suite::SCENES.iter().chain(suite::EFFECTS) {
            let loaded = suite::load_file(file, None).expect("loads");
            let edited = saved(&loaded, &loaded, Some(file.text), None);
            assert_eq!(edited.left_out, [] as [String; 0], "{}", file.path);
            let back = read(&edited.text);
            assert_eq!(back.views, loaded.views);
            assert_eq!(back.lights, loaded.lights);
            for (a, b) in back.objects.iter().zip(&loaded.objects) {
                assert_eq!(a.world_from_object, b.world_from_object);
                assert_eq!(a.materials, b.materials);
            }
        }
    }

    /// What a scene file cannot say is reported, and not written wrong.
    #[test]
    fn what_cannot_be_said_is_reported() {
        let loaded = suite::load("cups").expect("loads");
        let text = suite::find("cups").expect("ships").text;
        let mut scene = loaded.clone();
        let object = &mut scene.objects[0];
        object.world_from_object *= Mat4::from_scale(Vec3::new(1.0, 2.0, 1.0));
        let edited = saved(&scene, &loaded, Some(text), None);
        assert_eq!(edited.left_out.len(), 1);
        assert!(edited.left_out[0].contains("scales all axes alike"));
        let back = read(&edited.text);
        assert_eq!(
            back.objects[0].world_from_object,
            loaded.objects[0].world_from_object
        );
    }
}
