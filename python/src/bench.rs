//! Measurements: error against time, and what to choose.

use crate::{
    argument::load,
    failure::{failed, raised, warn, wrong},
    gpu, json,
    model::Model,
    render::{method, sampled, sized},
    scene::{Scene, loaded},
    watch::{Bar, watch},
};
use peelnet::{
    Compared, Failure, MethodSpec,
    bench::{
        Partial, Row,
        bench::{Bench, Progress, bench_watched},
        compare::Plan,
        front::Point,
        recommend::{Budget, points_for},
        report::Results,
    },
};
use pyo3::prelude::*;
use std::path::PathBuf;

/// What to compare: the methods named, or all; with the shipped networks where none is given.
fn compared(named: Option<Vec<String>>, models: Vec<peelnet::Model>) -> PyResult<Compared> {
    let named = named.map(|names| names.iter().map(|name| method(name)).collect());
    let named = named.transpose()?;
    let compared = Compared::new(named, models, |_| MethodSpec::compared());
    compared.and_then(Compared::with_base).map_err(raised)
}

fn measured<'py>(
    py: Python<'py>,
    scenes: &[peelnet::Scene],
    compared: &Compared,
    plan: Plan<'_>,
    adapter: &str,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bench> {
    let gpu = gpu::open(py, adapter)?;
    let mut bar = Bar::new(progress)?;
    let result = watch(
        py,
        |stop, reporter| {
            let plan = Plan {
                methods: &compared.methods,
                learned: &compared.weights(&gpu)?,
                models: &compared.models,
                ..plan
            };
            let partial = Partial::new(None, serde_json::Value::Null);
            let mut show = |event: Progress| match event {
                Progress::Drawn { .. } => reporter.send(event),
                Progress::LeftOut(_) => reporter.ask(event),
            };
            let bench = bench_watched(&gpu, scenes, &plan, partial, stop, &mut show)?;
            Ok::<_, Failure>(bench)
        },
        |py, event| match event {
            Progress::Drawn { done, total, what } => bar.set(done, total, &what),
            Progress::LeftOut(what) => warn(py, &what),
        },
    );
    bar.close(result)
}

/// Compares methods on scenes: error against the exact image, and time.
///
/// Args:
///     scenes: A scene or a list of scenes (Scene, path, or name of a shipped scene).
///     methods: Names of methods, with parameters; all by default.
///     models: Models (or their files) of learned methods, at most one of a recipe; by default the shipped ones.
///     size: (width, height), pixels.
///     views: The first N views of each scene; all by default.
///     frames: Timed frames per method and view; 0 times the compared frame.
///     samples: Samples a pixel, 1 or 4.
///     adapter: "auto", "software", or a part of an adapter's name.
///     progress: A progress bar of the tqdm protocol, or True for tqdm's own; it counts frames.
///
/// Returns:
///     A pandas DataFrame with a row for each method, scene and view; where pandas is not installed, a dict from column
///     to list. Columns are those of the command's results.json: `mse_linear` (1), `psnr` (dB), `time_ms` (milliseconds),
///     `bytes_per_pixel`, ….
#[pyfunction]
#[pyo3(signature = (scenes, methods=None, *, models=None, size=(1024, 768), views=None, frames=5, samples=1, adapter="auto", progress=None))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn bench<'py>(
    py: Python<'py>,
    scenes: &Bound<'py, PyAny>,
    methods: Option<Vec<String>>,
    models: Option<Vec<Bound<'py, PyAny>>>,
    size: (u32, u32),
    views: Option<usize>,
    frames: u32,
    samples: u32,
    adapter: &str,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let models = models.unwrap_or_default();
    let models = models.iter().map(|model| Ok(load::<Model>(model)?.0));
    let plan = Plan {
        samples: sampled(samples)?,
        // Of all methods, those that this adapter cannot draw are left out.
        lenient: methods.is_none(),
        views,
        frames,
        ..Plan::new(sized(size)?, &[])
    };
    let compared = compared(methods, models.collect::<PyResult<_>>()?)?;
    let scenes = loaded(scenes)?;
    let bench = measured(py, &scenes, &compared, plan, adapter, progress)?;
    let convert = py.import("peelnet._convert")?;
    convert.call_method1("frame", (json::to_python(py, &bench.rows)?,))
}

/// A method that `recommend` names.
#[pyclass(frozen, module = "peelnet", get_all)]
#[derive(Clone)]
pub struct Choice {
    /// The method's name with its parameters.
    method: String,
    /// Geometric mean of its frame times, milliseconds.
    time_ms: f64,
    /// Mean squared error against the exact image, linear light; 0 of exact methods.
    mse_linear: f64,
    /// Bytes per pixel in the view that needs most.
    bytes_per_pixel: f64,
}

impl From<&Point> for Choice {
    fn from(p: &Point) -> Self {
        Self {
            method: p.method.clone(),
            time_ms: p.time_ms,
            mse_linear: p.mse(),
            bytes_per_pixel: p.bytes.most,
        }
    }
}

#[pymethods]
impl Choice {
    fn __repr__(&self) -> String {
        format!(
            "Choice({}, {:.2} ms, MSE {:.2e})",
            self.method, self.time_ms, self.mse_linear
        )
    }
}

/// What `recommend` answers.
#[pyclass(frozen, module = "peelnet", get_all)]
pub struct Recommendation {
    /// The Choice to take.
    best: Choice,
    /// The next best Choice, or None.
    runner_up: Option<Choice>,
    /// Why, in one sentence.
    why: String,
}

#[pymethods]
impl Recommendation {
    fn __repr__(&self) -> String {
        format!("Recommendation({}: {})", self.best.method, self.why)
    }
}

/// Rows of earlier results: what `bench` returned, or a folder or results.json that the command wrote.
fn rows_of(results: &Bound<'_, PyAny>) -> PyResult<Vec<Row>> {
    if let Ok(path) = results.extract::<PathBuf>() {
        let read = Results::<Bench>::read(&path).map_err(raised)?;
        return Ok(read.measured.rows);
    }
    let convert = results.py().import("peelnet._convert")?;
    let text: String = convert.call_method1("text", (results,))?.extract()?;
    // Rows are checked where they are those of a bench.
    let read = serde_json::from_str::<Bench>(&format!("{{\"rows\": {text}}}"));
    let read = read.map_err(|e| failed(format!("results: not what bench returns: {e}")))?;
    Ok(read.rows)
}

/// Recommends the method for a budget of time, error or memory.
///
/// Args:
///     scene: A Scene, a path, or the name of a shipped scene.
///     budget_ms: Longest frame time, milliseconds.
///     max_error: Largest mean squared error against the exact image, linear light.
///     max_bytes: Most bytes per pixel, in addition to the colour target.
///     results: What `bench` returned, or a folder or results.json of the command; without it all methods are measured now.
///     size: (width, height), pixels, if measured now.
///     frames: Timed frames per method and view, if measured now.
///     adapter: "auto", "software", or a part of an adapter's name.
///     progress: A progress bar of the tqdm protocol, or True for tqdm's own.
///
/// With `max_error` the fastest method within that error is recommended, otherwise the most accurate one within the other
/// bounds; without any bound, the fastest exact method.
#[pyfunction]
#[pyo3(signature = (scene, *, budget_ms=None, max_error=None, max_bytes=None, results=None, size=(1024, 768), frames=3, adapter="auto", progress=None))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn recommend<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    budget_ms: Option<f64>,
    max_error: Option<f64>,
    max_bytes: Option<f64>,
    results: Option<Bound<'py, PyAny>>,
    size: (u32, u32),
    frames: u32,
    adapter: &str,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Recommendation> {
    for (name, bound) in [
        ("budget_ms", budget_ms),
        ("max_error", max_error),
        ("max_bytes", max_bytes),
    ] {
        if bound.is_some_and(|x| !(x > 0.0 && x.is_finite())) {
            return Err(wrong(format!("{name} is not a number above 0")));
        }
    }
    let scene = load::<Scene>(scene)?.scene;
    let rows = match results {
        Some(results) => rows_of(&results)?,
        None => {
            let plan = Plan {
                lenient: true,
                frames,
                ..Plan::new(sized(size)?, &[])
            };
            let scenes = std::slice::from_ref(&*scene);
            let compared = compared(None, Vec::new())?;
            measured(py, scenes, &compared, plan, adapter, progress)?.rows
        }
    };
    let found = points_for(&rows, &scene);
    found.warning.iter().try_for_each(|text| warn(py, text))?;
    let budget = Budget {
        ms: budget_ms,
        error: max_error,
        bytes: max_bytes,
    };
    let chosen = budget.choose(&found.points).map_err(failed)?;
    Ok(Recommendation {
        best: chosen.best.into(),
        runner_up: chosen.runner_up.map(Choice::from),
        why: chosen.why,
    })
}
