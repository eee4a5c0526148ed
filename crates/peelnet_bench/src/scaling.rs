//! How every method's time and memory grow: with fragments a pixel, with pixels, and with triangles.
//!
//! The scenes are stacks of walls that fill the frame, so that every pixel holds the same number of fragments and one quantity
//! changes at a time.

pub use crate::records::{Exponent, Growth, LeftOut, Scaling, Series};

use crate::{
    EvalError,
    bench::Progress,
    compare::{Plan, method_ms},
    rows::mean,
    stage::{Ready, Stage, Watch, camera, in_turn, percentile, rectangle},
};
use glam::Vec3;
use peelnet_render::MethodOptions;
use peelnet_render::gpu::Gpu;
use peelnet_scene::{Camera, Material, Object, Scene};
use std::sync::atomic::AtomicBool;

/// A method whose frame takes longer is not drawn in the larger steps of that series, milliseconds.
const PATIENCE_MS: f64 = 3000.0;

struct Step {
    series: Series,
    size: [u32; 2],
    layers: u32,
    /// Squares along each side of a wall.
    cells: u32,
}

impl Step {
    fn value(&self) -> u64 {
        match self.series {
            Series::Fragments => self.layers.into(),
            Series::Pixels => u64::from(self.size[0]) * u64::from(self.size[1]),
            Series::Triangles => 2 * u64::from(self.cells).pow(2) * u64::from(self.layers),
        }
    }
}

fn steps() -> Vec<Step> {
    const SIZE: [u32; 2] = [256, 192];
    let step = |series, size, layers, cells| Step {
        series,
        size,
        layers,
        cells,
    };
    let fragments = (0..=8).map(|k| step(Series::Fragments, SIZE, 1 << k, 1));
    let pixels = (0..=4).map(|k| step(Series::Pixels, [64 << k, 48 << k], 8, 1));
    let triangles = (0..=8).step_by(2);
    let triangles = triangles.map(|k| step(Series::Triangles, SIZE, 8, 1 << k));
    fragments.chain(pixels).chain(triangles).collect()
}

/// Measures the methods of a plan in all steps, so many timed frames of each; the steps have their own sizes.
pub fn measure(
    gpu: &Gpu,
    plan: &Plan<'_>,
    stop: &AtomicBool,
    report: &mut dyn FnMut(Progress),
) -> Result<Scaling, EvalError> {
    let (mut rows, mut left_out): (Vec<Growth>, Vec<LeftOut>) = (Vec::new(), Vec::new());
    let (steps, frames, methods) = (steps(), plan.frames.max(1), plan.methods);
    let each = u64::from(frames) + 1;
    let total = (steps.len() * methods.len()) as u64 * each;
    let mut watch = Watch::new(total, stop, report);
    for (k, step) in steps.into_iter().enumerate() {
        let (series, value) = (step.series, step.value());
        let scene = stack(step.layers, step.cells);
        let stage = Stage::new(gpu, &scene)?;
        let camera = &scene.views[0];
        let mut ready: Vec<(Ready, f64)> = Vec::new();
        for method in methods {
            let name = method.to_string();
            let is_slow =
                |r: &Growth| r.method == name && r.series == series && r.time_ms > PATIENCE_MS;
            let why = if rows.iter().any(is_slow) {
                let seconds = PATIENCE_MS / 1e3;
                format!("a frame took longer than {seconds} s before")
            } else {
                let options = MethodOptions {
                    size: step.size,
                    ..plan.options(method)
                };
                // The first frame gives the bytes.
                let first = stage.ready(method, options).and_then(|mut ready| {
                    let frame = stage.image(&mut ready, camera)?;
                    Ok((ready, frame.stats.bytes_per_pixel))
                });
                watch.drawn(&scene.name, &name);
                match first {
                    // Memory is what grows: that it ends is a result.
                    Err(e) if e.is_of_method() => e.reason(),
                    first => {
                        ready.push(first?);
                        continue;
                    }
                }
            };
            left_out.push(LeftOut {
                method: name,
                series,
                value,
                why,
            });
        }
        let mut all: Vec<_> = ready.iter_mut().map(|(r, _)| (&stage, r)).collect();
        let profiles = in_turn(&mut all, camera, frames, &mut watch)?;
        for ((ready, bytes_per_pixel), profiles) in ready.into_iter().zip(&profiles) {
            rows.push(Growth {
                method: ready.name,
                series,
                value,
                time_ms: percentile(profiles.iter().map(method_ms), 0.5).unwrap_or_default(),
                bytes_per_pixel,
            });
        }
        // Those that were left out are done, too.
        watch.done = (k as u64 + 1) * methods.len() as u64 * each;
    }
    Ok(Scaling {
        exponents: exponents(&rows),
        rows,
        left_out,
    })
}

/// Walls that fill the frame, nearest first in the list, so that sorting has something to do.
fn stack(layers: u32, cells: u32) -> Scene {
    let wall = |i: u32| {
        let t = i as f32 / layers as f32;
        // The last layer of the deepest stack is still seen a little.
        let alpha = (2.0 / layers as f32).min(0.5);
        let material = Material::unlit([t, 1.0 - t, 0.5], alpha);
        wall(1.0 + 9.0 * t, cells, material)
    };
    let objects = (0..layers).map(wall).collect();
    let camera = Camera {
        fov_y_degrees: 60.0,
        ..camera([0.1, 100.0])
    };
    let name = format!("stack of {layers} walls of {cells}×{cells} squares");
    Scene::generated(&name, "the bench", [0.2, 0.3, 0.4], camera, objects)
}

fn wall(depth: f32, cells: u32, material: Material) -> Object {
    // The frame is 4:3, and tan 30° is 0.577.
    let half = Vec3::new(0.8 * depth, 0.6 * depth, 0.0);
    let vertex = |x: u32, y: u32| {
        let at = |k: u32| 2.0 * k as f32 / cells as f32 - 1.0;
        Vec3::new(at(x) * half.x, at(y) * half.y, -depth)
    };
    let square = |i: u32| {
        let (x, y) = (i % cells, i / cells);
        rectangle([x, x + 1], [y, y + 1], vertex)
    };
    let triangles: Vec<[Vec3; 3]> = (0..cells * cells).flat_map(square).collect();
    Object::of_triangles(&format!("wall at {depth}"), &triangles, material)
}

/// Exponents of every method and series, by least squares of logarithms over the upper half of the steps: constant costs hide
/// growth in the lower.
pub fn exponents(rows: &[Growth]) -> Vec<Exponent> {
    let mut all: Vec<Exponent> = Vec::new();
    for row in rows {
        let is_same = |method: &str, series| method == row.method && series == row.series;
        if all.iter().any(|e| is_same(&e.method, e.series)) {
            continue;
        }
        let own = rows.iter().filter(|r| is_same(&r.method, r.series));
        let own: Vec<&Growth> = own.collect();
        let upper = &own[own.len() / 2..];
        let fit = |value: &dyn Fn(&Growth) -> f64| {
            slope(upper.iter().map(|r| ((r.value as f64).ln(), value(r).ln())))
        };
        // Of the whole frame, where the frame grows.
        let pixels = |r: &Growth| match r.series {
            Series::Pixels => r.value as f64,
            _ => 1.0,
        };
        all.push(Exponent {
            method: row.method.clone(),
            series: row.series,
            time: fit(&|r| r.time_ms),
            bytes: fit(&|r| r.bytes_per_pixel * pixels(r)),
        });
    }
    all
}

/// Slope of the line nearest to some points; `None` of fewer than two.
fn slope(points: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
    let (mx, my) = (mean(x.iter().copied())?, mean(y.iter().copied())?);
    let xy: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    let xx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    (xx > 0.0).then(|| xy / xx)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// t = n² and bytes = 24 n; a constant cost in the lower steps is not fitted.
    #[test]
    fn powers_are_found() {
        let row = |series, value, time_ms, bytes_per_pixel| Growth {
            method: "x".to_owned(),
            series,
            value,
            time_ms,
            bytes_per_pixel,
        };
        let rows = [1, 2, 4, 8, 16, 32].map(|n: u64| {
            let t = if n < 8 { 50.0 } else { (n * n) as f64 };
            row(Series::Fragments, n, t, 24.0 * n as f64)
        });
        let e = &exponents(&rows)[0];
        assert!((e.time.unwrap() - 2.0).abs() < 1e-9 && (e.bytes.unwrap() - 1.0).abs() < 1e-9);
        // Of the whole frame, where that grows.
        let pixels = [64u64, 256, 1024].map(|n| row(Series::Pixels, n, n as f64, 10.0));
        assert!((exponents(&pixels)[0].bytes.unwrap() - 1.0).abs() < 1e-9);
        assert_eq!(exponents(&rows[..1])[0].time, None);
    }

    /// Every step is what its series says, in order of growth, and the walls have as many triangles.
    #[test]
    fn steps_grow() {
        for series in Series::ALL {
            let own: Vec<Step> = steps().into_iter().filter(|s| s.series == series).collect();
            assert!(own.windows(2).all(|w| w[0].value() < w[1].value()));
            assert!(own.len() >= 5);
        }
        let finer = steps().into_iter();
        for step in finer.filter(|s| s.series == Series::Triangles).take(3) {
            let scene = stack(step.layers, step.cells);
            assert_eq!(scene.triangles() as u64, step.value());
        }
    }
}
