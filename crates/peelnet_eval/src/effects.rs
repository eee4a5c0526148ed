//! What effects cost: each that a scene calls for with and without it, shading of one layer against all, and how the view of layers
//! grows with triangles and with the part of the frame that it fills.

use crate::{EvalError, Machine, compare, lines, table, write_atomically, write_json};
use glam::{Mat4, Vec3};
use peelnet_gpu::Gpu;
use peelnet_render::{Image, LayerView, MethodSpec, Prepared, RenderError, Renderer};
use peelnet_scene::{Camera, Census, Effect, Scene};
use serde::{Deserialize, Serialize};
use std::{
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
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
    /// The same of the scene as if nothing called for the effect, drawn in turn.
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
    /// What it was measured on.
    pub machine: Machine,
    /// The command line.
    pub command: String,
    /// The method that effects are measured with.
    pub method: String,
    /// Frame size in pixels.
    pub size: [u32; 2],
    /// Timed frames.
    pub frames: u32,
    /// Effects by scene.
    pub costs: Vec<Cost>,
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

/// Times every effect that a scene calls for: the frame as it is, and of the scene without it, drawn in turn.
///
/// # Errors
/// What drawing meets.
pub fn costs(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<Vec<Cost>, EvalError> {
    let census = Census::of(scene);
    let called = Effect::ALL.into_iter().filter(|e| census.has(*e));
    called
        .map(|effect| cost(gpu, scene, effect, settings))
        .collect()
}

fn cost(gpu: &Gpu, scene: &Scene, effect: Effect, settings: &Settings) -> Result<Cost, EvalError> {
    let failed = || EvalError::render(&scene.name, &format!("{} ({effect})", settings.method));
    let plain = scene.without(effect);
    let renderers = [
        Renderer::new(gpu, scene).map_err(failed())?,
        Renderer::new(gpu, &plain).map_err(failed())?,
    ];
    let mut frames = Vec::new();
    let (mut bytes, mut passes) = ([0.0; 2], [0; 2]);
    for (k, renderer) in renderers.iter().enumerate() {
        let mut prepared = renderer
            .prepare(&settings.method, settings.size, None)
            .map_err(failed())?;
        let drawn = renderer
            .draw(&mut prepared, &scene.views[0])
            .map_err(failed())?;
        bytes[k] = drawn.stats.bytes_per_pixel;
        passes[k] = drawn.stats.geometry_passes + drawn.stats.fullscreen_passes;
        frames.push(prepared);
    }
    let [a, b] = &mut frames[..] else {
        unreachable!("two renderers were made");
    };
    let [ms_with, ms_without] = in_turn(
        [(&renderers[0], a), (&renderers[1], b)],
        &scene.views[0],
        settings.frames,
    )
    .map_err(failed())?;
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

/// Median times of two frames that are drawn in turn, so that both meet the same machine; the first of each warms up.
fn in_turn(
    mut frames: [(&Renderer<'_>, &mut Prepared); 2],
    camera: &Camera,
    count: u32,
) -> Result<[f64; 2], RenderError> {
    let mut times = [Vec::new(), Vec::new()];
    for i in 0..=count {
        for ((renderer, prepared), times) in frames.iter_mut().zip(&mut times) {
            let (passes, wall) = renderer.time(prepared, camera)?;
            if i > 0 {
                times.push(compare::milliseconds(&passes).unwrap_or(wall / 1e3));
            }
        }
    }
    Ok(times.map(|mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    }))
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
    let view = LayerView {
        highlight: layers[layers.len() / 2],
        increasing: false,
    };
    let scenes = [
        scene.layer_view(view.highlight, false)?,
        scene.layer_view(view.highlight, true)?,
    ];
    let times = || {
        let [one, all] = [
            Renderer::new(gpu, &scenes[0])?,
            Renderer::new(gpu, &scenes[1])?,
        ];
        let [mut a, mut b] = [
            one.prepare_layers(view, settings.size)?,
            all.prepare_layers(view, settings.size)?,
        ];
        in_turn([(&one, &mut a), (&all, &mut b)], camera, settings.frames)
    };
    times().map_err(EvalError::render(&scene.name, "layers"))
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
    let layers = scene.layers();
    let view = LayerView {
        highlight: layers[0],
        increasing: false,
    };
    let scene = scene.layer_view(view.highlight, false)?;
    let failed = || EvalError::render(&scene.name, "layers");
    let renderer = Renderer::new(gpu, &scene).map_err(failed())?;
    let small = size.map(|n| (n / 4).max(1));
    let mut prepared = renderer.prepare_layers(view, small).map_err(failed())?;
    let mut part = |angle: f32| -> Result<f64, EvalError> {
        let camera = Camera {
            fov_y_degrees: angle,
            ..scene.views[0]
        };
        let frame = renderer.draw(&mut prepared, &camera).map_err(failed())?;
        let image: Image = frame.image;
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
    command: String,
    folder: &Path,
    stop: &AtomicBool,
    mut tick: impl FnMut(&str),
) -> Result<Effects, EvalError> {
    let mut found = Effects {
        machine: Machine::of(gpu),
        command,
        method: settings.method.to_string(),
        size: settings.size,
        frames: settings.frames,
        costs: Vec::new(),
        layers: Vec::new(),
        fills: Vec::new(),
    };
    let go_on = || {
        if stop.load(Ordering::Relaxed) {
            Err(EvalError::Interrupted)
        } else {
            Ok(())
        }
    };
    for scene in scenes {
        let census = Census::of(scene);
        for effect in Effect::ALL.into_iter().filter(|e| census.has(*e)) {
            go_on()?;
            tick(&format!("{}: {effect}", scene.name));
            found.costs.push(cost(gpu, scene, effect, settings)?);
            picture(
                gpu,
                scene,
                settings,
                &picture_of(folder, &scene.name, effect.name(), true),
            )?;
            let plain = scene.without(effect);
            picture(
                gpu,
                &plain,
                settings,
                &picture_of(folder, &scene.name, effect.name(), false),
            )?;
        }
    }
    for scene in scenes.iter().filter(|s| s.layers().len() > 1) {
        for times in 1..=3 {
            go_on()?;
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
                go_on()?;
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
pub(crate) fn picture_of(folder: &Path, scene: &str, effect: &str, on: bool) -> std::path::PathBuf {
    let state = if on { "on" } else { "off" };
    folder
        .join("images")
        .join(compare::image_name(scene, &format!("{effect}-{state}")))
}

fn picture(gpu: &Gpu, scene: &Scene, settings: &Settings, file: &Path) -> Result<(), EvalError> {
    let draw = || {
        let renderer = Renderer::new(gpu, scene)?;
        let mut prepared = renderer.prepare(&settings.method, settings.size, None)?;
        let image = renderer.draw(&mut prepared, &scene.views[0])?.image;
        image.save(file)
    };
    draw().map_err(EvalError::render(&scene.name, &settings.method.to_string()))
}

impl Effects {
    /// Headings and cells of the effects.
    pub fn table(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let headings = [
            "scene",
            "effect",
            "with, ms",
            "without, ms",
            "time with / without",
            "bytes a pixel",
        ];
        let cells = self.costs.iter().map(|c| {
            let bytes = if c.bytes_with == c.bytes_without {
                format!("{:.0}", c.bytes_with)
            } else {
                format!("{:.0}, without {:.0}", c.bytes_with, c.bytes_without)
            };
            vec![
                c.scene.clone(),
                c.effect.clone(),
                format!("{:.2}", c.ms_with),
                format!("{:.2}", c.ms_without),
                format!("{:.2}", c.ratio),
                bytes,
            ]
        });
        (headings.map(str::to_owned).to_vec(), cells.collect())
    }

    /// Headings and cells of shading one layer against all.
    pub fn layer_table(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let headings = [
            "scene",
            "layers",
            "one shaded, ms",
            "all shaded, ms",
            "one / all",
        ];
        let cells = self.layers.iter().map(|l| {
            vec![
                l.scene.clone(),
                l.layers.to_string(),
                format!("{:.2}", l.ms_one),
                format!("{:.2}", l.ms_all),
                format!("{:.2}", l.ratio),
            ]
        });
        (headings.map(str::to_owned).to_vec(), cells.collect())
    }

    /// Headings and cells of triangles against the part of the frame filled: times over that of the scene's first cell.
    pub fn fill_table(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let mut headings = vec!["scene".to_owned(), "triangles".to_owned()];
        for part in FILLED {
            headings.push(format!("{:.0} % filled", part * 100.0));
        }
        for part in FILLED {
            headings.push(format!("{:.0} %, one / all", part * 100.0));
        }
        let rows = self.fills.chunks(FILLED.len()).map(|row| {
            let of_scene = |f: &&Fill| f.scene == row[0].scene;
            let first = self.fills.iter().find(of_scene).map_or(1.0, |f| f.ms_one);
            let mut cells = vec![row[0].scene.clone(), row[0].triangles.to_string()];
            cells.extend(row.iter().map(|f| format!("{:.2}", f.ms_one / first)));
            cells.extend(row.iter().map(|f| format!("{:.2}", f.ms_one / f.ms_all)));
            cells
        });
        (headings, rows.collect())
    }

    /// The curve of layers as SVG text.
    pub fn layer_chart(&self) -> String {
        let line = |name: &str, ms: fn(&LayerCost) -> f64| -> lines::Line {
            let points = self.layers.iter().map(|l| (f64::from(l.layers), ms(l)));
            (name.to_owned(), points.collect())
        };
        let all = [
            line("all layers shaded", |l| l.ms_all),
            line("one layer shaded", |l| l.ms_one),
        ];
        lines::chart(&all, "layers", "frame time, ms")
    }

    /// Writes `effects.json`, `effects.md`, `effects-layers.svg` and `report.html` into a folder; pictures are taken from `images/` in it.
    ///
    /// # Errors
    /// If a file cannot be written, or a picture not be read.
    pub fn write(&self, folder: &Path) -> Result<(), EvalError> {
        write_json(&folder.join("effects.json"), self)?;
        let tables = [self.table(), self.layer_table(), self.fill_table()];
        let titles = [EFFECTS, LAYERS, FILLS];
        let mut text = String::new();
        for ((headings, cells), (title, note)) in tables.iter().zip(titles) {
            if !cells.is_empty() {
                text += &format!(
                    "## {title}\n\n{note}\n\n{}\n",
                    table::markdown(headings, cells)
                );
            }
        }
        text += &format!(
            "`{}`, {}x{}, medians of {} frames in turn. {}\n",
            self.method,
            self.size[0],
            self.size[1],
            self.frames,
            self.machine.credit(&self.command)
        );
        write_atomically(&folder.join("effects.md"), text.as_bytes())?;
        if !self.layers.is_empty() {
            let svg = self.layer_chart();
            write_atomically(&folder.join("effects-layers.svg"), svg.as_bytes())?;
        }
        let page = crate::report::effects_page(self, folder)?;
        write_atomically(&folder.join("report.html"), page.as_bytes())
    }
}

/// Title and note of each table.
pub(crate) const EFFECTS: (&str, &str) = (
    "What each effect costs",
    "A frame of the scene as it is, over one of the scene as if nothing called for the effect; both drawn in turn in one run.",
);
pub(crate) const LAYERS: (&str, &str) = (
    "One layer shaded, or all",
    "The view of layers with physically based shading of the highlighted layer alone, against shading all layers.",
);
pub(crate) const FILLS: (&str, &str) = (
    "Triangles and the part of the frame filled",
    "The view of layers with one layer shaded: times over that of the fewest triangles at half of the frame; then times over those with \
     all layers shaded.",
);

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;

    fn layer(layers: u32, ms_one: f64, ms_all: f64) -> LayerCost {
        LayerCost {
            scene: "vase".into(),
            layers,
            ms_one,
            ms_all,
            ratio: ms_one / ms_all,
        }
    }

    /// Ratios are those of the times, and the table of triangles counts from its first cell.
    #[test]
    fn tables_are_ratios() {
        let fill = |triangles, filled, ms_one, ms_all| Fill {
            scene: "vase".into(),
            triangles,
            filled,
            ms_one,
            ms_all,
        };
        let effects = Effects {
            machine: crate::report::machine_of_tests(),
            command: "peelnet bench --effects".into(),
            method: "wboit-eq9".into(),
            size: [4, 3],
            frames: 1,
            costs: vec![Cost {
                scene: "vase".into(),
                effect: "pbr".into(),
                ms_with: 3.0,
                ms_without: 2.0,
                ratio: 1.5,
                passes_with: 2,
                passes_without: 2,
                bytes_with: 10.0,
                bytes_without: 8.0,
            }],
            layers: vec![layer(3, 2.0, 4.0), layer(6, 3.0, 9.0)],
            fills: vec![
                fill(100, 0.5, 2.0, 4.0),
                fill(100, 0.75, 3.0, 4.0),
                fill(100, 1.0, 4.0, 4.0),
            ],
        };
        assert_eq!(effects.table().1[0][4..], ["1.50", "10, without 8"]);
        assert_eq!(effects.layer_table().1[1][4], "0.33");
        assert_eq!(
            effects.fill_table().1[0][2..],
            ["1.00", "1.50", "2.00", "0.50", "0.75", "1.00"]
        );
        let folder = tempfile::tempdir().unwrap();
        effects.write(folder.path()).unwrap();
        let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
        assert!(
            page.contains("0.33") && page.contains("one layer shaded"),
            "{page}"
        );
        assert!(folder.path().join("effects-layers.svg").exists());
    }

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
