use super::{Context, count, few, json_path, losses};
use crate::cli::{EFFECTS_METHOD, InspectArgs};
use crate::summary_text::summary_text;
use peelnet::Failure;
use peelnet_bench::effects::{self, Cost, Settings};
use peelnet_bench::report::{dataset_page, kind_of, write_file};
use peelnet_core::files::{counted, one_line, printable, read_head, shown, thousands};
use peelnet_dataset::{Dataset, Summary, is_remote};
use peelnet_model::{KIND, Model};
use peelnet_render::{FrameStats, shader_bytes};
use peelnet_scene::{EFFECTS, Scene, SceneFeatures, file::ENDINGS, suite};
use serde_json::json;
use std::{collections::HashMap, path::Path};

/// Frames in which a scene's fragments are counted: view 0 at the size that `extract` and `render` use by default, or at a 256th of its
/// pixels if the scene has more triangles, or more fragments there, than are drawn within seconds on a CPU. Parts are drawn one by one:
/// of more than these nothing is counted.
const COUNTED_AT: [[u32; 2]; 2] = [[1024, 768], [64, 48]];
const MOST_TRIANGLES: u64 = 1 << 20;
const MOST_FRAGMENTS: u64 = 1 << 17;
const MOST_PARTS: usize = 1 << 15;

const TIMED_AT: [u32; 2] = [512, 384];

/// Timed frames with and without each effect, in turn.
const TIMED_FRAMES: u32 = 7;

pub(super) fn run(context: &Context<'_>, args: &InspectArgs) -> Result<(), Failure> {
    let path = &args.what;
    let ending = path.extension().and_then(|e| e.to_str());
    let ending = ending.unwrap_or_default().to_lowercase();
    // A model may have any name.
    let is_ours = |path: &Path| read_head(path, 1 << 16).is_ok_and(|head| (KIND.is)(&head));
    let is_model = ending == "safetensors" || (!is_remote(path) && is_ours(path));
    let ships = path.to_str().and_then(suite::find).is_some();
    let is_scene = !is_remote(path) && !path.is_dir() && !is_model;
    if args.time && !is_scene {
        let text = format!(
            "{}: --time measures a scene's effects; leave it out",
            shown(path)
        );
        return Err(Failure::wrong(text));
    }
    let html = args.html.as_deref();
    let is_dataset = path.is_dir() || is_remote(path) && !is_model;
    if html.is_some() && !is_dataset && (is_model || ships || path.exists()) {
        let text = format!("{}: --html is for a dataset; leave it out", shown(path));
        return Err(Failure::wrong(text));
    }
    if is_remote(path) {
        return if is_model {
            model(context, path)
        } else {
            dataset(context, path, html)
        };
    }
    if path.is_dir() {
        context.say_not_shipped("folder", path);
        dataset(context, path, html)
    } else if !path.exists() && !ships {
        let text = format!("{}: there is no such file or folder", shown(path));
        Err(Failure::failed(text))
    } else if is_model && path.exists() {
        model(context, path)
    } else if !path.exists() || ENDINGS.contains(&ending.as_str()) {
        scene(context, path, args.time)
    } else {
        Err(Failure::wrong(format!(
            "{}: neither a scene (.{}), a dataset (a folder) nor a model (.safetensors)",
            shown(path),
            ENDINGS.join(", .")
        )))
    }
}

fn dataset(context: &Context<'_>, path: &Path, html: Option<&Path>) -> Result<(), Failure> {
    let mut outputs = context.outputs([path]);
    if let Some(page) = html {
        outputs.file("--html", page, kind_of("page.html"))?;
    }
    let _begun = context.begin(outputs, &[])?;
    let dataset = Dataset::open(path)?;
    dataset.verify()?;
    let summary = Summary::from_dataset(&dataset)?;
    if let Some(page) = html {
        write_file(page, dataset_page(&dataset, &summary)?)?;
        let message = format!("the page is {}", shown(page));
        context.console.message(message);
    }
    let m = dataset.manifest();
    let text = || {
        let [version, adapter, peel] = [&m.tool_version, &m.adapter, &m.peel].map(|t| printable(t));
        let mut t = format!(
            "dataset     {}\n\
             written by  peelnet {version} on {adapter} ({peel} peeling, {} of the pixels, seed {})\n\
             command     {}\n",
            shown(path),
            m.pixels_fraction,
            m.seed,
            one_line(&m.command)
        );
        let mut scenes = m.scenes.iter().filter(|s| !s.effects.is_empty()).peekable();
        if scenes.peek().is_some() {
            t += "\neffects that the scenes needed\n";
        }
        for scene in scenes {
            let (name, effects) = (printable(&scene.name), scene.effects.join(", "));
            t += &format!("  {name:<33} {}\n", one_line(&effects));
        }
        t + "\n" + &summary_text(&summary)
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
    let [whole, small] = COUNTED_AT;
    let parts: usize = scene.objects.iter().map(|o| o.materials.len()).sum();
    let counted = context.gpu().and_then(|gpu| {
        if parts > MOST_PARTS {
            let why = format!("the scene has {} parts", thousands(parts as u64));
            return Err(Failure::failed(why));
        }
        let first = count(&gpu, &scene, small)?;
        if triangles[0] > MOST_TRIANGLES || first.fragments > Some(MOST_FRAGMENTS) {
            return Ok((small, first));
        }
        Ok((whole, count(&gpu, &scene, whole)?))
    });
    let (size, counted) = counted.unwrap_or_else(|failure| {
        // The rest is known without a GPU.
        let warning = format!("fragments were not counted: {failure}");
        context.console.warn(warning);
        (whole, FrameStats::default())
    });
    let shader = shader_bytes(&scene)?;
    let features = SceneFeatures::new(&scene);
    // How many of these bytes each effect brings; one that is off needs no copy of the scene to know.
    let brought = EFFECTS.iter().map(|effect| {
        let on = Some(effect).filter(|effect| features.has(effect));
        let without = on.and_then(|effect| shader_bytes(&scene.without(effect)).ok());
        (
            effect.name,
            shader as i64 - without.unwrap_or(shader) as i64,
        )
    });
    let brought: HashMap<_, _> = brought.collect();
    let mut costs = Vec::new();
    if time {
        let settings = Settings {
            method: EFFECTS_METHOD.parse()?,
            size: TIMED_AT,
            frames: TIMED_FRAMES,
        };
        let gpu = context.gpu()?;
        for effect in features.effects_on() {
            costs.push(effects::cost(&gpu, &scene, effect, &settings, None)?);
        }
    }
    context.check_interrupt()?;
    let text = || {
        let head = scene_text(&scene, triangles, (size, counted), &features, shader);
        head + &effects_text(&features, &brought) + &costs_text(&costs)
    };
    context.console.result(text, || {
        json!({
            "kind": "scene",
            "effects": features.effects,
            "shader_bytes": shader,
            "shader_bytes_brought": brought,
            "variants": features.variants.iter().map(|v| v.features()).collect::<Vec<_>>(),
            "costs": costs,
            "path": json_path(path),
            "name": scene.name,
            "hash": scene.hash,
            "held_out": scene.held_out,
            "views": scene.views.len(),
            "lights": scene.lights.len(),
            "objects": scene.objects.len(),
            "triangles": triangles[0],
            "transparent_triangles": triangles[1],
            "fragments": counted.fragments,
            "max_layers": counted.max_layers,
            "counted_at": {"view": 0, "width": size[0], "height": size[1]},
            "warnings": scene.warnings,
        })
    })
}

fn scene_text(
    scene: &Scene,
    triangles: [u64; 2],
    ([width, height], counted): ([u32; 2], FrameStats),
    features: &SceneFeatures,
    shader: usize,
) -> String {
    let [all, transparent] = triangles.map(thousands);
    let counted = counted.fragments.zip(counted.max_layers);
    let fragments = counted.map_or_else(String::new, |(n, most)| {
        let n = thousands(n);
        format!("fragments   {n} in view 0 at {width}x{height}, up to {most} a pixel\n")
    });
    format!(
        "scene       {}\n\
         file        {}\n\
         hash        {}\n\
         held out    {}\n\
         views       {}\n\
         lights      {}\n\
         objects     {}\n\
         triangles   {all}, of which {transparent} transparent\n\
         {fragments}\
         pipelines   at most {} in a pass over the surfaces, linked from {} bytes of shader text (blended)\n",
        printable(&scene.name),
        shown(&scene.source),
        scene.hash,
        ["no", "yes: never trained on"][usize::from(scene.held_out)],
        scene.views.len(),
        scene.lights.len(),
        scene.objects.len(),
        features.variants.len(),
        thousands(shader as u64)
    )
}

fn effects_text(features: &SceneFeatures, brought: &HashMap<&str, i64>) -> String {
    let mut t = "\neffect                  on   needed by\n".to_owned();
    for effect in &features.effects {
        let on = if effect.on { "yes" } else { "–" };
        let why = few(&effect.why, 4);
        t += &format!("{:<23} {on:<4} {why}\n", effect.name);
        if effect.on {
            let bytes = brought.get(effect.name).filter(|bytes| **bytes != 0);
            let bytes = bytes.map(|bytes| format!("; {bytes:+} bytes of shader text"));
            let bytes = bytes.unwrap_or_default();
            t += &format!("{:<28} adds {}{bytes}\n", "", effect.adds);
        }
    }
    t
}

fn costs_text(costs: &[Cost]) -> String {
    let mut t = String::new();
    if !costs.is_empty() {
        let [width, height] = TIMED_AT;
        t = format!(
            "\neffect                  with ms  without ms  ratio  passes  bytes a pixel   (wboit-eq9, view 0, {width}x{height}, medians of {TIMED_FRAMES} frames in turn)\n"
        );
    }
    for c in costs {
        let passes = beside(c.passes_with.into(), c.passes_without.into());
        let bytes = beside(c.bytes_with, c.bytes_without);
        t += &format!(
            "{:<23} {:>7.2} {:>11.2} {:>6.2} {passes:>7} {bytes:>14}\n",
            c.effect, c.ms_with, c.ms_without, c.ratio,
        );
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

fn model(context: &Context<'_>, path: &Path) -> Result<(), Failure> {
    let model = peelnet::load_model(path)?;
    let hash = model.hash();
    let hash = hash.map_err(|e| Failure::from(e).about(&shown(path)))?;
    let text = || model_text(path, &model, &hash);
    context.console.result(text, || {
        json!({
            "kind": "model",
            "path": json_path(path),
            "hash": hash,
            "method": model.meta.recipe.method,
            "topology": model.mlp.topology(),
            "parameters": model.mlp.parameters(),
            "meta": model.meta,
        })
    })
}

fn model_text(path: &Path, model: &Model, hash: &str) -> String {
    let Model { meta, mlp, .. } = model;
    let (recipe, version) = (meta.recipe, printable(&meta.tool_version));
    let dataset = meta.dataset.as_ref().map(|d| {
        let (rows, hash) = (thousands(d.rows), printable(&d.hash));
        let scenes: Vec<_> = d.scenes.iter().map(|scene| printable(scene)).collect();
        format!(
            "{rows} rows, hash {hash}\nscenes      {}",
            scenes.join(", ")
        )
    });
    let mut t = format!(
        "model       {}\n\
         hash        {hash}\n\
         recipe      {recipe} (method {})\n\
         network     {}, {} parameters, output {}\n\
         trained by  peelnet {version}, seed {}, {}\n\
         dataset     {}\n",
        shown(path),
        recipe.method,
        mlp.topology(),
        mlp.parameters(),
        meta.output,
        meta.seed,
        counted(meta.epochs.into(), "epoch"),
        dataset.as_deref().unwrap_or("none: made by hand")
    );
    for (name, loss) in losses(model) {
        t += &format!("loss        {loss:.6} ({name})\n");
    }
    for (scene, error) in &meta.held_out {
        let scene = printable(scene);
        t += &format!("held out    {scene}: mean error of T {error:.4}\n");
    }
    t += "\ninputs               unit              offset        scale    seen in training\n";
    for input in &meta.inputs {
        let unit = printable(&input.unit);
        t += &format!(
            "  {:<18} {unit:<14} {:>10.4} {:>12.4}    {} … {}\n",
            input.name, input.offset, input.scale, input.min, input.max
        );
    }
    t
}
