//! Inputs of the exported functions with their answers, by which a renderer checks what it pasted.

use crate::{description::layout, literal::float};
use peelnet_core::{
    absorbance::{DepthWarp, absorbance},
    fragment::worked_example,
    methods::{
        anchored::{resolve, resolve_separate_ends},
        slabs::{Design, Layout, Slabs},
    },
    random::Random,
    statistics::SumPrecision,
};
use peelnet_model::{Inputs, Model, Output};
use serde::Serialize;

const POINTS: usize = 3;

/// Draws until so many points are found. A network that answers 0 or 1 everywhere has none.
const DRAWS: usize = 4096;

/// Answers that say something: neither 0 nor 1.
const TELLING: std::ops::Range<f32> = 0.05..0.95;

const BACKGROUND: [f32; 3] = [0.25, 0.5, 0.75];

/// Inputs of the exported functions, and what they answer in 64 bits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SelfTest {
    /// Inputs of the network, where its answer is neither 0 nor 1.
    pub network: Vec<Point>,
    /// The four fragments that the README explains everything on, drawn as the description says; none of a network that predicts colours.
    pub pixel: Option<Pixel>,
}

/// Inputs of the network, and its answers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// In the order of the function's parameters.
    pub inputs: Vec<f32>,
    /// One, or three of a colour.
    pub answers: Vec<f32>,
}

/// A pixel with four fragments.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pixel {
    /// The frame's range of depth.
    pub near: f32,
    /// Its other end.
    pub far: f32,
    /// The fragments, nearest first.
    pub fragments: Vec<Drawn>,
    /// What targets hold after all fragments, where the statistics are those of slabs.
    pub targets: Vec<(&'static str, Vec<f32>)>,
    /// Linear, behind all.
    pub background: [f32; 3],
    /// Linear.
    pub color: [f32; 3],
}

/// A fragment and its weight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Drawn {
    /// Distance along the view axis.
    pub z: f32,
    /// Opacity.
    pub alpha: f32,
    /// Linear, not multiplied by the opacity.
    pub rgb: [f32; 3],
    /// The depth on the frame's scale.
    pub zeta: f32,
    /// What `peelnet_fragment` answers.
    pub weight: f32,
}

impl SelfTest {
    /// Of a model.
    pub fn of(model: &Model) -> Self {
        let mut random = Random::new(2, &[]);
        let drawn = (0..DRAWS).map(|_| {
            let inputs = model.meta.inputs.iter();
            let inputs: Vec<f32> = inputs.map(|i| random.between(i.min, i.max)).collect();
            let answers = model.shader_output(&inputs);
            Point { inputs, answers }
        });
        let telling = drawn.filter(|p| p.answers.iter().all(|a| TELLING.contains(a)));
        Self {
            network: telling.take(POINTS).collect(),
            pixel: pixel(model),
        }
    }

    /// As lines of a comment; `function` is the network's.
    pub(crate) fn lines(&self, function: &str) -> Vec<String> {
        let mut lines = vec!["Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.".to_owned()];
        let points = self.network.iter();
        lines.extend(
            points.map(|p| format!("{function}({}) = {}", list(&p.inputs), list(&p.answers))),
        );
        let Some(pixel) = &self.pixel else {
            return lines;
        };
        lines.push(format!(
            "Four fragments of a pixel, near {}, far {}, background {}:",
            float(pixel.near),
            float(pixel.far),
            list(&pixel.background)
        ));
        lines.extend(pixel.fragments.iter().map(|f| {
            format!(
                "   z {}, alpha {}, rgb {}: zeta {}, weight {}",
                float(f.z),
                float(f.alpha),
                list(&f.rgb),
                float(f.zeta),
                float(f.weight)
            )
        }));
        let targets = pixel.targets.iter();
        lines.extend(targets.map(|(name, values)| format!("   target {name}: {}", list(values))));
        lines.push(format!("   colour of the pixel: {}", list(&pixel.color)));
        lines
    }
}

fn list(values: &[f32]) -> String {
    let all: Vec<_> = values.iter().map(|&x| float(x)).collect();
    all.join(", ")
}

fn pixel(model: &Model) -> Option<Pixel> {
    let fragments = worked_example();
    let [near, far] = [fragments[0].depth, fragments[fragments.len() - 1].depth];
    let warp = DepthWarp::new(near.into(), far.into());
    let points = fragments.map(|f| (f.depth, f.alpha));
    let weights = model.transmittances(&points, &warp, SumPrecision::Exact);
    if weights.is_empty() {
        return None;
    }
    let separate = model.meta.output == Output::AnchoredShareSeparateEnds;
    let mut sums = [[0.0f64; 4]; 2];
    let last = fragments.len() - 1;
    for (k, (f, w)) in fragments.iter().zip(&weights).enumerate() {
        // The nearest and the farthest fragment are known.
        let sum = &mut sums[usize::from(separate && (k == 0 || k == last))];
        for (sum, c) in sum.iter_mut().zip(f.color.into_iter().chain([1.0])) {
            *sum += f64::from(f.alpha) * f64::from(c) * w;
        }
    }
    let transmittance: f64 = fragments.iter().map(|f| 1.0 - f64::from(f.alpha)).product();
    let background = BACKGROUND.map(f64::from);
    let color = if separate {
        resolve_separate_ends(sums[0], sums[1], transmittance, background)
    } else {
        resolve(sums[0], transmittance, background)
    };
    let drawn = fragments.iter().zip(&weights).map(|(f, w)| Drawn {
        z: f.depth,
        alpha: f.alpha,
        rgb: f.color,
        zeta: warp.apply(f.depth.into()) as f32,
        weight: *w as f32,
    });
    let targets = match model.meta.recipe.inputs {
        Inputs::Slabs(design, _) => of_slabs(design, &points, &warp),
        _ => Vec::new(),
    };
    Some(Pixel {
        near,
        far,
        fragments: drawn.collect(),
        targets,
        background: BACKGROUND,
        color: color.map(|c| c as f32),
    })
}

/// What the targets of slabs hold, by their names in the description.
fn of_slabs(
    design: Design,
    points: &[(f32, f32)],
    warp: &DepthWarp,
) -> Vec<(&'static str, Vec<f32>)> {
    let of = |&(z, alpha): &(f32, f32)| (absorbance(alpha), warp.apply(z.into()), true);
    let points: Vec<_> = points.iter().map(of).collect();
    let slabs = Slabs::of(&points, design, SumPrecision::Exact);
    let [mut a, mut firsts, mut near, mut far] = [const { Vec::new() }; 4];
    for slab in slabs.stored() {
        for (values, value) in [&mut a, &mut firsts, &mut near, &mut far]
            .into_iter()
            .zip(slab)
        {
            values.push(value as f32);
        }
    }
    let range = slabs.range().stored().map(|x| x as f32).to_vec();
    let mut targets = vec![("range", range)];
    match layout(&design) {
        Layout::Small => {
            a.push(firsts.remove(0));
            near.push(far[0]);
            targets.extend([("absorbances", a), ("nearest", near), ("firsts", firsts)]);
        }
        Layout::Medium => {
            for (values, first) in [&mut a, &mut near, &mut far].into_iter().zip(firsts) {
                values.push(first);
            }
            targets.extend([("absorbances", a), ("nearest", near), ("farthest", far)]);
        }
        Layout::Large => targets.extend([
            ("absorbances", a),
            ("nearest", near),
            ("farthest", far),
            ("firsts", firsts),
        ]),
    }
    targets
}
