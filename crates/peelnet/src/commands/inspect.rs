//! `peelnet inspect`: what a scene, a dataset or a model is.

use super::{Context, bench_effects::METHOD};
use crate::cli::InspectArgs;
use crate::failure::{Failure, one_line};
use crate::parse::{json_path, shown};
use crate::summary_text::summary_text;
use peelnet_dataset::{Dataset, Summary, is_remote};
use peelnet_eval::effects::{self, Cost, Settings};
use peelnet_files::{counted, one_line as escaped, printable, thousands};
use peelnet_model::Model;
use peelnet_render::{FrameStats, MethodOptions, MethodSpec, Renderer, shader_bytes};
use peelnet_scene::{Census, Effect, Scene, file::ENDINGS, suite};
use serde_json::json;
use std::path::Path;
use std::{collections::HashMap, fmt::Write as _};

/// Frame in which a scene's fragments are counted: view 0 at the size that `extract` and `render` use by default.
const COUNTED_AT: [u32; 2] = [1024, 768];

pub(super) fn run(context: &Context<'_>, args: &InspectArgs) -> Result<(), Failure> {
    let path = &args.what;
    let ending = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    let ships = path.to_str().and_then(suite::find).is_some();
    if is_remote(path) && ending.eq_ignore_ascii_case("safetensors") {
        model(context, path)
    } else if is_remote(path) {
        dataset(context, path)
    } else if path.is_dir() {
        if ships {
            context.console.message(format!(
                "{}: the folder here, not the shipped scene of this name",
                shown(path)
            ));
        }
        dataset(context, path)
    } else if !path.exists() && ships {
        scene(context, path, args.time)
    } else if !path.exists() {
        Err(Failure::Failed(format!(
            "{}: there is no such file or folder",
            shown(path)
        )))
    } else if ENDINGS.iter().any(|e| ending.eq_ignore_ascii_case(e)) {
        scene(context, path, args.time)
    } else if ending.eq_ignore_ascii_case("safetensors") {
        model(context, path)
    } else {
        Err(Failure::Usage(format!(
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
    context.console.result(
        || {
            let called = m.scenes.iter().filter(|s| !s.effects.is_empty());
            let census = called.map(|s| format!("  {:<33} {}\n", printable(&s.name), escaped(&s.effects.join(", "))));
            let census: String = census.collect();
            let census = if census.is_empty() {
                census
            } else {
                format!("\neffects that the scenes needed\n{census}")
            };
            format!(
                "dataset     {}\nwritten by  peelnet {} on {} ({} peeling, {} of the pixels, seed {})\ncommand     {}\n{}{census}",
                shown(path),
                printable(&m.tool_version),
                printable(&m.adapter),
                printable(&m.peel),
                m.pixels_fraction,
                m.seed,
                escaped(&m.command),
                summary_text(&summary)
            )
        },
        || {
            let mut value = json!(summary);
            value["kind"] = "dataset".into();
            value["path"] = json_path(path).into();
            value["passes"] = summary.passes().into();
            value["format"] = json!(m.format);
            value["tool_version"] = json!(m.tool_version);
            value["adapter"] = json!(m.adapter);
            value["command"] = json!(m.command);
            value["seed"] = json!(m.seed);
            let effects = m.scenes.iter().map(|s| (s.name.clone(), json!(s.effects)));
            value["effects"] = effects.collect::<serde_json::Map<_, _>>().into();
            value
        },
    )?;
    if summary.passes() {
        return Ok(());
    }
    Err(Failure::Failed(format!(
        "{}: rows disagree with one another (see the checks); extract the dataset again",
        shown(path)
    )))
}

/// Frame in which effects are timed.
const TIMED_AT: [u32; 2] = [512, 384];

/// Timed frames with and without each effect, in turn.
const TIMED_FRAMES: u32 = 7;

/// Triangles, and those of transparent surfaces.
fn triangles(scene: &Scene) -> [u64; 2] {
    let mut counts = [0, 0];
    for object in &scene.objects {
        for (part, material) in object.mesh.parts.iter().zip(&object.materials) {
            let n = part.triangles.len() as u64;
            counts[0] += n;
            counts[1] += if material.is_opaque() { 0 } else { n };
        }
    }
    counts
}

fn scene(context: &Context<'_>, path: &Path, time: bool) -> Result<(), Failure> {
    let scene = context.scene(path)?;
    let census = Census::of(&scene);
    let [all, transparent] = triangles(&scene);
    let counted = match count(context, &scene) {
        Ok(stats) => Some(stats),
        Err(failure) => {
            // The rest is known without a GPU.
            context
                .console
                .warn(format!("fragments were not counted: {failure}"));
            None
        }
    };
    // Shader text of all surfaces, and how much of it each effect brings.
    let shader = shader_bytes(&scene)?;
    let brought = Effect::ALL.map(|effect| {
        let without = shader_bytes(&scene.without(effect)).unwrap_or(shader);
        (effect.name(), shader as i64 - without as i64)
    });
    let brought: HashMap<&str, i64> = brought.into_iter().collect();
    let costs = if time {
        let settings = Settings {
            method: METHOD.parse()?,
            size: TIMED_AT,
            frames: TIMED_FRAMES,
        };
        effects::costs(&context.gpu()?, &scene, &settings)?
    } else {
        Vec::new()
    };
    context.check_interrupt()?;
    context.console.result(
        || {
            scene_text(
                &scene,
                &census,
                [all, transparent],
                counted.as_ref(),
                (shader, &brought),
                &costs,
            )
        },
        || {
            json!({
                "kind": "scene",
                "effects": census.effects,
                "shader_bytes": shader,
                "shader_bytes_brought": brought,
                "variants": census.variants.iter().map(|v| v.features()).collect::<Vec<_>>(),
                "costs": costs,
                "path": json_path(path),
                "name": scene.name,
                "hash": scene.hash,
                "held_out": scene.held_out,
                "views": scene.views.len(),
                "lights": scene.lights.len(),
                "objects": scene.objects.len(),
                "triangles": all,
                "transparent_triangles": transparent,
                "fragments": counted.as_ref().and_then(|s| s.fragments),
                "max_layers": counted.as_ref().and_then(|s| s.max_layers),
                "counted_at": {"view": 0, "width": COUNTED_AT[0], "height": COUNTED_AT[1]},
                "warnings": scene.warnings,
            })
        },
    )
}

/// Draws view 0 exactly, which counts its fragments.
fn count(context: &Context<'_>, scene: &Scene) -> Result<FrameStats, Failure> {
    let gpu = context.gpu()?;
    let camera = scene
        .views
        .first()
        .ok_or_else(|| Failure::Failed("the scene has no view".to_owned()))?;
    let renderer = Renderer::new(&gpu, scene)?;
    let exact: MethodSpec = peelnet_eval::compare::EXACT.parse()?;
    let mut prepared = renderer.method(&exact, MethodOptions::sized(COUNTED_AT))?;
    Ok(renderer.image(&mut prepared, camera)?.stats)
}

fn scene_text(
    scene: &Scene,
    census: &Census,
    [all, transparent]: [u64; 2],
    counted: Option<&FrameStats>,
    (shader, brought): (usize, &HashMap<&str, i64>),
    costs: &[Cost],
) -> String {
    let mut t = format!("scene       {}\n", printable(&scene.name));
    let _ = writeln!(t, "file        {}", shown(&scene.source));
    let _ = writeln!(t, "hash        {}", scene.hash);
    let held_out = if scene.held_out {
        "yes: never trained on"
    } else {
        "no"
    };
    let _ = writeln!(t, "held out    {held_out}");
    let _ = writeln!(t, "views       {}", scene.views.len());
    let _ = writeln!(t, "lights      {}", scene.lights.len());
    let _ = writeln!(t, "objects     {}", scene.objects.len());
    let _ = writeln!(
        t,
        "triangles   {}, of which {} transparent",
        thousands(all),
        thousands(transparent)
    );
    if let Some((n, most)) = counted.and_then(|s| Some((s.fragments?, s.max_layers?))) {
        let _ = writeln!(
            t,
            "fragments   {} in view 0 at {}x{}, up to {most} a pixel",
            thousands(n),
            COUNTED_AT[0],
            COUNTED_AT[1]
        );
    }
    let _ = writeln!(
        t,
        "pipelines   at most {} in a pass over the surfaces, linked from {} bytes of shader text (blended)",
        census.variants.len(),
        thousands(shader as u64)
    );
    t.push_str("\neffect                  on   needed by\n");
    for effect in &census.effects {
        let on = if effect.on { "yes" } else { "–" };
        let _ = writeln!(t, "{:<23} {on:<4} {}", effect.name, few(&effect.why));
        if effect.on {
            let bytes = brought.get(effect.name).filter(|bytes| **bytes != 0);
            let bytes = bytes.map_or_else(String::new, |bytes| {
                format!("; {bytes:+} bytes of shader text")
            });
            let _ = writeln!(t, "{:<28} adds {}{bytes}", "", effect.adds);
        }
    }
    if !costs.is_empty() {
        let [width, height] = TIMED_AT;
        let _ = writeln!(
            t,
            "\neffect                  with ms  without ms  ratio  passes  bytes a pixel   (wboit-eq9, view 0, {width}x{height}, medians of {TIMED_FRAMES} frames in turn)"
        );
        for c in costs {
            let _ = writeln!(
                t,
                "{:<23} {:>7.2} {:>11.2} {:>6.2} {:>7} {:>14}",
                c.effect,
                c.ms_with,
                c.ms_without,
                c.ratio,
                beside(f64::from(c.passes_with), f64::from(c.passes_without)),
                beside(c.bytes_with, c.bytes_without),
            );
        }
    }
    t
}

/// A figure with an effect, and that without where it differs.
fn beside(with: f64, without: f64) -> String {
    if with == without {
        format!("{with:.0}")
    } else {
        format!("{with:.0} ({without:.0})")
    }
}

/// The first names, and how many more there are.
fn few(names: &[String]) -> String {
    const SHOWN: usize = 4;
    let shown = names.iter().take(SHOWN).map(|name| printable(name));
    let shown = shown.collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

fn model(context: &Context<'_>, path: &Path) -> Result<(), Failure> {
    let model = peelnet::load_model(path)?;
    let hash = model
        .hash()
        .map_err(|e| Failure::Failed(format!("{}: {}", shown(path), one_line(&e))))?;
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
    let meta = &model.meta;
    let mut t = format!("model       {}\n", shown(path));
    let _ = writeln!(t, "hash        {hash}");
    let _ = writeln!(
        t,
        "recipe      {} (method {})",
        meta.recipe, meta.recipe.method
    );
    let _ = writeln!(
        t,
        "network     {}, {} parameters, output {}",
        model.mlp.topology(),
        model.mlp.parameters(),
        meta.output
    );
    let _ = writeln!(
        t,
        "trained by  peelnet {}, seed {}, {}",
        printable(&meta.tool_version),
        meta.seed,
        counted(meta.epochs.into(), "epoch")
    );
    match &meta.dataset {
        Some(d) => {
            let rows = thousands(d.rows);
            let _ = writeln!(t, "dataset     {rows} rows, hash {}", printable(&d.hash));
            let scenes: Vec<_> = d.scenes.iter().map(|scene| printable(scene)).collect();
            let _ = writeln!(t, "scenes      {}", scenes.join(", "));
        }
        None => t.push_str("dataset     none: made by hand\n"),
    }
    for (name, loss) in [
        ("training", meta.losses.train),
        ("validation", meta.losses.validation),
        ("test", meta.losses.test),
    ] {
        if let Some(loss) = loss {
            let _ = writeln!(t, "loss        {loss:.6} ({name})");
        }
    }
    for (scene, error) in &meta.held_out {
        let scene = printable(scene);
        let _ = writeln!(t, "held out    {scene}: mean error of T {error:.4}");
    }
    t.push_str(
        "\ninputs               unit              offset        scale    seen in training\n",
    );
    for input in &meta.inputs {
        let _ = writeln!(
            t,
            "  {:<18} {:<14} {:>10.4} {:>12.4}    {} … {}",
            input.name,
            printable(&input.unit),
            input.offset,
            input.scale,
            input.min,
            input.max
        );
    }
    t
}
