//! Changes every decimal literal of a shader's text by a tenth and looks whether a comparison notices.
//!
//! A literal whose change does not show must be listed with its reason, and one that is listed must not show: the lists are what tests cannot
//! see.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use crate::{literals::literals, run_text, scene};
use glam::Vec3;
use peelnet_core::fragment::Fragment;
use peelnet_gpu::Gpu;
use peelnet_model::Model;
use peelnet_render::{LearnedWeight, MethodOptions, MethodSpec, Renderer, methods::Pixel};
use peelnet_scene::{Material, Object, Scene};

/// Why a ceiling or a floor does not show.
pub const NEVER: &str = "a guard that nothing here reaches";

/// What a literal is multiplied by: by the second where the first does not show.
const CHANGES: [f64; 2] = [1.1, 0.9];

/// How many tolerances a change must show by, so that it is no matter of rounding.
const CLEAR: f64 = 4.0;

/// Literal, beginning of its line, and reason of a change that does not show.
pub type Unseen<'a> = (&'a str, &'a str, &'a str);

/// Literals and their lines that do not show when they are changed, and how many were changed: every `step`-th of these texts, given as
/// (module, text). `error` is of the texts with this one in place of its module's own.
pub fn unseen<'a>(
    name: &str,
    texts: impl IntoIterator<Item = (&'a str, &'a str)>,
    step: usize,
    tolerance: f64,
    mut error: impl FnMut(&str, &str) -> f64,
) -> (Vec<(&'a str, &'a str)>, usize) {
    let (mut unseen, mut changed) = (Vec::new(), 0);
    for (module, text) in texts {
        for place in literals(text).into_iter().step_by(step) {
            changed += 1;
            let literal = &text[place.clone()];
            let mut moved = 0.0;
            for change in CHANGES {
                let other = literal.parse::<f64>().unwrap() * change;
                let (before, after) = (&text[..place.start], &text[place.end..]);
                moved = error(module, &format!("{before}{other:?}{after}"));
                if moved > CLEAR * tolerance {
                    break;
                }
            }
            if moved <= CLEAR * tolerance {
                let line = text[..place.start].matches('\n').count();
                let line = text.lines().nth(line).unwrap_or_default().trim();
                println!("{name}: {literal} moves it by {moved:.2e} only: {line}");
                unseen.push((literal, line));
            }
        }
    }
    (unseen, changed)
}

/// What is wrong: an error of the texts as they are, or literals that do not show and are not listed, or the other way round. `error` is of
/// the texts with this one, if any, in place of its module's own.
pub fn problem<'a>(
    name: &str,
    texts: impl IntoIterator<Item = (&'a str, &'a str)>,
    tolerance: f64,
    listed: &[Unseen<'_>],
    mut error: impl FnMut(Option<(&str, &str)>) -> f64,
) -> Option<String> {
    let plain = error(None);
    println!("{name}: {plain:.2e} of {tolerance:.2e} allowed");
    if plain > tolerance {
        return Some(format!("{name}: {plain:.2e}"));
    }
    let (unseen, _) = unseen(name, texts, 1, tolerance, |module, text| {
        error(Some((module, text)))
    });
    let listed: Vec<_> = listed
        .iter()
        .map(|&(literal, line, _)| (literal, line))
        .collect();
    let is = |(a, b): (&(&str, &str), &(&str, &str))| a.0 == b.0 && a.1.starts_with(b.1);
    let same = unseen.len() == listed.len() && unseen.iter().zip(&listed).all(is);
    (!same).then(|| {
        format!("{name}: changes that do not show are {unseen:#?}, listed are {listed:#?}")
    })
}

/// Panics with all problems.
pub fn check(problems: impl IntoIterator<Item = Option<String>>) {
    let problems: Vec<String> = problems.into_iter().flatten().collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// What of the camera the functions read.
const CAMERA: &str = "struct Camera { warp_inverse_near: f32, warp_scale: f32 }
const camera = Camera(2.0, 0.5);
";

/// Values that one sample gives.
pub const VALUES: usize = 8;

/// A function of the shaders, and what it must give.
pub struct Function<'a> {
    /// For messages.
    pub name: &'a str,
    /// Modules whose literals are changed, beside the parameters.
    pub modules: &'a [&'a str],
    /// Text of `package::parameters`.
    pub parameters: &'a str,
    /// Imports, and `fn values(p: vec4f, q: vec4f) -> array<f32, 8>`.
    pub driver: &'a str,
    /// p and q of every sample.
    pub samples: Vec<[[f32; 4]; 2]>,
    /// The values of p and q in 64 bits.
    pub want: &'a dyn Fn([f64; 4], [f64; 4]) -> [f64; VALUES],
    /// Largest error as a share of the value, or of `least` where that is more.
    pub tolerance: f64,
    /// See `tolerance`.
    pub least: f64,
    /// What a change does not show.
    pub unseen: &'a [Unseen<'a>],
}

impl Function<'_> {
    /// The largest error, of texts with these modules in place of their own.
    fn error(&self, gpu: &Gpu, altered: &[(&str, &str)]) -> f64 {
        let root = format!(
            "{}
            @group(0) @binding(0) var<storage, read> inputs: array<vec4f>;
            @group(0) @binding(1) var<storage, read_write> answers: array<array<f32, {VALUES}>>;
            @compute @workgroup_size(64)
            fn main(@builtin(global_invocation_id) id: vec3u) {{
                if id.x >= arrayLength(&answers) {{ return; }}
                answers[id.x] = values(inputs[2u * id.x], inputs[2u * id.x + 1u]);
            }}",
            self.driver
        );
        let mut sources = vec![
            ("driver", root.as_str()),
            ("parameters", self.parameters),
            // Depths of 0.5 to 0.5 e^4.
            ("scene::camera", CAMERA),
        ];
        sources.extend(altered);
        let wgsl = peelnet_shaders::link("driver", &[], &sources).unwrap();
        let inputs = self.samples.as_flattened();
        let found: Vec<[f32; VALUES]> = run_text(gpu, &wgsl, inputs, self.samples.len());
        let mut worst = 0.0f64;
        for ([p, q], found) in self.samples.iter().zip(found) {
            let want = (self.want)(p.map(f64::from), q.map(f64::from));
            for (found, want) in found.into_iter().zip(want) {
                let error = (f64::from(found) - want).abs() / want.abs().max(self.least);
                worst = if error.is_nan() {
                    f64::INFINITY
                } else {
                    worst.max(error)
                };
            }
        }
        worst
    }

    /// What is wrong of the texts or of the list; see [`problem`].
    pub fn problem(&self, gpu: &Gpu) -> Option<String> {
        let texts = self
            .modules
            .iter()
            .map(|m| (*m, peelnet_shaders::source(m).unwrap()))
            .chain([("parameters", self.parameters)]);
        let error = |altered: Option<(&str, &str)>| self.error(gpu, altered.as_slice());
        problem(self.name, texts, self.tolerance, self.unseen, error)
    }
}

/// A frame one pixel high whose pixels hold these fragments, each a triangle around the pixel's centre.
#[derive(Debug)]
pub struct Columns {
    scene: Scene,
    columns: Vec<Vec<Fragment>>,
}

impl Columns {
    /// Of lists of fragments, which are given the numbers of their triangles.
    pub fn new(mut columns: Vec<Vec<Fragment>>) -> Self {
        let width = columns.len() as f32;
        let mut objects = Vec::new();
        for (column, x) in columns.iter_mut().zip(0u8..) {
            let x = 2.0 * (f32::from(x) + 0.5) - width;
            for f in column {
                f.triangle = objects.len() as u32;
                let v = |dx: f32, y: f32| Vec3::new((x + dx) * f.depth, y * f.depth, -f.depth);
                let triangle = [v(-0.9, -0.5), v(0.9, -0.5), v(0.0, 0.9)];
                let material = Material::unlit(f.color, f.alpha);
                objects.push(Object::of_triangles("fragment", &[triangle], material));
            }
        }
        Self {
            scene: scene("columns", [0.25, 0.5, 0.75], objects),
            columns,
        }
    }

    /// The largest difference of any channel between a frame and the method's CPU twin, and of the coverage.
    pub fn error(
        &self,
        gpu: &Gpu,
        spec: &MethodSpec,
        learned: Option<(&LearnedWeight, &Model)>,
    ) -> f64 {
        let view = &self.scene.views[0];
        let size = [self.columns.len() as u32, 1];
        let renderer = Renderer::new(gpu, &self.scene).unwrap();
        let options = MethodOptions::sized(size).with(learned.map(|(text, _)| text));
        let mut prepared = renderer.method(spec, options).unwrap();
        let image = renderer.image(&mut prepared, view).unwrap().image;
        let mut worst = 0.0f64;
        for ((fragments, p), x) in self.columns.iter().zip(&image.pixels).zip(0..) {
            let pixel = Pixel {
                fragments,
                background: self.scene.background,
                warp: renderer.depth_warp(view),
                position: [x, 0],
                model: learned.map(|(_, model)| model),
            };
            let want = spec.twin(&pixel).unwrap();
            let t: f64 = fragments.iter().map(|f| 1.0 - f64::from(f.alpha)).product();
            for (p, want) in p.iter().zip(want.into_iter().chain([(1.0 - t) as f32])) {
                let error = f64::from((p - want).abs());
                worst = if error.is_nan() {
                    f64::INFINITY
                } else {
                    worst.max(error)
                };
            }
        }
        worst
    }
}
