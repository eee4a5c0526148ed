//! A scene with the fragments of each of its pixels: known beforehand, or peeled.

use super::catalogue::camera;
use crate::EvalError;
use glam::Vec3;
use peelnet_core::{
    fragment::{Fragment, sort_front_to_back},
    guards::EMISSIVE_ALPHA,
    methods::over,
};
use peelnet_gpu::Gpu;
use peelnet_peel::{Peel, harvest::Harvester, rows::RawTile};
use peelnet_render::PixelSample;
use peelnet_scene::{Material, Object, Scene};

/// Layers that cover some pixels of the frame whole.
#[derive(Clone, Debug)]
pub struct Stack {
    /// Name, for messages.
    pub name: String,
    /// Its layers, in the order in which they are drawn.
    pub layers: Vec<Fragment>,
    /// Depth and colour of an opaque surface among them.
    pub opaque: Option<(f32, [f32; 3])>,
}

impl Stack {
    /// Without an opaque surface.
    pub fn new(name: &str, layers: Vec<Fragment>) -> Self {
        Self {
            name: name.to_owned(),
            layers,
            opaque: None,
        }
    }
}

/// A scene of a hard case.
#[derive(Clone, Debug)]
pub struct Trial {
    /// What is drawn; every view of it, where it moves.
    pub scene: Scene,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Whether it is a sequence of frames (its views, or the trials of its case), which is judged by how much they differ.
    pub moves: bool,
    /// What the pixels hold, where that is known without drawing.
    known: Option<Truth>,
}

/// The fragments of every pixel.
#[derive(Clone, Debug, Default)]
pub struct Truth {
    /// Which of `kinds` a pixel is, row by row; none where it holds no fragment and nothing opaque.
    pub pixels: Vec<Option<u32>>,
    /// Pixels that hold the same.
    pub kinds: Vec<Kind>,
}

/// What a pixel holds, and what follows from it.
#[derive(Clone, Debug)]
pub struct Kind {
    /// Name, for messages.
    pub name: String,
    /// Its transparent fragments before anything opaque, nearest first.
    pub fragments: Vec<Fragment>,
    /// `C_0`.
    pub background: [f32; 3],
    /// Composited in 64 bits.
    pub exact: [f64; 3],
    /// `T_∞`.
    pub transmittance: f64,
    /// `b_0`, the sum of absorbances.
    pub absorbance: f64,
    /// The brightest component of any colour, at least 1.
    pub peak: f64,
}

impl Kind {
    fn new(name: String, mut fragments: Vec<Fragment>, background: [f32; 3]) -> Self {
        sort_front_to_back(&mut fragments);
        let alphas = fragments.iter().map(|f| f64::from(f.alpha));
        let colors = fragments.iter().flat_map(|f| f.color).chain(background);
        Self {
            exact: over::composite_f64(&fragments, background),
            transmittance: alphas.map(|a| 1.0 - a).product(),
            absorbance: fragments
                .iter()
                .map(|f| peelnet_core::absorbance::absorbance(f.alpha))
                .sum(),
            peak: colors.fold(1.0, |m, c| m.max(f64::from(c))),
            name,
            fragments,
            background,
        }
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

/// Width and height of frames whose pixels are peeled.
const PEELED_SIZE: [u32; 2] = [48, 36];

impl Trial {
    /// A scene whose pixels are peeled when it is drawn.
    pub fn peeled(scene: Scene) -> Self {
        Self {
            scene,
            size: PEELED_SIZE,
            moves: false,
            known: None,
        }
    }

    /// Stacks side by side, `cover` pixels wide and high each, with a row of empty pixels around.
    pub fn of_stacks(
        planes: [f32; 2],
        background: [f32; 3],
        cover: u32,
        stacks: Vec<Stack>,
    ) -> Self {
        let pitch = cover + 1;
        let columns = (stacks.len() as f32).sqrt().ceil() as u32;
        let rows = (stacks.len() as u32).div_ceil(columns);
        let size = [columns * pitch + 1, rows * pitch + 1];
        let [width, height] = size.map(|n| n as f32);
        let mut truth = Truth {
            pixels: vec![None; (size[0] * size[1]) as usize],
            kinds: Vec::new(),
        };
        let mut objects = Vec::new();
        for (stack, i) in stacks.iter().zip(0..) {
            let (left, top) = (i % columns * pitch + 1, i / columns * pitch + 1);
            let vertices = |z: f32| {
                // 90° high: half the height at depth z is z.
                let x = |pixel: u32| (2.0 * pixel as f32 / width - 1.0) * z * width / height;
                let y = |pixel: u32| (1.0 - 2.0 * pixel as f32 / height) * z;
                let v = |px: u32, py: u32| Vec3::new(x(px), y(py), -z);
                let (a, b) = (v(left, top + cover), v(left + cover, top + cover));
                let (c, d) = (v(left + cover, top), v(left, top));
                [[a, b, c], [a, c, d]]
            };
            let mut fragments = Vec::new();
            for layer in &stack.layers {
                let material = material(layer);
                let name = format!("{} at {}", stack.name, layer.depth);
                fragments.push(Fragment {
                    triangle: 2 * objects.len() as u32,
                    ..*layer
                });
                objects.push(Object::of_triangles(
                    &name,
                    &vertices(layer.depth),
                    material,
                ));
            }
            let mut behind = background;
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
                    truth.pixels[(y * size[0] + x) as usize] = Some(kind);
                }
            }
        }
        let maker = "the stress catalogue";
        let camera = camera(planes);
        Self {
            scene: Scene::generated("stacks", maker, background, camera, objects),
            size,
            moves: false,
            known: Some(truth),
        }
    }

    /// What the first view's pixels hold.
    ///
    /// # Errors
    /// If it must be peeled and cannot be.
    pub fn truth(&self, gpu: &Gpu) -> Result<Truth, EvalError> {
        if let Some(known) = &self.known {
            return Ok(known.clone());
        }
        let mut harvester = Harvester::new(gpu, &self.scene, self.size, Peel::SBuffer, false, None)
            .map_err(EvalError::peel(&self.scene.name))?;
        let mut truth = Truth {
            pixels: vec![None; (self.size[0] * self.size[1]) as usize],
            kinds: Vec::new(),
        };
        let mut take = |tile: RawTile| {
            let first = tile.first_pixel as usize;
            for (run, pixel) in tile.offsets.windows(2).zip(first..) {
                let run = run[0] as usize..run[1] as usize;
                if run.is_empty() {
                    continue;
                }
                let found = tile.depths[run.clone()].iter().zip(&tile.colors[run]);
                let fragments = found.zip(0..).map(|((&depth, c), i)| Fragment {
                    // Storage is in the order of the exact methods.
                    triangle: i,
                    ..Fragment::new(depth, c[3], [c[0], c[1], c[2]])
                });
                let (x, y) = (pixel % self.size[0] as usize, pixel / self.size[0] as usize);
                let name = format!("{} at ({x}, {y})", self.scene.name);
                truth.pixels[pixel] = Some(truth.kinds.len() as u32);
                let kind = Kind::new(name, fragments.collect(), self.scene.background);
                truth.kinds.push(kind);
            }
            Ok(())
        };
        harvester
            .harvest(
                &self.scene.views[0],
                PixelSample::ALL,
                None,
                RawTile::default,
                &mut take,
            )
            .map_err(EvalError::peel(&self.scene.name))?;
        Ok(truth)
    }
}
