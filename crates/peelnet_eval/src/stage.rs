//! Scenes on the GPU and methods that draw them, frames in turn, and what is reported of both.

use crate::{EvalError, compare::EXACT};
use peelnet_gpu::Gpu;
use peelnet_render::{Frame, MethodOptions, MethodSpec, Prepared, Profile, RenderError, Renderer};
use peelnet_scene::{Camera, Scene};
use std::sync::atomic::{AtomicBool, Ordering};

/// What a measurement reports.
#[allow(missing_docs, reason = "each variant names its fields")]
#[derive(Debug)]
pub enum Progress<'a> {
    /// Frame `done` of at most `total` (0 where that is not known) was drawn.
    Drawn {
        done: u64,
        total: u64,
        scene: &'a str,
        method: &'a str,
    },
    /// A method needs more than the adapter allows and is left out of a scene from here on, and why.
    LeftOut {
        scene: &'a str,
        method: &'a str,
        why: String,
    },
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
    pub report: &'a mut dyn FnMut(Progress<'_>),
}

impl<'a> Watch<'a> {
    pub fn new(total: u64, stop: &'a AtomicBool, report: &'a mut dyn FnMut(Progress<'_>)) -> Self {
        Self {
            done: 0,
            total,
            stop,
            report,
        }
    }

    /// What a loop over frames asks before each.
    pub fn check(&self) -> Result<(), EvalError> {
        check_stop(self.stop)
    }

    pub fn drawn(&mut self, scene: &str, method: &str) {
        self.done += 1;
        let (done, total) = (self.done, self.total);
        (self.report)(Progress::Drawn {
            done,
            total,
            scene,
            method,
        });
    }

    pub fn left_out(&mut self, scene: &str, method: &str, why: String) {
        (self.report)(Progress::LeftOut { scene, method, why });
    }
}

/// A scene on the GPU. Errors name it and the method.
#[derive(Debug)]
pub(crate) struct Stage<'a> {
    pub scene: &'a Scene,
    pub renderer: Renderer,
}

/// A method ready to draw a scene.
#[derive(Debug)]
pub(crate) struct Ready {
    pub name: String,
    pub prepared: Prepared,
}

/// The method that judges all others.
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

    pub fn failed(&self, method: &str) -> impl FnOnce(RenderError) -> EvalError + use<> {
        EvalError::render(&self.scene.name, method)
    }

    pub fn ready(&self, method: &MethodSpec, options: MethodOptions) -> Result<Ready, EvalError> {
        self.prepare(&method.to_string(), |r| r.method(method, options))
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
}

/// Times of frames that are drawn in turn, so that whatever else the machine does affects all alike; the first `warm_up` of each do not
/// count.
pub(crate) fn in_turn(
    all: &mut [(&Stage<'_>, &mut Ready)],
    camera: &Camera,
    warm_up: u32,
    frames: u32,
    watch: &mut Watch<'_>,
) -> Result<Vec<Vec<Profile>>, EvalError> {
    let mut found = vec![Vec::new(); all.len()];
    for number in 0..warm_up + frames {
        for ((stage, ready), found) in all.iter_mut().zip(&mut found) {
            watch.check()?;
            let frame = stage.renderer.profile(&mut ready.prepared, camera);
            let frame = frame.map_err(stage.failed(&ready.name))?;
            if number >= warm_up {
                found.push(frame);
            }
            watch.drawn(&stage.scene.name, &ready.name);
        }
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
