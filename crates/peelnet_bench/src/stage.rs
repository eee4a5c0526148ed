//! Scenes on the GPU and methods that draw them, frames in turn, and what is reported of both.

use crate::EvalError;
use glam::Vec3;
use peelnet_core::files::{counted, printable};
use peelnet_render::gpu::Gpu;
use peelnet_render::{
    Frame, Image, MethodOptions, MethodSpec, Prepared, Profile, RenderError, Renderer,
};
use peelnet_scene::{Camera, Scene};
use std::sync::atomic::{AtomicBool, Ordering};

/// What all others are compared with.
pub const EXACT: &str = peelnet_render::role::REFERENCE;

#[derive(Debug)]
pub enum Progress {
    /// Frame `done` of at most `total` (0 where that is not known) was drawn: of which scene, with which method.
    Drawn { done: u64, total: u64, what: String },
    /// A method needs more than the adapter allows and is left out of a scene from here on: which, and why.
    LeftOut(String),
}

pub(crate) fn check_stop(stop: &AtomicBool) -> Result<(), EvalError> {
    match stop.load(Ordering::Relaxed) {
        true => Err(EvalError::Interrupted),
        false => Ok(()),
    }
}

/// Counts frames, reports them, and ends the measurement where the user asks for it.
pub(crate) struct Watch<'a> {
    pub done: u64,
    pub total: u64,
    pub stop: &'a AtomicBool,
    pub report: &'a mut dyn FnMut(Progress),
}

impl<'a> Watch<'a> {
    pub fn new(total: u64, stop: &'a AtomicBool, report: &'a mut dyn FnMut(Progress)) -> Self {
        Self {
            done: 0,
            total,
            stop,
            report,
        }
    }

    pub fn check(&self) -> Result<(), EvalError> {
        check_stop(self.stop)
    }

    pub fn drawn(&mut self, scene: &str, method: &str) {
        self.done += 1;
        (self.report)(Progress::Drawn {
            done: self.done,
            total: self.total,
            what: format!("{scene} with {method}"),
        });
    }

    pub fn left_out(&mut self, scene: &str, method: &str, why: &str) {
        let what = format!("{method} is left out of {scene}: {why}");
        (self.report)(Progress::LeftOut(what));
    }
}

/// A scene on the GPU. Errors name it and the method.
pub(crate) struct Stage<'a> {
    pub scene: &'a Scene,
    pub renderer: Renderer,
}

pub(crate) struct Ready {
    pub name: String,
    pub prepared: Prepared,
}

/// At the origin, looking along −z, 90° high.
pub(crate) fn camera([near, far]: [f32; 2]) -> Camera {
    Camera {
        position: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        fov_y_degrees: 90.0,
        near,
        far,
    }
}

/// Two triangles from a left to a right place and from a low to a high one.
pub(crate) fn rectangle<X: Copy, Y: Copy>(
    [left, right]: [X; 2],
    [low, high]: [Y; 2],
    vertex: impl Fn(X, Y) -> Vec3,
) -> [[Vec3; 3]; 2] {
    let corner = vertex(left, low);
    let across = vertex(right, high);
    [
        [corner, vertex(right, low), across],
        [corner, across, vertex(left, high)],
    ]
}

pub(crate) fn exact_method() -> MethodSpec {
    EXACT.parse().expect("it is in the list of methods")
}

impl<'a> Stage<'a> {
    pub fn new(gpu: &Gpu, scene: &'a Scene) -> Result<Self, EvalError> {
        let renderer = Renderer::new(gpu, scene);
        Ok(Self {
            renderer: renderer.map_err(EvalError::render(&scene.name, "upload"))?,
            scene,
        })
    }

    pub fn failed(&self, method: &str) -> impl FnOnce(RenderError) -> EvalError {
        EvalError::render(&self.scene.name, method)
    }

    pub fn ready(&self, method: &MethodSpec, options: MethodOptions) -> Result<Ready, EvalError> {
        self.prepare(&method.to_string(), |r| r.method(method, options))
    }

    /// Which surfaces each pixel shows.
    pub fn surfaces(&self, size: [u32; 2], samples: u32) -> Result<Ready, EvalError> {
        self.prepare("surfaces", |renderer| renderer.surfaces(size, samples))
    }

    /// Something else to draw, with the name that errors give it.
    pub fn prepare(
        &self,
        name: &str,
        prepare: impl FnOnce(&Renderer) -> Result<Prepared, RenderError>,
    ) -> Result<Ready, EvalError> {
        let prepared = prepare(&self.renderer).map_err(self.failed(name))?;
        let name = name.to_owned();
        Ok(Ready { name, prepared })
    }

    pub fn image(&self, ready: &mut Ready, camera: &Camera) -> Result<Frame, EvalError> {
        let frame = self.renderer.image(&mut ready.prepared, camera);
        frame.map_err(self.failed(&ready.name))
    }

    /// Refuses an exact image that is not finite: nothing can be compared with it.
    pub fn check_exact(&self, image: &Image) -> Result<(), EvalError> {
        let other = image.non_finite();
        if other == 0 {
            return Ok(());
        }
        Err(EvalError::Unusable(format!(
            "scene '{}': {} of the exact image are not finite, so that nothing can be compared with it; lower emission, light and background",
            printable(&self.scene.name),
            counted(other as u64, "pixel")
        )))
    }

    /// The image of a view by a method that draws nothing else.
    pub fn draw(
        &self,
        method: &MethodSpec,
        options: MethodOptions,
        camera: &Camera,
    ) -> Result<Image, EvalError> {
        let mut ready = self.ready(method, options)?;
        Ok(self.image(&mut ready, camera)?.image)
    }
}

/// How long frames are drawn before they are timed: a GPU at rest runs at a sixth of its clock, and takes a tenth of a second to raise it.
const WARM_UP_MICROS: f64 = 5e5;

/// Times of frames that are drawn in turn, so that whatever else the machine does affects all alike. Before them each is drawn at least once
/// to warm up.
pub(crate) fn in_turn(
    all: &mut [(&Stage<'_>, &mut Ready)],
    camera: &Camera,
    frames: u32,
    watch: &mut Watch<'_>,
) -> Result<Vec<Vec<Profile>>, EvalError> {
    let mut found = vec![Vec::new(); all.len()];
    let mut warmed = 0.0;
    let mut done = 0;
    while done < frames {
        let is_warm = warmed >= WARM_UP_MICROS || all.is_empty();
        for ((stage, ready), found) in all.iter_mut().zip(&mut found) {
            watch.check()?;
            let frame = stage.renderer.profile(&mut ready.prepared, camera);
            let frame = frame.map_err(stage.failed(&ready.name))?;
            if is_warm {
                found.push(frame);
                watch.drawn(&stage.scene.name, &ready.name);
            } else {
                warmed += frame.wall_micros;
            }
        }
        done += u32::from(is_warm);
    }
    Ok(found)
}

/// A fraction of the values is no larger (nearest rank); `None` of nothing.
pub(crate) fn percentile(values: impl IntoIterator<Item = f64>, fraction: f64) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let rank = (fraction * values.len() as f64).ceil() as usize;
    values.get(rank.max(1) - 1).copied()
}
