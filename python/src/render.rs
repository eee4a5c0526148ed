//! Frames as numpy arrays.

use crate::{
    argument::load,
    failure::{raised, warn, wrong},
    gpu,
    model::Model,
    scene::{Camera, Scene},
    watch::{Reporter, watch},
};
use numpy::{IntoPyArray as _, PyArrayMethods as _};
use peelnet::{
    Failure, MethodOptions, MethodSpec, Renderer, model_for,
    render::{Frame, METHODS},
    view_of, weight_of,
};
use pyo3::prelude::*;

/// The size of a frame, checked.
pub fn sized(size: (u32, u32)) -> PyResult<[u32; 2]> {
    if size.0 == 0 || size.1 == 0 {
        return Err(wrong("a frame needs at least 1x1 pixels"));
    }
    Ok(size.into())
}

/// Samples a pixel, checked.
pub fn sampled(samples: u32) -> PyResult<u32> {
    match samples {
        1 | 4 => Ok(samples),
        n => Err(wrong(format!("a pixel has 1 or 4 samples, not '{n}'"))),
    }
}

pub fn method(name: &str) -> PyResult<MethodSpec> {
    name.parse().map_err(raised)
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
    scene: &Bound<'py, PyAny>,
    method: &str,
    size: (u32, u32),
    view: Option<u32>,
    camera: Option<Bound<'py, Camera>>,
    time: Option<f32>,
    samples: u32,
    model: Option<Bound<'py, PyAny>>,
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
    let mut scene = load::<Scene>(scene)?;
    if let Some(time) = time {
        scene = scene.at(py, time)?;
    }
    let scene = scene.scene;
    let camera = match (view, camera) {
        (Some(_), Some(_)) => return Err(wrong("view and camera exclude each other")),
        (None, Some(camera)) => camera.get().0,
        (view, None) => *view_of(&scene, view.unwrap_or(0)).map_err(raised)?,
    };
    let given = model.map(|model| load::<Model>(&model)).transpose()?;
    let model = model_for(&spec, given.map(|model| model.0)).map_err(raised)?;
    let gpu = gpu::open(py, adapter)?;
    let draw = || -> Result<Frame, Failure> {
        let learned = model.map(|m| weight_of(&gpu, &m)).transpose()?;
        let renderer = Renderer::new(&gpu, &scene)?;
        let options = MethodOptions::sized(size).sampled(samples);
        let mut prepared = renderer.method(&spec, options.with(learned.as_ref()))?;
        Ok(renderer.image(&mut prepared, &camera)?)
    };
    let frame = watch(py, |_, _: &Reporter<()>| draw(), |_, ()| Ok(()))?;
    for warning in frame.warnings() {
        warn(py, &format!("{spec}: {warning}"))?;
    }
    let (shape, image) = ([size[1] as usize, size[0] as usize, 4], frame.image);
    if dtype == "float32" {
        // The renderer's memory becomes numpy's.
        let array = image.pixels.into_flattened().into_pyarray(py);
        return Ok(array.reshape(shape)?.into_any());
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
    Ok(bytes.into_pyarray(py).reshape(shape)?.into_any())
}

/// The names of all methods, which `render` and `bench` take; of those with a number in their name (`kbuffer-8`) one setting.
#[pyfunction]
pub fn methods() -> Vec<String> {
    let one = |method| MethodSpec::representative(method).to_string();
    METHODS.iter().map(one).collect()
}
