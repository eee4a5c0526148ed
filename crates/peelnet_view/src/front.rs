//! Error against time of all methods on the present view.

use crate::{
    numbers::EXACT,
    slot::Shot,
    stage::{Stage, View},
    task::{Fallible, Job, computed, one_line},
};
use peelnet_bench::metrics;
use peelnet_render::{Image, MethodOptions, MethodSpec, Renderer, milliseconds, of_method};
use std::{cell::RefCell, rc::Rc, sync::Arc};

/// Frames that are timed of each method; the median counts, the first is a warm-up.
const FRAMES: usize = 4;

#[derive(Clone)]
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

#[derive(Default)]
pub(crate) struct Measured {
    pub points: Vec<Point>,
    /// Methods that could not draw, and why.
    pub left_out: Vec<(String, String)>,
    /// Methods to measure.
    pub all: usize,
}

/// Measures when asked to; what was measured stays when it is cancelled.
#[derive(Default)]
pub(crate) struct Front {
    pub job: Job<(), ()>,
    pub view: Option<View>,
    pub measured: Rc<RefCell<Measured>>,
}

impl Front {
    pub fn measure(&mut self, stage: &Stage, view: View) {
        *self = Self::default();
        self.view = Some(view);
        let work = all(Rc::clone(&stage.renderer), view, Rc::clone(&self.measured));
        self.job.begin((), work);
    }
}

async fn all(renderer: Rc<Renderer>, view: View, measured: Rc<RefCell<Measured>>) -> Fallible<()> {
    let exact: MethodSpec = EXACT.parse()?;
    let mut methods = MethodSpec::curve();
    methods.retain(|m| *m != exact);
    methods.insert(0, exact);
    measured.borrow_mut().all = methods.len();
    let mut judge = None;
    for spec in methods {
        let method = spec.to_string();
        let shot = Shot {
            renderer: Rc::clone(&renderer),
            spec,
            options: MethodOptions::sized(view.size),
        };
        let point = point(&shot, &view, &mut judge).await;
        let mut measured = measured.borrow_mut();
        match point {
            Ok(point) => measured.points.push(point),
            // Nothing can be judged without the exact image.
            Err(e) if judge.is_none() => return Err(e),
            Err(e) => measured.left_out.push((method, one_line(&*e))),
        }
        let of = |p: &Point| [p.time_ms, p.mse255];
        metrics::mark_front(&mut measured.points, of, |p, on| p.on_front = on);
    }
    Ok(())
}

async fn point(shot: &Shot, view: &View, judge: &mut Option<Arc<Image>>) -> Fallible<Point> {
    let (renderer, camera) = (&shot.renderer, &view.camera);
    let mut prepared = renderer.method(&shot.spec, shot.options.clone())?;
    let frame = renderer.image_async(&mut prepared, camera).await?;
    let image = Arc::new(frame.image);
    let exact = Arc::clone(judge.get_or_insert_with(|| Arc::clone(&image)));
    let compared = computed(move || metrics::differences(&exact.pixels, &image.pixels));
    let differences = compared.await?;
    let mut times = Vec::new();
    let mut bytes_per_pixel = 0.0;
    for number in 0..FRAMES {
        let profile = renderer.profile_async(&mut prepared, camera).await?;
        bytes_per_pixel = profile.stats.bytes_per_pixel;
        if number > 0 {
            let gpu_ms = milliseconds(&of_method(&profile.times));
            times.push(gpu_ms.unwrap_or(profile.wall_micros / 1e3));
        }
    }
    times.sort_by(f64::total_cmp);
    Ok(Point {
        method: shot.spec.to_string(),
        mse255: differences.mse255,
        time_ms: times[times.len() / 2],
        bytes_per_pixel,
        on_front: false,
    })
}
