//! A scene with the fragments of each of its pixels: known beforehand, or found by the 64-bit reference.

use super::ground_truth;
use crate::stage::{camera, rectangle};
use glam::Vec3;
use peelnet_core::{
    absorbance::absorbance,
    fragment::{Fragment, sort_front_to_back},
    guards::EMISSIVE_ALPHA,
    methods::over,
};
use peelnet_scene::{Material, Object, Scene};

pub(super) const BACKGROUND: [f32; 3] = [0.25, 0.5, 0.75];

/// Layers that cover some pixels of the frame whole.
pub struct Stack {
    pub name: String,
    /// Its layers, in the order in which they are drawn.
    pub layers: Vec<Fragment>,
    /// Depth and colour of an opaque surface among them.
    pub opaque: Option<(f32, [f32; 3])>,
}

impl Stack {
    pub fn new(name: &str, layers: Vec<Fragment>) -> Self {
        Self {
            name: name.to_owned(),
            layers,
            opaque: None,
        }
    }
}

pub struct Trial {
    /// What is drawn; every view of it, where it moves.
    pub scene: Scene,
    pub size: [u32; 2],
    /// Whether it is a sequence of frames (its views, or the trials of its case), which is judged by how much they differ.
    pub moves: bool,
    /// What the pixels hold, where that is known without drawing.
    pub(super) known: Option<Truth>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// It holds no fragment and nothing opaque.
    Nothing,
    Kind(u32),
    /// It lies on an edge: which fragments it holds depends on how vertices are snapped to the adapter's sub-pixel grid.
    Unjudged,
}

#[derive(Clone, Debug, Default)]
pub struct Truth {
    pub pixels: Vec<Content>,
    pub kinds: Vec<Kind>,
}

impl Truth {
    pub fn name(&self, content: Content) -> &str {
        match content {
            Content::Nothing => "no fragment",
            Content::Kind(k) => &self.kinds[k as usize].name,
            Content::Unjudged => "an edge",
        }
    }
}

/// What a pixel holds, and what follows from it.
#[derive(Clone, Debug)]
pub struct Kind {
    pub name: String,
    /// Its transparent fragments before anything opaque, nearest first.
    pub fragments: Vec<Fragment>,
    /// `C_0`.
    pub background: [f32; 3],
    pub exact: [f64; 3],
    /// `T_∞`.
    pub transmittance: f64,
    /// `b_0`, the sum of absorbances.
    pub absorbance: f64,
    /// The brightest component of what the fragments show by themselves, un-premultiplied: `(exact − T_∞ C_0) / (1 − T_∞)`.
    pub mean: f64,
    /// How far `exact` may be off because geometry is snapped and shaded in 32 bits; 0 where nothing but compositing rounds.
    pub uncertainty: f64,
}

impl Kind {
    /// Of fragments in any order before `C_0`.
    pub(super) fn new(name: String, mut fragments: Vec<Fragment>, background: [f32; 3]) -> Self {
        sort_front_to_back(&mut fragments);
        let alphas = fragments.iter().map(|f| f64::from(f.alpha));
        let transmittance: f64 = alphas.map(|a| 1.0 - a).product();
        let exact = over::composite_f64(&fragments, background);
        let own = exact.iter().zip(background);
        let brightest = own.fold(0.0f64, |m, (&c, c0)| {
            m.max(c - transmittance * f64::from(c0))
        });
        let mean = (transmittance < 1.0).then(|| brightest / (1.0 - transmittance));
        Self {
            exact,
            transmittance,
            mean: mean.unwrap_or_default(),
            uncertainty: 0.0,
            absorbance: fragments.iter().map(|f| absorbance(f.alpha)).sum(),
            name,
            fragments,
            background,
        }
    }

    /// The transmittance at the `i`-th fragment from the front, of which it counts this share of its own absorbance.
    pub(super) fn transmittance_at(&self, i: usize, own_share: f64) -> f64 {
        let passing = |f: &Fragment| 1.0 - f64::from(f.alpha);
        let in_front: f64 = self.fragments[..i].iter().map(passing).product();
        in_front * passing(&self.fragments[i]).powf(own_share)
    }

    /// The sum of what fragments show or hide, unnormalised: their opacities times their colours' brightest component, or `C_0`'s.
    pub(super) fn terms(&self) -> f64 {
        let brightest = |c: [f32; 3]| c.into_iter().fold(1.0, f32::max);
        let behind = brightest(self.background);
        let term = |f: &Fragment| f64::from(f.alpha * brightest(f.color).max(behind));
        self.fragments.iter().map(term).sum::<f64>() + f64::from(behind)
    }

    /// The brightest component of the exact colour, at least 1: what errors of the pixel are measured against.
    pub(super) fn scale(&self) -> f64 {
        self.exact.into_iter().fold(1.0, f64::max)
    }
}

/// The material of a layer. Radiance above 1 is emitted, and a layer that covers no more than emission must is invisible but for
/// what it emits.
fn material(layer: &Fragment) -> Material {
    let reflected = layer.color.map(|c| c.min(1.0));
    let beyond = |k: usize| layer.alpha * (layer.color[k] - reflected[k]);
    let emission = [beyond(0), beyond(1), beyond(2)];
    let invisible = layer.alpha == EMISSIVE_ALPHA && emission != [0.0; 3];
    Material {
        emission,
        ..Material::unlit(reflected, if invisible { 0.0 } else { layer.alpha })
    }
}

/// Width and height of frames whose pixels the reference finds.
const JUDGED_SIZE: [u32; 2] = [48, 36];

impl Trial {
    /// Objects before the background, whose pixels the reference finds when they are drawn.
    pub fn rasterised(name: &str, planes: [f32; 2], objects: Vec<Object>) -> Self {
        let (maker, camera) = ("the stress catalogue", camera(planes));
        Self {
            scene: Scene::generated(name, maker, BACKGROUND, camera, objects),
            size: JUDGED_SIZE,
            moves: false,
            known: None,
        }
    }

    /// Stacks side by side, `cover` pixels wide and high each, with a row of empty pixels around.
    pub fn of_stacks(planes: [f32; 2], cover: u32, stacks: Vec<Stack>) -> Self {
        let pitch = cover + 1;
        let columns = (stacks.len() as f32).sqrt().ceil() as u32;
        let rows = (stacks.len() as u32).div_ceil(columns);
        let size = [columns * pitch + 1, rows * pitch + 1];
        let [width, height] = size.map(|n| n as f32);
        let mut truth = Truth {
            pixels: vec![Content::Nothing; (size[0] * size[1]) as usize],
            kinds: Vec::new(),
        };
        let mut objects = Vec::new();
        for (stack, i) in stacks.iter().zip(0..) {
            let (left, top) = (i % columns * pitch + 1, i / columns * pitch + 1);
            let vertices = |z: f32| {
                // 90° high: half the height at depth z is z.
                let x = |pixel: u32| (2.0 * pixel as f32 / width - 1.0) * z * width / height;
                let y = |pixel: u32| (1.0 - 2.0 * pixel as f32 / height) * z;
                let vertex = |px: u32, py: u32| Vec3::new(x(px), y(py), -z);
                rectangle([left, left + cover], [top + cover, top], vertex)
            };
            let mut fragments = Vec::new();
            for layer in &stack.layers {
                let material = material(layer);
                let name = format!("{} at {}", stack.name, layer.depth);
                let triangle = 2 * objects.len() as u32;
                fragments.push(Fragment { triangle, ..*layer });
                let vertices = vertices(layer.depth);
                objects.push(Object::of_triangles(&name, &vertices, material));
            }
            let mut behind = BACKGROUND;
            if let Some((depth, color)) = stack.opaque {
                let material = Material {
                    blend: false,
                    ..Material::unlit(color, 1.0)
                };
                objects.push(Object::of_triangles("opaque", &vertices(depth), material));
                fragments.retain(|f| f.depth < depth);
                behind = color;
            }
            let kind = truth.kinds.len() as u32;
            let name = stack.name.clone();
            truth.kinds.push(Kind::new(name, fragments, behind));
            for y in top..top + cover {
                for x in left..left + cover {
                    truth.pixels[(y * size[0] + x) as usize] = Content::Kind(kind);
                }
            }
        }
        Self {
            size,
            known: Some(truth),
            ..Self::rasterised("stacks", planes, objects)
        }
    }

    /// What the first view's pixels hold: as the trial was made, or as the 64-bit reference finds.
    pub fn truth(&self) -> Truth {
        match &self.known {
            Some(known) => known.clone(),
            None => ground_truth::truth(&self.scene, &self.scene.views[0], self.size),
        }
    }

    /// The scene with colours that show weights: of each pixel's fragments whose depth no other has, the nearest three are red, green
    /// and blue, and all others black, over black. `None` where the fragments are not known beforehand.
    pub(super) fn probe(&self) -> Option<(Scene, Vec<[Option<usize>; 3]>)> {
        let known = self.known.as_ref()?;
        let mut scene = self.scene.clone();
        scene.background = [0.0; 3];
        for material in scene.objects.iter_mut().flat_map(|o| &mut o.materials) {
            (material.color, material.emission) = ([0.0; 3], [0.0; 3]);
        }
        let shown = known.kinds.iter().map(|kind| {
            let mut shown = [None; 3];
            let alone = (0..kind.fragments.len()).filter(|&i| {
                let same = |f: &&Fragment| f.depth == kind.fragments[i].depth;
                kind.fragments.iter().filter(same).count() == 1
            });
            for ((place, i), channel) in shown.iter_mut().zip(alone).zip(0..) {
                *place = Some(i);
                // A layer is an object of two triangles.
                let object = kind.fragments[i].triangle as usize / 2;
                for material in &mut scene.objects[object].materials {
                    material.color[channel] = 1.0;
                }
            }
            shown
        });
        let shown = shown.collect();
        Some((scene, shown))
    }
}
