//! `peelnet inspect`: what a scene, a dataset or a model is.

use super::{Context, bench::EFFECTS_METHOD, few, json_path, losses};
use crate::cli::InspectArgs;
use crate::summary_text::{Lines, summary_text};
use peelnet::Failure;
use peelnet_dataset::{Dataset, Summary, is_remote};
use peelnet_eval::effects::{self, Cost, Settings};
use peelnet_files::{counted, one_line, printable, shown, thousands};
use peelnet_model::Model;
use peelnet_render::{FrameStats, MethodOptions, MethodSpec, Renderer, shader_bytes};
use peelnet_scene::{Census, Effect, Scene, file::ENDINGS, suite};
use serde_json::json;
use std::{collections::HashMap, path::Path};

/// Frame in which a scene's fragments are counted: view 0 at the size that `extract` and `render` use by default.
const COUNTED_AT: [u32; 2] = [1024, 768];

/// Frame in which effects are timed.
const TIMED_AT: [u32; 2] = [512, 384];

/// Timed frames with and without each effect, in turn.
const TIMED_FRAMES: u32 = 7;

pub(super) fn run(context: &Context<'_>, args: &InspectArgs) -> Result<(), Failure> {
    let path = &args.what;
    let ending = path.extension().and_then(|e| e.to_str());
    let ending = ending.unwrap_or_default().to_lowercase();
    let is_model = ending == "safetensors";
    let ships = path.to_str().and_then(suite::find).is_some();
    if is_remote(path) {
        return if is_model {
            model(context, path)
        } else {
            dataset(context, path)
        };
    }
    if path.is_dir() {
        context.say_not_shipped("folder", path);
        dataset(context, path)
    } else if !path.exists() && !ships {
        let path = shown(path);
        Err(Failure::failed(format!(
            "{path}: there is no such file or folder"
        )))
    } else if !path.exists() || ENDINGS.contains(&ending.as_str()) {
        scene(context, path, args.time)
    } else if is_model {
        model(context, path)
    } else {
        Err(Failure::wrong(format!(
            "{}: neither a scene (.{}), a dataset (a folder) nor a model (.safetensors)",
            shown(path),
            ENDINGS.join(", .")
        )))
    }
}

fn dataset(context: &Context<'_>, path: &Path) -> Result<(), Failure> {
    let dataset = Dataset::open(path)?;
    dataset.verify()?;
    let summary = Summary::of(&dataset)?;
    let m = dataset.manifest();
    let text = || {
        let mut t = Lines::default();
        t.field("dataset", shown(path));
        t.field(
            "written by",
            format!(
                "peelnet {} on {} ({} peeling, {} of the pixels, seed {})",
                printable(&m.tool_version),
                printable(&m.adapter),
                printable(&m.peel),
                m.pixels_fraction,
                m.seed,
            ),
        );
        t.field("command", one_line(&m.command));
        let mut census = m.scenes.iter().filter(|s| !s.effects.is_empty()).peekable();
        if census.peek().is_some() {
            t.line("\neffects that the scenes needed");
        }
        for scene in census {
            let effects = scene.effects.join(", ");
            let name = printable(&scene.name);
            t.line(format!("  {name:<33} {}", one_line(&effects)));
        }
        t.line("");
        t.0 + &summary_text(&summary)
    };
    context.console.result(text, || {
        let mut value = json!(summary);
        let effects = m.scenes.iter().map(|s| (s.name.clone(), json!(s.effects)));
        for (key, more) in [
            ("kind", "dataset".into()),
            ("path", json_path(path).into()),
            ("passes", summary.passes().into()),
            ("format", json!(m.format)),
            ("tool_version", json!(m.tool_version)),
            ("adapter", json!(m.adapter)),
            ("command", json!(m.command)),
            ("seed", json!(m.seed)),
            ("effects", effects.collect::<serde_json::Map<_, _>>().into()),
        ] {
            value[key] = more;
        }
        value
    })?;
    if summary.passes() {
        return Ok(());
    }
    Err(Failure::failed(format!(
        "{}: rows disagree with one another (see the checks); extract the dataset again",
        shown(path)
    )))
}

/// What is known of a scene.
struct Known {
    scene: Scene,
    census: Census,
    /// Triangles, and those of transparent surfaces.
    triangles: [u64; 2],
    /// What an exact frame counted.
    counted: Option<FrameStats>,
    /// Bytes of the shader text of all surfaces.
    shader: usize,
    /// How many of them each effect brings.
    brought: HashMap<&'static str, i64>,
    costs: Vec<Cost>,
}

fn scene(context: &Context<'_>, path: &Path, time: bool) -> Result<(), Failure> {
    let scene = context.scene(path, None)?;
    let mut triangles = [0, 0];
    for object in &scene.objects {
        for (part, material) in object.mesh.parts.iter().zip(&object.materials) {
            let n = part.triangles.len() as u64;
            triangles[0] += n;
            triangles[1] += if material.is_opaque() { 0 } else { n };
        }
    }
    let counted = count(context, &scene).map_err(|failure| {
        // The rest is known without a GPU.
        let warning = format!("fragments were not counted: {failure}");
        context.console.warn(warning);
    });
    let shader = shader_bytes(&scene)?;
    let brought = Effect::ALL.map(|effect| {
        let without = shader_bytes(&scene.without(effect)).unwrap_or(shader);
        (effect.name(), shader as i64 - without as i64)
    });
    let census = Census::of(&scene);
    let mut costs = Vec::new();
    if time {
        let settings = Settings {
            method: EFFECTS_METHOD.parse()?,
            size: TIMED_AT,
            frames: TIMED_FRAMES,
        };
        let gpu = context.gpu()?;
        for effect in Effect::ALL.into_iter().filter(|e| census.has(*e)) {
            costs.push(effects::cost(&gpu, &scene, effect, &settings, None)?);
        }
    }
    context.check_interrupt()?;
    let known = Known {
        census,
        scene,
        triangles,
        counted: counted.ok(),
        shader,
        brought: brought.into_iter().collect(),
        costs,
    };
    let Known { scene, census, .. } = &known;
    let counted = known.counted.as_ref();
    context.console.result(
        || scene_text(&known),
        || {
            json!({
                "kind": "scene",
                "effects": census.effects,
                "shader_bytes": shader,
                "shader_bytes_brought": known.brought,
                "variants": census.variants.iter().map(|v| v.features()).collect::<Vec<_>>(),
                "costs": known.costs,
                "path": json_path(path),
                "name": scene.name,
                "hash": scene.hash,
                "held_out": scene.held_out,
                "views": scene.views.len(),
                "lights": scene.lights.len(),
                "objects": scene.objects.len(),
                "triangles": triangles[0],
                "transparent_triangles": triangles[1],
                "fragments": counted.and_then(|s| s.fragments),
                "max_layers": counted.and_then(|s| s.max_layers),
                "counted_at": {"view": 0, "width": COUNTED_AT[0], "height": COUNTED_AT[1]},
                "warnings": scene.warnings,
            })
        },
    )
}

/// Draws view 0 exactly, which counts its fragments.
fn count(context: &Context<'_>, scene: &Scene) -> Result<FrameStats, Failure> {
    let gpu = context.gpu()?;
    let camera = peelnet::view_of(scene, 0)?;
    let renderer = Renderer::new(&gpu, scene)?;
    let exact: MethodSpec = peelnet_eval::compare::EXACT.parse()?;
    let mut prepared = renderer.method(&exact, MethodOptions::sized(COUNTED_AT))?;
    Ok(renderer.image(&mut prepared, camera)?.stats)
}

fn scene_text(known: &Known) -> String {
    let Known { scene, census, .. } = known;
    let mut t = Lines::default();
    t.field("scene", printable(&scene.name));
    t.field("file", shown(&scene.source));
    t.field("hash", &scene.hash);
    let held_out = ["no", "yes: never trained on"][usize::from(scene.held_out)];
    t.field("held out", held_out);
    t.field("views", scene.views.len());
    t.field("lights", scene.lights.len());
    t.field("objects", scene.objects.len());
    let [all, transparent] = known.triangles.map(thousands);
    t.field(
        "triangles",
        format!("{all}, of which {transparent} transparent"),
    );
    let counted = known.counted.as_ref();
    if let Some((n, most)) = counted.and_then(|s| Some((s.fragments?, s.max_layers?))) {
        let [width, height] = COUNTED_AT;
        let n = thousands(n);
        t.field(
            "fragments",
            format!("{n} in view 0 at {width}x{height}, up to {most} a pixel"),
        );
    }
    t.field(
        "pipelines",
        format!(
            "at most {} in a pass over the surfaces, linked from {} bytes of shader text (blended)",
            census.variants.len(),
            thousands(known.shader as u64)
        ),
    );
    t.line("\neffect                  on   needed by");
    for effect in &census.effects {
        let on = if effect.on { "yes" } else { "–" };
        let why = few(&effect.why, 4);
        t.line(format!("{:<23} {on:<4} {why}", effect.name));
        if effect.on {
            let bytes = known.brought.get(effect.name).filter(|bytes| **bytes != 0);
            let bytes = bytes.map(|bytes| format!("; {bytes:+} bytes of shader text"));
            let bytes = bytes.unwrap_or_default();
            t.line(format!("{:<28} adds {}{bytes}", "", effect.adds));
        }
    }
    if !known.costs.is_empty() {
        let [width, height] = TIMED_AT;
        t.line(format!(
            "\neffect                  with ms  without ms  ratio  passes  bytes a pixel   (wboit-eq9, view 0, {width}x{height}, medians of {TIMED_FRAMES} frames in turn)"
        ));
    }
    for c in &known.costs {
        let passes = beside(c.passes_with.into(), c.passes_without.into());
        let bytes = beside(c.bytes_with, c.bytes_without);
        t.line(format!(
            "{:<23} {:>7.2} {:>11.2} {:>6.2} {passes:>7} {bytes:>14}",
            c.effect, c.ms_with, c.ms_without, c.ratio,
        ));
    }
    t.0
}

/// A figure with an effect, and that without where it differs.
fn beside(with: f64, without: f64) -> String {
    if with == without {
        format!("{with:.0}")
    } else {
        format!("{with:.0} ({without:.0})")
    }
}

fn model(context: &Context<'_>, path: &Path) -> Result<(), Failure> {
    let model = peelnet::load_model(path)?;
    let hash = model
        .hash()
        .map_err(|e| Failure::from(e).about(&shown(path)))?;
    context.console.result(
        || model_text(path, &model, &hash),
        || {
            json!({
                "kind": "model",
                "path": json_path(path),
                "hash": hash,
                "method": model.meta.recipe.method,
                "topology": model.mlp.topology(),
                "parameters": model.mlp.parameters(),
                "meta": model.meta,
            })
        },
    )
}

fn model_text(path: &Path, model: &Model, hash: &str) -> String {
    let Model { meta, mlp, .. } = model;
    let mut t = Lines::default();
    t.field("model", shown(path));
    t.field("hash", hash);
    t.field(
        "recipe",
        format!("{} (method {})", meta.recipe, meta.recipe.method),
    );
    t.field(
        "network",
        format!(
            "{}, {} parameters, output {}",
            mlp.topology(),
            mlp.parameters(),
            meta.output
        ),
    );
    t.field(
        "trained by",
        format!(
            "peelnet {}, seed {}, {}",
            printable(&meta.tool_version),
            meta.seed,
            counted(meta.epochs.into(), "epoch")
        ),
    );
    match &meta.dataset {
        Some(d) => {
            let (rows, hash) = (thousands(d.rows), printable(&d.hash));
            t.field("dataset", format!("{rows} rows, hash {hash}"));
            let scenes: Vec<_> = d.scenes.iter().map(|scene| printable(scene)).collect();
            t.field("scenes", scenes.join(", "));
        }
        None => t.field("dataset", "none: made by hand"),
    }
    for (name, loss) in losses(model) {
        t.field("loss", format!("{loss:.6} ({name})"));
    }
    for (scene, error) in &meta.held_out {
        let scene = printable(scene);
        t.field("held out", format!("{scene}: mean error of T {error:.4}"));
    }
    t.line("\ninputs               unit              offset        scale    seen in training");
    for input in &meta.inputs {
        t.line(format!(
            "  {:<18} {:<14} {:>10.4} {:>12.4}    {} … {}",
            input.name,
            printable(&input.unit),
            input.offset,
            input.scale,
            input.min,
            input.max
        ));
    }
    t.0
}
