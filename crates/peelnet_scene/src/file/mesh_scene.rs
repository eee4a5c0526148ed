use crate::{
    budget::{self, MAX_COORDINATE, MAX_LIGHTS},
    camera::Camera,
    displacement::displaced,
    error::{SceneError, shown},
    files::Files,
    import::Load,
    material::{Lighting, Material},
    mesh::Mesh,
    scene::{Light, Object, Scene, Source},
};
use glam::{Mat4, Vec3};
use peelnet_core::files::printable;
use std::{path::Path, sync::Arc};

/// Views of a file without a camera.
const VIEWS: u32 = 3;

/// A mesh file with its own lights and cameras; where it has none, with two lights, and a camera that sees all of it from three sides. Splats have
/// no lights, and a black background.
pub(super) fn load(path: &Path, load: Load, mut files: Files<'_>) -> Result<Scene, SceneError> {
    let file = files.within(path, |files| load(path, files))?;
    let mut lights = file.lights;
    let fail = |message: String| SceneError::file(path, None, message);
    let materials = file.mesh.parts.iter().map(|p| p.material.clone());
    let mut materials: Vec<Material> = materials.collect();
    let mesh = displaced(Arc::new(file.mesh), &mut materials, &mut files.budget).map_err(&fail)?;
    let bounds = Extent::of(&mesh).map_err(&fail)?;
    let up = if file.is_y_down { Vec3::NEG_Y } else { Vec3::Y };
    let background = match mesh.splats {
        Some(_) => [0.0; 3],
        None => [1.0; 3],
    };
    budget::check(lights.len() as u64, MAX_LIGHTS as u64, "lights").map_err(&fail)?;
    let mut views = Vec::new();
    for (name, camera) in file.cameras {
        match sound(camera, bounds) {
            Some(camera) => views.push(camera),
            None => {
                let before = format!(
                    "{}: cameras whose numbers make no sense are left out: ",
                    shown(path)
                );
                files.warnings.about(before, &printable(&name), "");
            }
        }
    }
    if views.is_empty() {
        views = fitting_camera(bounds, up).orbit(VIEWS);
    }
    if lights.is_empty()
        && let Some(lighting) = one_lighting(&mut materials)
    {
        // Other formats have no lights: that is no news.
        if file.is_scene {
            let message = "has no point light: two are added; put it into a scene file with lights of your own, or none";
            files.warn(path, message);
        }
        lights.extend(default_lights(bounds, lighting));
    }
    if materials.iter().all(Material::is_opaque) {
        let message = "is opaque; to look through it, name it in a scene file, with material = { alpha = 0.5 }";
        files.warn(path, message);
    }
    let first = views[0];
    let name = super::name_of(path);
    let object = Object {
        name: name.clone(),
        materials,
        mesh,
        world_from_object: Mat4::IDENTITY,
        layer: None,
    };
    Ok(Scene {
        source: path.to_owned(),
        hash: files.hash(),
        content: files.content(),
        warnings: files.warnings.texts(),
        files: files.used,
        views,
        lights,
        ..Scene::generated(&name, "its file", background, first, vec![object])
    })
}

/// Lights all surfaces that are lit in one way, as one pair of lights suits one: physically based if any is. `None` if none is lit.
fn one_lighting(materials: &mut [Material]) -> Option<Lighting> {
    let has = |materials: &[Material], l: Lighting| materials.iter().any(|m| m.lighting == l);
    if !has(materials, Lighting::Pbr) {
        return has(materials, Lighting::Phong).then_some(Lighting::Phong);
    }
    let lit = materials.iter_mut();
    for material in lit.filter(|m| m.lighting != Lighting::Unlit) {
        material.lighting = Lighting::Pbr;
    }
    Some(Lighting::Pbr)
}

/// A sphere around a file, and how far all of it reaches from the middle.
#[derive(Clone, Copy)]
struct Extent {
    middle: Vec3,
    radius: f32,
    /// The radius, but of splats, some of which lie far outside of it.
    reach: f32,
    /// Of the near plane, in radii: splats are around the camera, too.
    near: f32,
}

impl Extent {
    fn of(mesh: &Mesh) -> Result<Self, String> {
        let farthest = |(low, high): (Vec3, Vec3)| low.abs().max(high.abs()).max_element();
        let all = mesh.bounds().unwrap_or_default();
        if farthest(all) > MAX_COORDINATE {
            let farthest = farthest(all);
            return Err(format!(
                "reaches {farthest:e} from the origin, and a scene at most {MAX_COORDINATE:e}; scale it down"
            ));
        }
        let (low, high) = mesh.main_bounds().unwrap_or_default();
        let middle = (low + high) / 2.0;
        // Far from the origin a camera that is closer would be at the same place as its target.
        let least = 1e-5 * farthest((low, high));
        let radius = ((high - low).length() / 2.0).max(1e-6).max(least);
        Ok(match mesh.splats {
            None => Self {
                middle,
                radius,
                reach: radius,
                near: 0.5,
            },
            Some(_) => Self {
                middle,
                radius,
                reach: (all.1 - middle).max(middle - all.0).length().max(radius),
                near: 0.05,
            },
        })
    }
}

/// A camera of the file, whose target is as far ahead as the middle of all is, and behind its near plane: the file says in which direction
/// it looks, and what turns about the target needs to know at what. `None` where its numbers make no sense.
fn sound(mut camera: Camera, extent: Extent) -> Option<Camera> {
    let Extent {
        middle,
        radius,
        reach,
        ..
    } = extent;
    let direction = camera.target - camera.position;
    // Nearer than that, it would be where the camera is.
    let least = camera.near.max(1e-5 * camera.position.abs().max_element());
    let ahead = (middle - camera.position).dot(direction).max(least);
    camera.target = camera.position + direction * ahead;
    if camera.far == f32::INFINITY {
        let distance = (camera.position - middle).length();
        camera.far = distance + reach.max(4.0 * radius);
    }
    let is_sound = camera.check().is_ok() && camera.view_from_world().is_finite();
    is_sound.then_some(camera)
}

/// A camera that looks along −z, or where −y is up, with all axes turned about x, along z.
fn fitting_camera(extent: Extent, up: Vec3) -> Camera {
    let Extent { middle, radius, .. } = extent;
    let towards = Vec3::new(0.5, 0.35 * up.y, up.y).normalize();
    Camera {
        position: middle + towards * radius * 2.8,
        target: middle,
        up,
        fov_y_degrees: 45.0,
        near: radius * extent.near,
        far: (radius * 8.0).max(2.9 * radius + 1.01 * extent.reach),
    }
}

/// Lights so bright that a white surface facing them is nearly white.
fn default_lights(extent: Extent, lighting: Lighting) -> [Light; 2] {
    let Extent { middle, radius, .. } = extent;
    [([0.6, 0.9, 1.0], 0.8), ([-1.0, 0.1, 0.7], 0.4)].map(|(towards, share)| {
        let distance = 4.0 * radius;
        Light {
            source: Source::Point(middle + Vec3::from(towards).normalize() * distance),
            color: [1.0; 3],
            intensity: if lighting == Lighting::Pbr {
                share * std::f32::consts::PI * distance * distance
            } else {
                share
            },
        }
    })
}
