//! Inputs of the exported functions with their answers, by which a renderer checks what it pasted.

use crate::literal::float;
use peelnet_core::{
    absorbance::DepthWarp,
    fragment::worked_example,
    methods::{anchored::composite_weighted, one::Around},
    random::Random,
    statistics::SumPrecision,
};
use peelnet_model::{Model, inputs::Observed};
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
    pub fn new(model: &Model) -> Self {
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
        for Point { inputs, answers } in &self.network {
            lines.push(format!("{function}({}) = {}", list(inputs), list(answers)));
        }
        let Some(pixel) = &self.pixel else {
            return lines;
        };
        let [near, far] = [pixel.near, pixel.far].map(float);
        let background = list(&pixel.background);
        lines.push(format!(
            "Four fragments of a pixel, near {near}, far {far}, background {background}:"
        ));
        for f in &pixel.fragments {
            let [z, alpha, zeta, weight] = [f.z, f.alpha, f.zeta, f.weight].map(float);
            let surface = format!("z {z}, alpha {alpha}, rgb {}", list(&f.rgb));
            lines.push(format!("   {surface}: zeta {zeta}, weight {weight}"));
        }
        for (name, values) in &pixel.targets {
            lines.push(format!("   target {name}: {}", list(values)));
        }
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
    let observed = Observed {
        fragments: &points,
        warp,
        precision: SumPrecision::Exact,
        around: Around::NONE,
    };
    let weights = model.transmittances(&observed);
    if weights.is_empty() {
        return None;
    }
    let inputs = model.meta.recipe.inputs;
    let last = fragments.len() - 1;
    // The nearest and the farthest fragment are known.
    let known = weights.iter().enumerate();
    let known = known.map(|(k, &weight)| (weight, k == 0 || k == last));
    let color = model.color(&fragments, BACKGROUND, &warp);
    let color = color
        .unwrap_or_else(|| composite_weighted(&fragments, BACKGROUND, inputs.known_apart(), known));
    let drawn = fragments.iter().zip(&weights).map(|(f, w)| Drawn {
        z: f.depth,
        alpha: f.alpha,
        rgb: f.color,
        zeta: warp.apply(f.depth.into()) as f32,
        weight: *w as f32,
    });
    Some(Pixel {
        near,
        far,
        fragments: drawn.collect(),
        targets: inputs.target_values(&observed),
        background: BACKGROUND,
        color,
    })
}
