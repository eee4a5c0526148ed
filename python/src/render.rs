//! Frames as numpy arrays.

use crate::{
    failure::{failed, raised, warn, wrong},
    gpu,
    model::ModelArg,
    scene::{Camera, SceneArg},
    watch::watch,
};
use numpy::{IntoPyArray as _, PyArray3, ndarray::Array3};
use peelnet::{
    Gpu, LearnedWeight, MethodOptions, MethodSpec, Model, Recipe, Renderer, export,
    render::{Frame, METHODS},
};
use peelnet_files::{counted, printable};
use pyo3::prelude::*;

/// The size of a frame, checked.
///
/// # Errors
/// No pixel.
pub fn sized(size: (u32, u32)) -> PyResult<[u32; 2]> {
    if size.0 == 0 || size.1 == 0 {
        return Err(wrong("a frame needs at least 1x1 pixels"));
    }
    Ok(size.into())
}

/// Samples a pixel, checked.
///
/// # Errors
/// Neither 1 nor 4.
pub fn sampled(samples: u32) -> PyResult<u32> {
    match samples {
        1 | 4 => Ok(samples),
        n => Err(wrong(format!("a pixel has 1 or 4 samples, not '{n}'"))),
    }
}

/// A method's name with its parameters.
///
/// # Errors
/// No such method or parameter.
pub fn method(name: &str) -> PyResult<MethodSpec> {
    name.parse().map_err(raised)
}

/// A model's shader text, verified on the GPU.
///
/// # Errors
/// A model that cannot be exported, or a text that computes something else.
pub fn text_of(gpu: &Gpu, model: &Model) -> Result<LearnedWeight, export::ExportError> {
    let wgsl = export::wgsl(model)?;
    export::verify(gpu, model, &wgsl)?;
    Ok(LearnedWeight {
        recipe: model.meta.recipe,
        wgsl,
    })
}

/// The model that a method draws with: the one given, or the shipped one; none for a method that needs none.
fn model_of(method: &MethodSpec, model: Option<ModelArg>) -> PyResult<Option<Model>> {
    if !method.needs_model() {
        return match model {
            None => Ok(None),
            Some(_) => Err(wrong(format!(
                "method {} draws without a network; leave model out, or choose a learned method",
                method.name()
            ))),
        };
    }
    let recipe = Recipe::of_method(method.name())
        .ok_or_else(|| failed(format!("method {} belongs to no recipe", method.name())))?;
    let model = match model {
        None => Model::shipped(recipe).map_err(raised)?,
        Some(model) => model.load()?,
    };
    if model.meta.recipe != recipe {
        return Err(wrong(format!(
            "the model's recipe is {}, but method {} draws with recipe {recipe}; use method {}",
            model.meta.recipe,
            method.name(),
            model.meta.recipe.method
        )));
    }
    Ok(Some(model))
}

fn draw(
    gpu: &Gpu,
    scene: &peelnet::Scene,
    camera: &peelnet::Camera,
    method: &MethodSpec,
    model: Option<&Model>,
    (size, samples): ([u32; 2], u32),
) -> PyResult<Frame> {
    let learned = model.map(|m| text_of(gpu, m)).transpose().map_err(raised)?;
    let renderer = Renderer::new(gpu, scene).map_err(raised)?;
    let options = MethodOptions::sized(size)
        .sampled(samples)
        .with(learned.as_ref());
    let mut prepared = renderer.method(method, options).map_err(raised)?;
    renderer.image(&mut prepared, camera).map_err(raised)
}

/// Draws one frame of a scene with one method.
///
/// Args:
///     scene: A Scene, a path, or the name of a shipped scene.
///     method: A name of `methods()`; parameters follow a colon, as in "mboit4:targets=f16". The default is exact.
///     size: (width, height), pixels.
///     view: Which view of the scene, from 0.
///     camera: A camera instead of the scene's view.
///     time: Time in the scene's timeline.
///     samples: Samples a pixel, 1 or 4; a frame of 4 is drawn four times.
///     model: The Model (or its file) of a learned method; by default the shipped one.
///     dtype: "float32" or "uint8".
///     adapter: "auto", "software", or a part of an adapter's name.
///
/// Returns:
///     An array of shape (height, width, 4). "float32": linear red, green, blue, and coverage 1 − T (0 … 1), as the
///     command's .npy and .exr files have them. "uint8": sRGB-encoded red, green, blue as in its .png files, and
///     coverage · 255.
#[pyfunction]
#[pyo3(signature = (scene, method="abuffer", *, size=(1024, 768), view=None, camera=None, time=None, samples=1, model=None, dtype="float32", adapter="auto"))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn render<'py>(
    py: Python<'py>,
    scene: SceneArg,
    method: &str,
    size: (u32, u32),
    view: Option<u32>,
    camera: Option<Bound<'py, Camera>>,
    time: Option<f32>,
    samples: u32,
    model: Option<ModelArg>,
    dtype: &str,
    adapter: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let (size, samples) = (sized(size)?, sampled(samples)?);
    let spec = self::method(method)?;
    if !matches!(dtype, "float32" | "uint8") {
        return Err(wrong(format!(
            "dtype '{dtype}': there are float32 and uint8"
        )));
    }
    let mut scene = scene.load(py)?;
    if let Some(time) = time {
        scene = scene.at(py, time)?;
    }
    let scene = scene.scene;
    let camera = match (view, camera) {
        (Some(_), Some(_)) => return Err(wrong("view and camera exclude each other")),
        (None, Some(camera)) => camera.get().0,
        (view, None) => {
            let view = view.unwrap_or(0);
            *scene.views.get(view as usize).ok_or_else(|| {
                let views = counted(scene.views.len() as u64, "view");
                let name = printable(&scene.name);
                wrong(format!("view {view}: {name} has {views}, numbered from 0"))
            })?
        }
    };
    let model = model_of(&spec, model)?;
    let gpu = gpu::open(py, adapter)?;
    let frame = watch(
        py,
        |_, _: &crate::watch::Reporter<()>| {
            draw(
                &gpu,
                &scene,
                &camera,
                &spec,
                model.as_ref(),
                (size, samples),
            )
        },
        |_, ()| Ok(()),
    )??;
    for (what, count) in [
        ("fragment", frame.stats.lost),
        ("pixel", frame.image.non_finite() as u64),
    ] {
        if count > 0 {
            let why = if what == "pixel" {
                "not finite"
            } else {
                "not in the image"
            };
            warn(py, &format!("{spec}: {why}: {}", counted(count, what)))?;
        }
    }
    let shape = (size[1] as usize, size[0] as usize, 4);
    array(py, shape, frame.image, dtype)
}

fn array<'py>(
    py: Python<'py>,
    shape: (usize, usize, usize),
    image: peelnet::render::Image,
    dtype: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let wrong_shape = |e: numpy::ndarray::ShapeError| failed(e.to_string());
    if dtype == "float32" {
        // The renderer's memory becomes numpy's.
        let array = Array3::from_shape_vec(shape, image.pixels.into_flattened());
        let array: Bound<'py, PyArray3<f32>> = array.map_err(wrong_shape)?.into_pyarray(py);
        return Ok(array.into_any());
    }
    let rgb = image.to_srgb8();
    let (colors, _) = rgb.as_chunks::<3>();
    let bytes: Vec<u8> = colors
        .iter()
        .zip(&image.pixels)
        .flat_map(|([r, g, b], pixel)| {
            [*r, *g, *b, (pixel[3].clamp(0.0, 1.0) * 255.0).round() as u8]
        })
        .collect();
    let array = Array3::from_shape_vec(shape, bytes).map_err(wrong_shape)?;
    Ok(array.into_pyarray(py).into_any())
}

/// The names of all methods, which `render` and `bench` take; of those with a number in their name (`kbuffer-8`) one setting.
#[pyfunction]
pub fn methods() -> Vec<String> {
    let one = |method| MethodSpec::representative(method).to_string();
    METHODS.iter().map(one).collect()
}
