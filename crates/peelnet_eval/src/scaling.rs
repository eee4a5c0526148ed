//! How every method's time and memory grow: with fragments a pixel, with pixels, and with triangles.
//!
//! The scenes are stacks of walls that fill the frame, so that every pixel holds the same number of fragments and one quantity
//! changes at a time.

use crate::{EvalError, check_stop};
use glam::{Mat4, Vec3};
use peelnet_gpu::Gpu;
use peelnet_render::{LearnedWeight, MethodOptions, MethodSpec, Renderer};
use peelnet_scene::{Camera, Lighting, Material, Mesh, Object, Part, Scene};
use serde::{Deserialize, Serialize};
use std::{
    fmt,
    sync::{Arc, atomic::AtomicBool},
};

/// A method whose frame takes longer is not drawn in the larger steps of that series, milliseconds.
const PATIENCE_MS: f64 = 3000.0;

/// What grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Series {
    /// Fragments of every pixel, 1 … 256, at 256×192.
    Fragments,
    /// Pixels of the frame, 64×48 … 1024×768, with eight fragments each.
    Pixels,
    /// Triangles, 16 … 2²⁰, with eight fragments a pixel at 256×192.
    Triangles,
}

impl Series {
    /// Every series.
    pub const ALL: [Self; 3] = [Self::Fragments, Self::Pixels, Self::Triangles];
}

impl fmt::Display for Series {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Fragments => "fragments",
            Self::Pixels => "pixels",
            Self::Triangles => "triangles",
        })
    }
}

/// One step of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    let fragments = (0..=8).map(|k| Step {
        series: Series::Fragments,
        size: SIZE,
        layers: 1 << k,
        cells: 1,
    });
    let pixels = (0..=4).map(|k| Step {
        series: Series::Pixels,
        size: [64 << k, 48 << k],
        layers: 8,
        cells: 1,
    });
    let triangles = (0..=8).step_by(2).map(|k| Step {
        series: Series::Triangles,
        size: SIZE,
        layers: 8,
        cells: 1 << k,
    });
    fragments.chain(pixels).chain(triangles).collect()
}

/// What one method took in one step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Growth {
    /// The method's name with its parameters.
    pub method: String,
    /// What grows.
    pub series: Series,
    /// How much of it there is.
    pub value: u64,
    /// Median frame time, milliseconds.
    pub time_ms: f64,
    /// Bytes a pixel.
    pub bytes_per_pixel: f64,
}

/// A step that a method was not measured in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    /// The method's name with its parameters.
    pub method: String,
    /// What grows.
    pub series: Series,
    /// How much of it there is.
    pub value: u64,
    /// Why.
    pub why: String,
}

/// How a method's time and memory grow with a series.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Exponent {
    /// The method's name with its parameters.
    pub method: String,
    /// What grows.
    pub series: Series,
    /// Exponent of the frame time, fitted to the upper half of the steps.
    pub time: Option<f64>,
    /// The same of the bytes of the whole frame.
    pub bytes: Option<f64>,
}

/// A finished measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// Fitted growth.
    pub exponents: Vec<Exponent>,
    /// Every step.
    pub rows: Vec<Growth>,
    /// Steps that methods were not measured in.
    pub left_out: Vec<LeftOut>,
}

/// Measures all steps, so many timed frames of each after one that warms up. `report` is called for each frame with the frames so far, all frames at most, and the method.
///
/// # Errors
/// If a method cannot draw; [`EvalError::Interrupted`] once `stop` is set.
pub fn measure(
    gpu: &Gpu,
    methods: &[MethodSpec],
    learned: &[LearnedWeight],
    frames: u32,
    stop: &AtomicBool,
    report: &mut dyn FnMut(u64, u64, &str),
) -> Result<(Vec<Growth>, Vec<LeftOut>), EvalError> {
    let (mut rows, mut left_out): (Vec<Growth>, Vec<LeftOut>) = (Vec::new(), Vec::new());
    let steps = steps();
    let total = (steps.len() * methods.len() * (frames as usize + 1)) as u64;
    let mut done = 0;
    for step in steps {
        let scene = stack(step.layers, step.cells);
        let failed = |method: &str| EvalError::render(&scene.name, method);
        let renderer = Renderer::new(gpu, &scene).map_err(failed("upload"))?;
        let camera = &scene.views[0];
        let mut ready = Vec::new();
        for method in methods {
            let name = method.to_string();
            let slow = rows
                .iter()
                .any(|r| r.method == name && r.series == step.series && r.time_ms > PATIENCE_MS);
            let mut leave_out = |why: String| {
                left_out.push(LeftOut {
                    method: name.clone(),
                    series: step.series,
                    value: step.value(),
                    why,
                });
            };
            if slow {
                done += u64::from(frames) + 1;
                let seconds = PATIENCE_MS / 1e3;
                leave_out(format!("a frame took longer than {seconds} s before"));
                continue;
            }
            let weight = learned.iter().find(|l| l.recipe.method == method.name());
            // The first frame warms up, and gives the bytes.
            let first = renderer
                .method(method, MethodOptions::sized(step.size).with(weight))
                .and_then(|mut prepared| {
                    let frame = renderer.image(&mut prepared, camera)?;
                    Ok((prepared, frame.stats.bytes_per_pixel))
                });
            done += 1;
            report(done, total, &name);
            match first {
                Ok((prepared, bytes)) => ready.push((name, prepared, bytes, Vec::new())),
                // Memory is what grows: that it ends is a result.
                Err(e) if crate::compare::is_too_large(&e) => {
                    done += u64::from(frames);
                    leave_out(e.to_string());
                }
                Err(e) => return Err(failed(&name)(e)),
            }
        }
        for _ in 0..frames.max(1) {
            for (name, prepared, _, times) in &mut ready {
                check_stop(stop)?;
                let frame = renderer.profile(prepared, camera).map_err(failed(name))?;
                times.push(crate::compare::method_ms(&frame));
                done += 1;
                report(done, total, name);
            }
        }
        for (method, _, bytes_per_pixel, mut times) in ready {
            times.sort_by(f64::total_cmp);
            rows.push(Growth {
                method,
                series: step.series,
                value: step.value(),
                time_ms: times[(times.len() - 1) / 2],
                bytes_per_pixel,
            });
        }
    }
    Ok((rows, left_out))
}

/// Walls that fill the frame, nearest first in the list, so that sorting has something to do.
fn stack(layers: u32, cells: u32) -> Scene {
    let objects = (0..layers)
        .map(|i| {
            let t = i as f32 / layers as f32;
            let material = Material {
                color: [t, 1.0 - t, 0.5],
                // The last layer of the deepest stack is still seen a little.
                alpha: (2.0 / layers as f32).min(0.5),
                blend: true,
                double_sided: true,
                ..Material::default_with(Lighting::Unlit)
            };
            wall(1.0 + 9.0 * t, cells, material)
        })
        .collect();
    let camera = Camera {
        position: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        fov_y_degrees: 60.0,
        near: 0.1,
        far: 100.0,
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
    let row = cells + 1;
    let positions: Vec<Vec3> = (0..row * row).map(|i| vertex(i % row, i / row)).collect();
    let triangles: Vec<[u32; 3]> = (0..cells * cells)
        .flat_map(|i| {
            let a = i / cells * row + i % cells;
            [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]
        })
        .collect();
    let mesh = Mesh {
        normals: vec![Vec3::Z; positions.len()],
        parts: vec![Part {
            name: "wall".to_owned(),
            triangles: 0..triangles.len(),
            material: material.clone(),
        }],
        positions,
        colors: Vec::new(),
        uvs: Vec::new(),
        triangles,
    };
    Object {
        name: format!("wall at {depth}"),
        mesh: Arc::new(mesh),
        world_from_object: Mat4::IDENTITY,
        layer: None,
        materials: vec![material],
    }
}

/// Exponents of every method and series, by least squares of logarithms over the upper half of the steps: constant costs hide
/// growth in the lower.
pub fn exponents(rows: &[Growth]) -> Vec<Exponent> {
    let mut all: Vec<Exponent> = Vec::new();
    for row in rows {
        if all
            .iter()
            .any(|e| e.method == row.method && e.series == row.series)
        {
            continue;
        }
        let own: Vec<&Growth> = rows
            .iter()
            .filter(|r| r.method == row.method && r.series == row.series)
            .collect();
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
    let points: Vec<(f64, f64)> = points.collect();
    let n = points.len() as f64;
    let (sx, sy) = points
        .iter()
        .fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
    let (mx, my) = (sx / n, sy / n);
    let xy: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    let xx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
    (xx > 0.0).then(|| xy / xx)
}

impl Scaling {
    /// With the exponents of the rows.
    pub fn new(rows: Vec<Growth>, left_out: Vec<LeftOut>) -> Self {
        Self {
            exponents: exponents(&rows),
            rows,
            left_out,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;

    fn row(method: &str, series: Series, value: u64, time_ms: f64, bytes: f64) -> Growth {
        Growth {
            method: method.to_owned(),
            series,
            value,
            time_ms,
            bytes_per_pixel: bytes,
        }
    }

    /// t = n² and bytes = 24 n; a constant cost in the lower steps is not fitted.
    #[test]
    fn powers_are_found() {
        let rows: Vec<Growth> = [1u64, 2, 4, 8, 16, 32]
            .into_iter()
            .map(|n| {
                let t = if n < 8 { 50.0 } else { (n * n) as f64 };
                row("x", Series::Fragments, n, t, 24.0 * n as f64)
            })
            .collect();
        let e = &exponents(&rows)[0];
        assert!((e.time.unwrap() - 2.0).abs() < 1e-9 && (e.bytes.unwrap() - 1.0).abs() < 1e-9);
        // Of the whole frame, where that grows.
        let pixels = [64u64, 256, 1024].map(|n| row("x", Series::Pixels, n, n as f64, 10.0));
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
        for step in steps()
            .iter()
            .filter(|s| s.series == Series::Triangles)
            .take(3)
        {
            let scene = stack(step.layers, step.cells);
            assert_eq!(scene.triangles() as u64, step.value());
        }
    }
}
