//! What effects cost: each effect of a scene with and without it, shading and transparency each alone, shading of one layer against all,
//! and how the view of layers grows with triangles and with the part of the frame that it fills.

use crate::{EvalError, check_stop, compare};
use glam::{Mat4, Vec3};
use peelnet_gpu::Gpu;
use peelnet_render::{
    LayerFormula, LayerView, MethodOptions, MethodSpec, Prepared, RenderError, Renderer,
};
use peelnet_scene::{Camera, Census, Effect, Scene};
use serde::{Deserialize, Serialize};
use std::{
    path::Path,
    sync::{Arc, atomic::AtomicBool},
};

/// What an effect costs in a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// The scene.
    pub scene: String,
    /// The effect.
    pub effect: String,
    /// Median time of a frame, milliseconds.
    pub ms_with: f64,
    /// The same for the scene without the effect, drawn in turn.
    pub ms_without: f64,
    /// The former over the latter.
    pub ratio: f64,
    /// Passes of the method.
    #[serde(default)]
    pub passes_with: u32,
    /// The same without.
    #[serde(default)]
    pub passes_without: u32,
    /// Bytes a pixel of the method.
    pub bytes_with: f64,
    /// The same without.
    pub bytes_without: f64,
}

/// Shading alone, transparency alone, and both together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parts {
    /// The scene.
    pub scene: String,
    /// Median time of a frame, milliseconds.
    pub ms_both: f64,
    /// The same with every surface opaque, shaded with all effects ([`Scene::opaque`]), drawn in turn.
    pub ms_shading: f64,
    /// The same with every surface transparent as before and unlit ([`Scene::unlit`]), drawn in turn.
    pub ms_transparency: f64,
}

/// The view of layers with one layer shaded, and with all of them shaded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerCost {
    /// The scene.
    pub scene: String,
    /// How many layers.
    pub layers: u32,
    /// Median time of a frame in which the highlighted layer alone is shaded, milliseconds.
    pub ms_one: f64,
    /// The same where all are, drawn in turn.
    pub ms_all: f64,
    /// The former over the latter.
    pub ratio: f64,
}

/// The view of layers at one number of triangles and one part of the frame filled.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fill {
    /// The scene.
    pub scene: String,
    /// Triangles.
    pub triangles: u64,
    /// Part of the frame that the object fills, 0 … 1.
    pub filled: f64,
    /// Median time of a frame in which the highlighted layer alone is shaded, milliseconds.
    pub ms_one: f64,
    /// The same where all layers are shaded.
    pub ms_all: f64,
}

/// A finished measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effects {
    /// The method that effects are measured with.
    pub method: String,
    /// Frame size in pixels.
    pub size: [u32; 2],
    /// Timed frames.
    pub frames: u32,
    /// Effects by scene.
    pub costs: Vec<Cost>,
    /// Scenes that are shaded and transparent; none in a measurement of an older version.
    #[serde(default)]
    pub parts: Vec<Parts>,
    /// Shading of one layer against all.
    pub layers: Vec<LayerCost>,
    /// Triangles against the part of the frame filled.
    pub fills: Vec<Fill>,
}

/// How effects are measured.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The method.
    pub method: MethodSpec,
    /// Frame size in pixels.
    pub size: [u32; 2],
    /// Timed frames; one more warms up.
    pub frames: u32,
}

/// Parts of the frame that an object fills in the table of triangles.
pub const FILLED: [f64; 3] = [0.5, 0.75, 1.0];

/// Times every effect of a scene: the frame as it is and without the effect, drawn in turn.
///
/// # Errors
/// What drawing meets.
pub fn costs(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<Vec<Cost>, EvalError> {
    let census = Census::of(scene);
    let called = Effect::ALL.into_iter().filter(|e| census.has(*e));
    called
        .map(|effect| cost(gpu, scene, effect, settings, None))
        .collect()
}

/// Pictures with and without the effect go to the folder.
fn cost(
    gpu: &Gpu,
    scene: &Scene,
    effect: Effect,
    settings: &Settings,
    folder: Option<&Path>,
) -> Result<Cost, EvalError> {
    let plain = scene.without(effect);
    let (mut bytes, mut passes) = ([0.0; 2], [0; 2]);
    let mut draw = || {
        let mut stages = settings.stages(gpu, [scene, &plain])?;
        for (k, (renderer, prepared)) in stages.iter_mut().enumerate() {
            let drawn = renderer.image(prepared, &scene.views[0])?;
            bytes[k] = drawn.stats.bytes_per_pixel;
            passes[k] = drawn.stats.geometry_passes + drawn.stats.fullscreen_passes;
            if let Some(folder) = folder {
                let file = picture_of(folder, &scene.name, effect.name(), k == 0);
                drawn.image.save(&file)?;
            }
        }
        in_turn(stages, &scene.views[0], settings.frames)
    };
    let method = format!("{} ({effect})", settings.method);
    let [ms_with, ms_without] = draw().map_err(EvalError::render(&scene.name, &method))?;
    Ok(Cost {
        scene: scene.name.clone(),
        effect: effect.name().to_owned(),
        ms_with,
        ms_without,
        ratio: ms_with / ms_without,
        passes_with: passes[0],
        passes_without: passes[1],
        bytes_with: bytes[0],
        bytes_without: bytes[1],
    })
}

/// Times shading alone, transparency alone and both together, of a scene that has both: `None` of any other.
///
/// # Errors
/// What drawing meets.
pub fn parts(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<Option<Parts>, EvalError> {
    let census = Census::of(scene);
    let lit = census.has(Effect::Lighting) || census.has(Effect::Pbr);
    if !lit || scene.transparent_bounds().is_none() {
        return Ok(None);
    }
    let (opaque, unlit) = (scene.opaque(), scene.unlit());
    let times = settings
        .stages(gpu, [scene, &opaque, &unlit])
        .and_then(|stages| in_turn(stages, &scene.views[0], settings.frames));
    let method = settings.method.to_string();
    let times = times.map_err(EvalError::render(&scene.name, &method))?;
    let [ms_both, ms_shading, ms_transparency] = times;
    Ok(Some(Parts {
        scene: scene.name.clone(),
        ms_both,
        ms_shading,
        ms_transparency,
    }))
}

/// A scene on the GPU, and what draws it.
type Stage = (Renderer, Prepared);

impl Settings {
    /// Scenes ready to be drawn with the method.
    fn stages<const N: usize>(
        &self,
        gpu: &Gpu,
        scenes: [&Scene; N],
    ) -> Result<[Stage; N], RenderError> {
        stages(gpu, scenes, |renderer| {
            renderer.method(&self.method, MethodOptions::sized(self.size))
        })
    }
}

fn stages<const N: usize>(
    gpu: &Gpu,
    scenes: [&Scene; N],
    prepare: impl Fn(&Renderer) -> Result<Prepared, RenderError>,
) -> Result<[Stage; N], RenderError> {
    let stage = |scene: &Scene| {
        let renderer = Renderer::new(gpu, scene)?;
        let prepared = prepare(&renderer)?;
        Ok::<Stage, RenderError>((renderer, prepared))
    };
    let stages: Vec<Stage> = scenes.into_iter().map(stage).collect::<Result<_, _>>()?;
    let Ok(stages) = stages.try_into() else {
        unreachable!("there are as many stages as scenes")
    };
    Ok(stages)
}

/// Median times of frames that are drawn in turn, so that all see the same machine load; the first of each warms up.
fn in_turn<const N: usize>(
    mut stages: [Stage; N],
    camera: &Camera,
    count: u32,
) -> Result<[f64; N], RenderError> {
    let mut times: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    for i in 0..=count {
        for ((renderer, prepared), times) in stages.iter_mut().zip(&mut times) {
            let frame = renderer.profile(prepared, camera)?;
            if i > 0 {
                // The opaque surfaces have effects too.
                let measured = peelnet_render::milliseconds(&frame.times);
                times.push(measured.unwrap_or(frame.wall_micros / 1e3));
            }
        }
    }
    Ok(times.map(|mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    }))
}

const fn view_of(highlight: u32) -> LayerView {
    LayerView {
        highlight,
        increasing: false,
        formula: LayerFormula::Front,
    }
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
    let view = view_of(layers[layers.len() / 2]);
    let one = scene.layer_view(view.highlight, false)?;
    let all = scene.layer_view(view.highlight, true)?;
    stages(gpu, [&one, &all], |renderer| {
        renderer.layers(view, settings.size)
    })
    .and_then(|stages| in_turn(stages, camera, settings.frames))
    .map_err(EvalError::render(&scene.name, "layers"))
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
    let view = view_of(scene.layers()[0]);
    let scene = scene.layer_view(view.highlight, false)?;
    let failed = || EvalError::render(&scene.name, "layers");
    let renderer = Renderer::new(gpu, &scene).map_err(failed())?;
    let small = size.map(|n| (n / 4).max(1));
    let mut prepared = renderer.layers(view, small).map_err(failed())?;
    let mut part = |angle: f32| -> Result<f64, EvalError> {
        let camera = Camera {
            fov_y_degrees: angle,
            ..scene.views[0]
        };
        let frame = renderer.image(&mut prepared, &camera).map_err(failed())?;
        let image = frame.image;
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
    let camera = Camera {
        fov_y_degrees: narrow,
        ..scene.views[0]
    };
    Ok((camera, part(narrow)?))
}

/// Measures: every effect of every scene, and of those with layers what shading one of them saves.
///
/// # Errors
/// What drawing meets; [`EvalError::Interrupted`] where `stop` was set.
pub fn measure(
    gpu: &Gpu,
    scenes: &[Scene],
    settings: &Settings,
    folder: &Path,
    stop: &AtomicBool,
    mut tick: impl FnMut(&str),
) -> Result<Effects, EvalError> {
    crate::bench::check_names(scenes)?;
    let mut found = Effects {
        method: settings.method.to_string(),
        size: settings.size,
        frames: settings.frames,
        costs: Vec::new(),
        parts: Vec::new(),
        layers: Vec::new(),
        fills: Vec::new(),
    };
    for scene in scenes {
        let census = Census::of(scene);
        for effect in Effect::ALL.into_iter().filter(|e| census.has(*e)) {
            check_stop(stop)?;
            tick(&format!("{}: {effect}", scene.name));
            let cost = cost(gpu, scene, effect, settings, Some(folder))?;
            found.costs.push(cost);
        }
        check_stop(stop)?;
        tick(&format!("{}: shading and transparency", scene.name));
        found.parts.extend(parts(gpu, scene, settings)?);
    }
    for scene in scenes.iter().filter(|s| s.layers().len() > 1) {
        for times in 1..=3 {
            check_stop(stop)?;
            let many = nested(scene, times);
            let layers = many.layers().len() as u32;
            tick(&format!("{}: {layers} layers", scene.name));
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
                check_stop(stop)?;
                tick(&format!("{}: {} triangles", scene.name, finer.triangles()));
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

/// The picture of a scene with or without an effect.
pub fn picture_of(folder: &Path, scene: &str, effect: &str, on: bool) -> std::path::PathBuf {
    let state = if on { "on" } else { "off" };
    folder
        .join("images")
        .join(compare::image_name(scene, &format!("{effect}-{state}")))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
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
