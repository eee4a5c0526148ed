//! Measurements: error against time, and what to choose.

use crate::{
    failure::{failed, raised, warn, wrong},
    gpu, json,
    model::ModelArg,
    render::{method, sampled, sized, text_of},
    scene::{SceneArg, SceneArgs},
    watch::{Bar, Reporter, watch},
};
use peelnet::{
    Gpu, LearnedWeight, MethodSpec, Model, Recipe, Scene,
    bench::{
        Partial, Row,
        bench::{Bench, Progress, bench_watched},
        compare::Plan,
        front::{BASE, Mean, Point, points},
        recommend::Budget,
    },
    model::ModelError,
    report::Results,
};
use pyo3::{
    prelude::*,
    types::{PyDict, PyList, PyTuple},
};
use std::{path::PathBuf, sync::atomic::AtomicBool};

enum Said {
    Drawn(u64, u64, String),
    LeftOut(String),
}

struct Measure {
    size: [u32; 2],
    samples: u32,
    views: Option<usize>,
    frames: u32,
    methods: Vec<MethodSpec>,
    models: Vec<Model>,
    /// Whether methods that this adapter cannot draw are left out.
    lenient: bool,
}

impl Measure {
    /// What to compare: the methods named, or all; with the shipped networks where none is given.
    fn new(named: Option<Vec<String>>, models: Vec<Model>) -> PyResult<Self> {
        for (i, model) in models.iter().enumerate() {
            if models[..i]
                .iter()
                .any(|m| m.meta.recipe == model.meta.recipe)
            {
                return Err(wrong(format!(
                    "models: a second model of recipe {}; one run compares one of each",
                    model.meta.recipe
                )));
            }
        }
        let lenient = named.is_none();
        let mut models = models;
        let mut methods: Vec<MethodSpec> = match named {
            Some(names) => names.iter().map(|n| method(n)).collect::<PyResult<_>>()?,
            None => MethodSpec::compared(),
        };
        for recipe in Recipe::ALL {
            let wanted = methods.iter().any(|m| m.name() == recipe.method);
            if !wanted || models.iter().any(|m| m.meta.recipe == recipe) {
                continue;
            }
            match Model::shipped(recipe) {
                Ok(model) => models.push(model),
                Err(ModelError::NotShipped(_)) if lenient => {
                    methods.retain(|m| m.name() != recipe.method);
                }
                Err(e) => return Err(raised(e)),
            }
        }
        let drawn_with = models.iter().map(|m| m.meta.recipe.method);
        for name in drawn_with.chain([BASE]) {
            if !methods.iter().any(|m| m.name() == name) {
                methods.push(method(name)?);
            }
        }
        Ok(Self {
            size: [1024, 768],
            samples: 1,
            views: None,
            frames: 5,
            methods,
            models,
            lenient,
        })
    }

    fn run(
        &self,
        gpu: &Gpu,
        scenes: &[Scene],
        stop: &AtomicBool,
        reporter: &Reporter<Said>,
    ) -> PyResult<Bench> {
        let learned: Vec<LearnedWeight> = self
            .models
            .iter()
            .map(|model| text_of(gpu, model))
            .collect::<Result<_, _>>()
            .map_err(raised)?;
        let plan = Plan {
            size: self.size,
            samples: self.samples,
            methods: &self.methods,
            learned: &learned,
            models: &self.models,
            lenient: self.lenient,
            views: self.views,
            frames: self.frames,
            images: None,
        };
        let partial = Partial::new(None, serde_json::Value::Null);
        let mut show = |event: Progress<'_>| match event {
            Progress::Drawn {
                done,
                total,
                scene,
                method,
            } => reporter.say(Said::Drawn(done, total, format!("{scene} with {method}"))),
            Progress::LeftOut { scene, method, why } => {
                reporter.ask(Said::LeftOut(format!(
                    "{method} is left out of {scene}: {why}"
                )));
            }
        };
        bench_watched(gpu, scenes, &plan, partial, stop, &mut show).map_err(raised)
    }

    fn watched<'py>(
        &self,
        py: Python<'py>,
        scenes: &[Scene],
        adapter: &str,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bench> {
        let gpu = gpu::open(py, adapter)?;
        let mut bar = Bar::new(progress)?;
        let result = watch(
            py,
            |stop, reporter| self.run(&gpu, scenes, stop, reporter),
            |py, said| match said {
                Said::Drawn(done, total, text) => bar.set(done, total, &text),
                Said::LeftOut(text) => warn(py, &text),
            },
        )
        .and_then(|result| result);
        bar.close(result)
    }
}

fn loaded(models: Option<Vec<ModelArg>>) -> PyResult<Vec<Model>> {
    let models = models.unwrap_or_default().into_iter();
    models.map(ModelArg::load).collect()
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
    scenes: SceneArgs,
    methods: Option<Vec<String>>,
    models: Option<Vec<ModelArg>>,
    size: (u32, u32),
    views: Option<usize>,
    frames: u32,
    samples: u32,
    adapter: &str,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let measure = Measure {
        size: sized(size)?,
        samples: sampled(samples)?,
        views,
        frames,
        ..Measure::new(methods, loaded(models)?)?
    };
    let scenes = scenes.load(py)?;
    let bench = measure.watched(py, &scenes, adapter, progress)?;
    frame(py, &json::to_python(py, &bench.rows)?)
}

/// Records as a DataFrame, or as a dict of columns without pandas.
fn frame<'py>(py: Python<'py>, records: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    match py.import("pandas") {
        Ok(pandas) => pandas.getattr("DataFrame")?.call1((records,)),
        Err(e) if e.is_instance_of::<pyo3::exceptions::PyImportError>(py) => {
            let columns = PyDict::new(py);
            for record in records.try_iter()? {
                for (name, value) in record?.cast::<PyDict>()? {
                    match columns.get_item(&name)? {
                        Some(column) => drop(column.call_method1("append", (value,))?),
                        None => columns.set_item(name, [value].to_vec())?,
                    }
                }
            }
            Ok(columns.into_any())
        }
        Err(e) => Err(e),
    }
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

/// Pandas keeps counts as floats where one of them is missing.
fn integer(value: serde_json::Value) -> serde_json::Value {
    let whole = value
        .as_f64()
        .filter(|x| x.fract() == 0.0 && x.abs() < 9e15);
    whole.map_or(value, |x| (x as i64).into())
}

/// Rows of earlier results: what `bench` returned, or a folder or results.json that the command wrote.
fn rows_of(results: &Bound<'_, PyAny>) -> PyResult<Vec<Row>> {
    let py = results.py();
    if let Ok(path) = results.extract::<PathBuf>() {
        let file = if path.is_dir() {
            path.join("results.json")
        } else {
            path
        };
        let read = Results::<Bench>::read(&file).map_err(raised)?;
        return Ok(read.measured.rows);
    }
    let unlike = |e: serde_json::Error| failed(format!("results: not what bench returns: {e}"));
    let text: String = if results.hasattr("to_json")? {
        // A DataFrame: its NaN becomes null again.
        let options = PyDict::new(py);
        options.set_item("orient", "records")?;
        options.set_item("double_precision", 15)?;
        results
            .call_method("to_json", (), Some(&options))?
            .extract()?
    } else {
        let records = match results.cast::<PyDict>() {
            Ok(columns) => records(columns)?,
            Err(_) => results.clone(),
        };
        py.import("json")?
            .call_method1("dumps", (records,))?
            .extract()?
    };
    let records: Vec<serde_json::Map<String, serde_json::Value>> =
        serde_json::from_str(&text).map_err(unlike)?;
    let whole = records.into_iter().map(|record| {
        let fields = record.into_iter();
        serde_json::Value::Object(fields.map(|(name, v)| (name, integer(v))).collect())
    });
    serde_json::from_value(serde_json::Value::Array(whole.collect())).map_err(unlike)
}

/// Columns as a list of records.
fn records<'py>(columns: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
    let py = columns.py();
    let names: Vec<Bound<'py, PyAny>> = columns.keys().iter().collect();
    let zip = py.import("builtins")?.getattr("zip")?;
    let tuples = zip.call1(PyTuple::new(py, columns.values().iter())?)?;
    let records = PyList::empty(py);
    for tuple in tuples.try_iter()? {
        let record = PyDict::new(py);
        for (name, value) in names.iter().zip(tuple?.try_iter()?) {
            record.set_item(name, value?)?;
        }
        records.append(record)?;
    }
    Ok(records.into_any())
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
    scene: SceneArg,
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
    let scene = scene.load(py)?.scene;
    let rows = match results {
        Some(results) => rows_of(&results)?,
        None => {
            let measure = Measure {
                size: sized(size)?,
                frames,
                ..Measure::new(None, Vec::new())?
            };
            let scenes = std::slice::from_ref(&*scene);
            measure.watched(py, scenes, adapter, progress)?.rows
        }
    };
    let mut found = points(&rows, Some(&scene.name), Mean::Geometric);
    if found.is_empty() {
        warn(
            py,
            &format!(
                "scene '{}' is not among the results: judged by the geometric means over all scenes of them",
                scene.name
            ),
        )?;
        found = points(&rows, None, Mean::Geometric);
    }
    let budget = Budget {
        ms: budget_ms,
        error: max_error,
        bytes: max_bytes,
    };
    let chosen = budget.choose(&found).map_err(failed)?;
    Ok(Recommendation {
        best: chosen.best.into(),
        runner_up: chosen.runner_up.map(Choice::from),
        why: chosen.why,
    })
}
