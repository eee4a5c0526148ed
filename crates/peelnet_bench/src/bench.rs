//! Methods on scenes: what `peelnet bench` measures, as plain functions.

pub use crate::{records::Bench, stage::Progress};

use crate::{
    EvalError, Partial, Row,
    compare::{Plan, compare},
    load,
    stage::{Watch, exact_method},
};
use peelnet_model::Model;
use peelnet_render::gpu::Gpu;
use peelnet_scene::Scene;
use std::sync::atomic::AtomicBool;

pub fn trained_on<'a>(
    scenes: &[Scene],
    models: impl IntoIterator<Item = &'a Model>,
) -> Vec<String> {
    let datasets = models.into_iter().filter_map(|m| m.meta.dataset.as_ref());
    let all: Vec<_> = datasets.collect();
    let is_trained_on = |scene: &&Scene| {
        let mut all = all.iter();
        all.any(|d| d.scenes.contains(&scene.name) || d.contents.contains(&scene.content))
    };
    let found = scenes.iter().filter(is_trained_on);
    found.map(|scene| scene.name.clone()).collect()
}

/// Compares methods on every view of the scenes and returns the rows.
///
/// ```no_run
/// use peelnet_bench::{bench::bench, compare::Plan};
/// use peelnet_render::gpu::{AdapterRequest, Gpu};
/// use peelnet_scene::Scene;
///
/// let gpu = Gpu::open(&AdapterRequest::Auto)?;
/// let scene = Scene::load("data/scenes/cups.toml")?;
/// let methods = ["mboit4".parse()?, "wboit-eq9".parse()?];
/// for row in bench(&gpu, &[scene], &Plan::new([512, 384], &methods))? {
///     println!("{} on {}: {:.2e} in {:?} ms", row.method, row.scene, row.mse_linear, row.time_ms);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn bench(gpu: &Gpu, scenes: &[Scene], plan: &Plan<'_>) -> Result<Vec<Row>, EvalError> {
    let partial = Partial::new(None, serde_json::Value::Null);
    let stop = AtomicBool::new(false);
    Ok(bench_watched(gpu, scenes, plan, partial, &stop, &mut |_| {})?.rows)
}

/// Refuses two scenes of one name: rows and pictures name their scene.
pub(crate) fn check_names(scenes: &[Scene]) -> Result<(), EvalError> {
    for (i, scene) in scenes.iter().enumerate() {
        if let Some(other) = scenes[..i].iter().find(|s| s.name == scene.name) {
            return Err(EvalError::SameName {
                name: scene.name.clone(),
                first: other.source.clone(),
                second: scene.source.clone(),
            });
        }
    }
    Ok(())
}

/// As [`bench()`], but continues what `partial` holds, adds each finished view to it, reports progress, and can be stopped.
pub fn bench_watched(
    gpu: &Gpu,
    scenes: &[Scene],
    plan: &Plan<'_>,
    mut partial: Partial,
    stop: &AtomicBool,
    report: &mut dyn FnMut(Progress),
) -> Result<Bench, EvalError> {
    check_names(scenes)?;
    let names: Vec<String> = plan.methods.iter().map(ToString::to_string).collect();
    if let Some(k) = (1..names.len()).find(|&k| names[..k].contains(&names[k])) {
        return Err(EvalError::SameMethod(names[k].clone()));
    }
    let views = scenes.iter().map(|scene| scene.first_views(plan.views));
    let checked: Result<Vec<_>, String> = views.collect();
    checked.map_err(EvalError::Unusable)?;
    let exact_name = exact_method().to_string();
    partial.check(|row| {
        let mut scenes = scenes.iter().filter(|s| s.name == row.scene);
        scenes.any(|s| (row.view as usize) < plan.views_of(s))
            && (row.method == exact_name || names.contains(&row.method))
    })?;
    let load_before = load();
    let left = |s: &Scene| plan.views_of(s).saturating_sub(partial.done(&s.name).len());
    let views: usize = scenes.iter().map(left).sum();
    // The exact method is drawn whether it is in the plan or not.
    let exact = usize::from(!plan.methods.contains(&exact_method()));
    // The compared frame, too; those that warm up are not counted.
    let frames_of_each = plan.frames as usize + 1;
    let total = (views * (plan.methods.len() + exact) * frames_of_each) as u64;
    let mut watch = Watch::new(total, stop, report);
    for scene in scenes {
        compare(gpu, scene, plan, &mut partial, &mut watch)?;
    }
    Ok(Bench {
        load: [load_before, load()],
        settings: None,
        trained_on: trained_on(scenes, plan.models),
        rows: partial.finish(),
    })
}
