//! Changes every decimal literal of a shader's text by a tenth and looks whether a comparison notices.
//!
//! A literal whose change does not show must be listed with its reason, and one that is listed must not show: the lists are what tests cannot
//! see.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use crate::{literals::literals, scene};
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

/// A frame one pixel high whose pixels hold these fragments, each a triangle around the pixel's centre.
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

    /// The largest difference of any channel between a frame and the method's CPU twin.
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
            for (p, want) in p.iter().zip(want) {
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
