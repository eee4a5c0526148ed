//! `peelnet inspect`: what a scene, a dataset or a model is.

use super::Context;
use crate::cli::InspectArgs;
use crate::failure::{Failure, one_line};
use crate::progress::thousands;
use crate::summary_text::summary_text;
use peelnet_dataset::{Dataset, Summary};
use peelnet_model::Model;
use peelnet_render::{FrameStats, MethodSpec, Renderer};
use peelnet_scene::{Lighting, Material, Scene};
use serde_json::json;
use std::fmt::Write as _;
use std::path::Path;

/// Frame in which a scene's fragments are counted: view 0 at the size that `extract` and `render` use by default.
const COUNTED_AT: [u32; 2] = [1024, 768];

pub(super) fn run(context: &Context<'_>, args: &InspectArgs) -> Result<(), Failure> {
    let path = &args.what;
    let ending = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    if path.is_dir() {
        dataset(context, path)
    } else if !path.exists() {
        Err(Failure::Failed(format!(
            "{}: there is no such file or folder",
            path.display()
        )))
    } else if ending.eq_ignore_ascii_case("toml") {
        scene(context, path)
    } else if ending.eq_ignore_ascii_case("safetensors") {
        model(context, path)
    } else {
        Err(Failure::Usage(format!(
            "{}: neither a scene (.toml), a dataset (a folder) nor a model (.safetensors)",
            path.display()
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
            format!(
                "dataset     {}\nwritten by  peelnet {} on {} ({} peeling, {} of the pixels, seed {})\ncommand     {}\n{}",
                path.display(),
                m.tool_version,
                m.adapter,
                m.peel,
                m.pixels_fraction,
                m.seed,
                m.command,
                summary_text(&summary)
            )
        },
        || {
            let mut value = json!(summary);
            value["kind"] = "dataset".into();
            value["path"] = json!(path);
            value["passes"] = summary.passes().into();
            value["format"] = json!(m.format);
            value["tool_version"] = json!(m.tool_version);
            value["adapter"] = json!(m.adapter);
            value["command"] = json!(m.command);
            value["seed"] = json!(m.seed);
            value
        },
    )?;
    if summary.passes() {
        return Ok(());
    }
    Err(Failure::Failed(format!(
        "{}: rows disagree with one another (see the checks); extract the dataset again",
        path.display()
    )))
}

/// What is counted of a scene without drawing it.
#[derive(Debug, Default, PartialEq, Eq)]
struct Census {
    triangles: u64,
    transparent_triangles: u64,
    unlit_parts: u64,
    phong_parts: u64,
    double_sided_parts: u64,
}

/// Whether a material goes through the transparent path.
fn transparent(material: &Material) -> bool {
    material.blend || material.alpha < 1.0
}

impl Census {
    fn of(scene: &Scene) -> Self {
        let mut census = Self::default();
        for object in &scene.objects {
            census.triangles += object.mesh.triangles.len() as u64;
            for (part, material) in object.mesh.parts.iter().zip(&object.materials) {
                if transparent(material) {
                    census.transparent_triangles += part.triangles.len() as u64;
                }
                match material.lighting {
                    Lighting::Unlit => census.unlit_parts += 1,
                    Lighting::Phong => census.phong_parts += 1,
                }
                census.double_sided_parts += u64::from(material.double_sided);
            }
        }
        census
    }
}

fn scene(context: &Context<'_>, path: &Path) -> Result<(), Failure> {
    let scene = context.scene(path)?;
    let census = Census::of(&scene);
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
    context.console.result(
        || scene_text(&scene, &census, counted.as_ref()),
        || {
            json!({
                "kind": "scene",
                "path": path,
                "name": scene.name,
                "hash": scene.hash,
                "held_out": scene.held_out,
                "views": scene.views.len(),
                "lights": scene.lights.len(),
                "objects": scene.objects.len(),
                "triangles": census.triangles,
                "transparent_triangles": census.transparent_triangles,
                "unlit_parts": census.unlit_parts,
                "phong_parts": census.phong_parts,
                "double_sided_parts": census.double_sided_parts,
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
    let mut prepared = renderer.prepare(&exact, COUNTED_AT, None)?;
    Ok(renderer.draw(&mut prepared, camera)?.stats)
}

fn scene_text(scene: &Scene, census: &Census, counted: Option<&FrameStats>) -> String {
    let mut t = format!("scene       {}\n", scene.name);
    let _ = writeln!(t, "file        {}", scene.source.display());
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
        thousands(census.triangles),
        thousands(census.transparent_triangles)
    );
    let _ = writeln!(
        t,
        "materials   {} unlit, {} Phong, {} double-sided",
        census.unlit_parts, census.phong_parts, census.double_sided_parts
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
    t
}

fn model(context: &Context<'_>, path: &Path) -> Result<(), Failure> {
    let model = Model::load(path)?;
    let hash = model
        .hash()
        .map_err(|e| Failure::Failed(format!("{}: {}", path.display(), one_line(&e))))?;
    context.console.result(
        || model_text(path, &model, &hash),
        || {
            json!({
                "kind": "model",
                "path": path,
                "hash": hash,
                "method": model.meta.recipe.method_name(),
                "topology": model.mlp.topology(),
                "parameters": model.mlp.parameters(),
                "meta": model.meta,
            })
        },
    )
}

fn model_text(path: &Path, model: &Model, hash: &str) -> String {
    let meta = &model.meta;
    let mut t = format!("model       {}\n", path.display());
    let _ = writeln!(t, "hash        {hash}");
    let _ = writeln!(
        t,
        "recipe      {} (method {})",
        meta.recipe,
        meta.recipe.method_name()
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
        "trained by  peelnet {}, seed {}, {} epochs",
        meta.tool_version, meta.seed, meta.epochs
    );
    match &meta.dataset {
        Some(d) => {
            let _ = writeln!(t, "dataset     {} rows, hash {}", thousands(d.rows), d.hash);
            let _ = writeln!(t, "scenes      {}", d.scenes.join(", "));
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
        let _ = writeln!(t, "held out    {scene}: mean error of T {error:.4}");
    }
    t.push_str(
        "\ninputs               unit              offset        scale    seen in training\n",
    );
    for input in &meta.inputs {
        let _ = writeln!(
            t,
            "  {:<18} {:<14} {:>10.4} {:>12.4}    {} … {}",
            input.name, input.unit, input.offset, input.scale, input.min, input.max
        );
    }
    t
}
