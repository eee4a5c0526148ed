//! What effects cost: each effect of a scene with and without it, shading and transparency each alone, shading of one layer against all,
//! and how the view of layers grows with triangles and with the part of the frame that it fills.

pub use crate::records::{Cost, Effects, Fill, LayerCost, Parts};

use crate::{
    EvalError,
    bench::{Progress, check_names},
    compare::image_name,
    stage::{Ready, Stage, Watch, in_turn, percentile},
};
use glam::{Mat4, Vec3};
use peelnet_render::gpu::Gpu;
use peelnet_render::{LayerFormula, LayerView, MethodOptions, MethodSpec, Profile, milliseconds};
use peelnet_scene::{Camera, Effect, MaterialFlags, Scene, SceneFeatures};
use std::{
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

pub struct Settings {
    pub method: MethodSpec,
    pub size: [u32; 2],
    /// Timed frames.
    pub frames: u32,
}

/// Parts of the frame that an object fills in the table of triangles.
pub const FILLED: [f64; 3] = [0.5, 0.75, 1.0];

/// Times an effect of a scene: the frame as it is and without the effect, drawn in turn. Pictures of both go to the folder.
pub fn cost(
    gpu: &Gpu,
    scene: &Scene,
    effect: &Effect,
    settings: &Settings,
    folder: Option<&Path>,
) -> Result<Cost, EvalError> {
    let plain = scene.without(effect);
    let (method, size) = (&settings.method, settings.size);
    let name = format!("{method} ({effect})");
    let ready =
        |stage: &Stage<'_>| stage.prepare(&name, |r| r.method(method, MethodOptions::sized(size)));
    let mut stages = stages(gpu, &[scene, &plain], ready)?;
    let (mut bytes, mut passes) = ([0.0; 2], [0; 2]);
    for (k, (stage, ready)) in stages.iter_mut().enumerate() {
        let drawn = stage.image(ready, &scene.views[0])?;
        bytes[k] = drawn.stats.bytes_per_pixel;
        passes[k] = drawn.stats.geometry_passes + drawn.stats.fullscreen_passes;
        if let Some(folder) = folder {
            let file = picture_of(folder, &scene.name, effect.name, k == 0);
            drawn.image.save(&file).map_err(stage.failed(&name))?;
        }
    }
    let ms = times(stages, &scene.views[0], settings.frames)?;
    Ok(Cost {
        scene: scene.name.clone(),
        effect: effect.name.to_owned(),
        ms_with: ms[0],
        ms_without: ms[1],
        ratio: ms[0] / ms[1],
        passes_with: passes[0],
        passes_without: passes[1],
        bytes_with: bytes[0],
        bytes_without: bytes[1],
    })
}

/// Times shading alone, transparency alone and both together, of a scene that has both: `None` of any other.
fn parts(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<Option<Parts>, EvalError> {
    let mut variants = SceneFeatures::new(scene).variants.into_iter();
    let is_lit = variants.any(|flags| flags.contains(MaterialFlags::LIT));
    if !is_lit || scene.transparent_bounds().is_none() {
        return Ok(None);
    }
    let (opaque, unlit) = (scene.opaque(), scene.unlit());
    let options = || MethodOptions::sized(settings.size);
    let ready = |stage: &Stage<'_>| stage.ready(&settings.method, options());
    let stages = stages(gpu, &[scene, &opaque, &unlit], ready)?;
    let ms = times(stages, &scene.views[0], settings.frames)?;
    Ok(Some(Parts {
        scene: scene.name.clone(),
        ms_both: ms[0],
        ms_shading: ms[1],
        ms_transparency: ms[2],
    }))
}

fn stages<'s>(
    gpu: &Gpu,
    scenes: &[&'s Scene],
    prepare: impl Fn(&Stage<'s>) -> Result<Ready, EvalError>,
) -> Result<Vec<(Stage<'s>, Ready)>, EvalError> {
    let stage = |scene: &&'s Scene| {
        let stage = Stage::new(gpu, scene)?;
        let ready = prepare(&stage)?;
        Ok((stage, ready))
    };
    scenes.iter().map(stage).collect()
}

/// Median times of frames that are drawn in turn.
fn times(
    mut stages: Vec<(Stage<'_>, Ready)>,
    camera: &Camera,
    count: u32,
) -> Result<Vec<f64>, EvalError> {
    let never = AtomicBool::new(false);
    let mut report = |_: Progress| {};
    let mut unseen = Watch::new(0, &never, &mut report);
    let all = stages.iter_mut().map(|(stage, ready)| (&*stage, ready));
    let frames = in_turn(&mut all.collect::<Vec<_>>(), camera, count, &mut unseen)?;
    // The opaque surfaces have effects too.
    let ms = |f: &Profile| milliseconds(&f.times).unwrap_or(f.wall_micros / 1e3);
    let median = |all: &Vec<Profile>| percentile(all.iter().map(ms), 0.5).unwrap_or_default();
    Ok(frames.iter().map(median).collect())
}

fn view_of(stage: &Stage<'_>, highlight: u32, size: [u32; 2]) -> Result<Ready, EvalError> {
    let view = LayerView {
        highlight,
        increasing: false,
        formula: LayerFormula::Front,
    };
    stage.prepare("layers", |renderer| renderer.layers(view, size))
}

/// Times of the view of layers from a camera: with one layer shaded, and with all.
fn layer_times(
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
) -> Result<[f64; 2], EvalError> {
    let layers = scene.layers();
    // Of the middle: with layers in front of it and behind.
    let highlight = layers[layers.len() / 2];
    let one = scene.layer_view(highlight, false)?;
    let all = scene.layer_view(highlight, true)?;
    let ready = |stage: &Stage<'_>| view_of(stage, highlight, settings.size);
    let stages = stages(gpu, &[&one, &all], ready)?;
    let ms = times(stages, camera, settings.frames)?;
    Ok([ms[0], ms[1]])
}

/// The scene with its layers so many times over, each set around the one before.
fn nested(scene: &Scene, times: u32) -> Scene {
    let mut all = scene.clone();
    all.objects.clear();
    let count = scene.layers().last().map_or(0, |last| last + 1);
    for k in 0..times {
        for object in &scene.objects {
            let mut object = object.clone();
            let outside = Mat4::from_scale(Vec3::splat(1.0 + 0.05 * k as f32));
            object.world_from_object = outside * object.world_from_object;
            object.layer = object.layer.map(|layer| layer + (times - 1 - k) * count);
            all.objects.push(object);
        }
    }
    all
}

/// A camera that looks from the same place with a narrower or wider angle, so that the object fills a part of the frame: the widest
/// that fills at least as much.
fn filling(
    gpu: &Gpu,
    scene: &Scene,
    filled: f64,
    size: [u32; 2],
) -> Result<(Camera, f64), EvalError> {
    let highlight = scene.layers()[0];
    let scene = scene.layer_view(highlight, false)?;
    let stage = Stage::new(gpu, &scene)?;
    let mut ready = view_of(&stage, highlight, size.map(|n| (n / 4).max(1)))?;
    let camera = |fov_y_degrees: f32| Camera {
        fov_y_degrees,
        ..scene.views[0]
    };
    let mut part = |angle: f32| -> Result<f64, EvalError> {
        let image = stage.image(&mut ready, &camera(angle))?.image;
        let covered = image.pixels.iter().filter(|p| p[3] > 0.0).count();
        Ok(covered as f64 / image.pixels.len() as f64)
    };
    let (mut narrow, mut wide) = (0.5f32, 120.0);
    for _ in 0..20 {
        let middle = (narrow + wide) / 2.0;
        if part(middle)? >= filled {
            narrow = middle;
        } else {
            wide = middle;
        }
    }
    Ok((camera(narrow), part(narrow)?))
}

/// Measures every effect of every scene, and of those with layers what shading one of them saves.
pub fn measure(
    gpu: &Gpu,
    scenes: &[Scene],
    settings: &Settings,
    folder: &Path,
    stop: &AtomicBool,
    report: &mut dyn FnMut(Progress),
) -> Result<Effects, EvalError> {
    check_names(scenes)?;
    let mut found = Effects {
        method: settings.method.to_string(),
        size: settings.size,
        frames: settings.frames,
        ..Effects::default()
    };
    let mut watch = Watch::new(0, stop, report);
    let mut next = |scene: &Scene, what: String| {
        watch.drawn(&scene.name, &what);
        watch.check()
    };
    for scene in scenes {
        for effect in SceneFeatures::new(scene).effects_on() {
            next(scene, effect.to_string())?;
            let cost = cost(gpu, scene, effect, settings, Some(folder));
            found.costs.push(cost?);
        }
        next(scene, "shading and transparency".to_owned())?;
        found.parts.extend(parts(gpu, scene, settings)?);
    }
    for scene in scenes.iter().filter(|s| s.layers().len() > 1) {
        for times in 1..=3 {
            let many = nested(scene, times);
            let layers = many.layers().len() as u32;
            next(scene, format!("{layers} layers"))?;
            let [ms_one, ms_all] = layer_times(gpu, &many, &scene.views[0], settings)?;
            found.layers.push(LayerCost {
                scene: scene.name.clone(),
                layers,
                ms_one,
                ms_all,
                ratio: ms_one / ms_all,
            });
        }
        let mut finer = scene.clone();
        for cut in 0..3 {
            if cut > 0 {
                for object in &mut finer.objects {
                    object.mesh = Arc::new(object.mesh.subdivided());
                }
            }
            for part in FILLED {
                next(scene, format!("{} triangles", finer.triangles()))?;
                let (camera, filled) = filling(gpu, scene, part, settings.size)?;
                let [ms_one, ms_all] = layer_times(gpu, &finer, &camera, settings)?;
                found.fills.push(Fill {
                    scene: scene.name.clone(),
                    triangles: finer.triangles() as u64,
                    filled,
                    ms_one,
                    ms_all,
                });
            }
        }
    }
    Ok(found)
}

pub fn picture_of(folder: &Path, scene: &str, effect: &str, on: bool) -> PathBuf {
    let state = if on { "on" } else { "off" };
    let name = image_name(scene, &format!("{effect}-{state}"));
    folder.join("images").join(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sets around one another keep their order: outermost first.
    #[test]
    fn nested_layers_are_numbered_from_outside() {
        let vase = peelnet_scene::suite::load("vase").unwrap();
        let six = nested(&vase, 2);
        assert_eq!(six.layers(), [0, 1, 2, 3, 4, 5]);
        let width = |o: &peelnet_scene::Object| {
            let (low, high) = o.mesh.bounds().unwrap();
            o.world_from_object.transform_vector3(high - low).x
        };
        let mut objects: Vec<_> = six.objects.iter().collect();
        objects.sort_by_key(|o| o.layer);
        assert!(objects.windows(2).all(|w| width(w[0]) > width(w[1])));
    }
}
