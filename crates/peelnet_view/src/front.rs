//! Error against time of all methods on the present view.

use crate::{
    numbers::{EXACT, Key},
    stage::{Stage, one_line},
    task::{Task, computed},
};
use peelnet_eval::metrics;
use peelnet_render::{MethodOptions, MethodSpec, RenderError, Renderer, milliseconds, of_method};
use std::{cell::RefCell, rc::Rc, sync::Arc};

/// Frames that are timed of each method; the median counts, the first is a warm-up.
const FRAMES: usize = 4;

/// A method on the view.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Point {
    pub method: String,
    /// Mean squared error of encoded values, 0–255 each; 0 of exact methods.
    pub mse255: f64,
    /// GPU time of a frame; by the clock where the adapter has no timestamps.
    pub time_ms: f64,
    pub bytes_per_pixel: f64,
    /// Whether no other method is both faster and at least as accurate.
    pub on_front: bool,
}

/// What is known so far.
#[derive(Debug, Default)]
pub(crate) struct Measured {
    pub points: Vec<Point>,
    /// Methods that could not draw, and why.
    pub left_out: Vec<(String, String)>,
    /// Methods done, and all.
    pub done: usize,
    pub all: usize,
}

/// Measures when asked to.
#[derive(Debug, Default)]
pub(crate) struct Front {
    task: Option<Task<Result<(), String>>>,
    key: Option<Key>,
    pub measured: Rc<RefCell<Measured>>,
    pub failure: Option<String>,
}

impl Front {
    pub const fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    /// Ends the measurement; what was measured stays.
    pub fn cancel(&mut self) {
        self.task = None;
    }

    /// Whether the points are of another view than this.
    pub fn is_of_another(&self, key: &Key) -> bool {
        self.key
            .as_ref()
            .is_some_and(|measured| !measured.has_view_of(key))
    }

    /// Begins anew.
    pub fn measure(&mut self, stage: &Stage, key: Key, size: [u32; 2]) {
        let measured: Rc<RefCell<Measured>> = Rc::default();
        self.measured = Rc::clone(&measured);
        self.failure = None;
        let work = all(Rc::clone(stage.renderer()), key.camera(), size, measured);
        self.key = Some(key);
        self.task = Some(Task::new(work));
    }

    pub fn poll(&mut self, ui: &egui::Context) {
        if let Some(task) = &mut self.task
            && let Some(result) = task.poll(ui)
        {
            self.failure = result.err();
            self.task = None;
        }
    }
}

/// Marks the points that no other is better than.
fn mark(points: &mut [Point]) {
    points.sort_by(|a, b| {
        let times = a.time_ms.total_cmp(&b.time_ms);
        times.then(a.mse255.total_cmp(&b.mse255))
    });
    let mut least = f64::INFINITY;
    for point in points {
        point.on_front = point.mse255 < least;
        least = least.min(point.mse255);
    }
}

async fn all(
    renderer: Rc<Renderer>,
    camera: peelnet_scene::Camera,
    size: [u32; 2],
    measured: Rc<RefCell<Measured>>,
) -> Result<(), String> {
    let exact: MethodSpec = EXACT.parse().map_err(|e: RenderError| one_line(&e))?;
    let mut methods = MethodSpec::curve();
    methods.retain(|m| *m != exact);
    methods.insert(0, exact);
    measured.borrow_mut().all = methods.len();
    let mut judge = None;
    for method in methods {
        let point = point(&renderer, &method, &camera, size, &mut judge).await;
        let mut measured = measured.borrow_mut();
        match point {
            Ok(point) => measured.points.push(point),
            // Nothing can be judged without the exact image.
            Err(e) if judge.is_none() => return Err(e),
            Err(e) => measured.left_out.push((method.to_string(), e)),
        }
        mark(&mut measured.points);
        measured.done += 1;
    }
    Ok(())
}

async fn point(
    renderer: &Renderer,
    method: &MethodSpec,
    camera: &peelnet_scene::Camera,
    size: [u32; 2],
    judge: &mut Option<Arc<peelnet_render::Image>>,
) -> Result<Point, String> {
    let readable = |e: RenderError| one_line(&e);
    let mut prepared = renderer
        .method(method, MethodOptions::sized(size))
        .map_err(readable)?;
    let frame = renderer.image_async(&mut prepared, camera).await;
    let image = Arc::new(frame.map_err(readable)?.image);
    let exact = Arc::clone(judge.get_or_insert_with(|| Arc::clone(&image)));
    let differences = computed(move || metrics::differences(&exact.pixels, &image.pixels)).await;
    let Some(Ok(differences)) = differences else {
        return Err("the comparison failed".into());
    };
    let mut times = Vec::new();
    let mut bytes_per_pixel = 0.0;
    for number in 0..FRAMES {
        let profile = renderer.profile_async(&mut prepared, camera).await;
        let profile = profile.map_err(readable)?;
        bytes_per_pixel = profile.stats.bytes_per_pixel;
        if number > 0 {
            times.push(
                milliseconds(&of_method(&profile.times)).unwrap_or(profile.wall_micros / 1e3),
            );
        }
    }
    times.sort_by(f64::total_cmp);
    Ok(Point {
        method: method.to_string(),
        mse255: differences.mse255,
        time_ms: times[times.len() / 2],
        bytes_per_pixel,
        on_front: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(time_ms: f64, mse255: f64) -> Point {
        Point {
            method: String::new(),
            mse255,
            time_ms,
            bytes_per_pixel: 0.0,
            on_front: false,
        }
    }

    /// Of equally fast methods the more accurate is on the front, of equally accurate ones the faster.
    #[test]
    fn the_front_is_what_nothing_beats() {
        let mut points = [
            point(3.0, 1.0),
            point(1.0, 9.0),
            point(2.0, 9.0),
            point(1.0, 4.0),
            point(4.0, 1.0),
            point(5.0, 0.0),
        ];
        mark(&mut points);
        let on: Vec<(f64, f64)> = points
            .iter()
            .filter(|p| p.on_front)
            .map(|p| (p.time_ms, p.mse255))
            .collect();
        assert_eq!(on, [(1.0, 4.0), (3.0, 1.0), (5.0, 0.0)]);
    }
}
