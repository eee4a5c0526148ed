//! What the tests share: one way to open a GPU, scenes with known answers, and the reference's view of a scene.
#![allow(missing_docs, reason = "only tests use it")]

pub mod readers;

use glam::{Vec2, Vec3};
use peelnet_core::{fragment::Fragment, random::Random};
use peelnet_model::{Model, Recipe};
use peelnet_render::gpu::{AdapterRequest, Gpu};
use peelnet_render::{
    Frame, Image, LearnedWeight, METHODS, MethodOptions, MethodSpec, Prepared, Renderer,
};
use peelnet_scene::{Camera, Light, Material, Object, Scene, Source, Texture};
use std::{fmt::Display, sync::Arc};

/// The software adapter where there is one, else whatever there is. Never skips: no adapter is a failure that says how to
/// get one.
pub fn gpu() -> Gpu {
    Gpu::open(&AdapterRequest::Software)
        .or_else(|_| Gpu::open(&AdapterRequest::Auto))
        .unwrap_or_else(|e| panic!("{e}"))
}

pub fn shipped(recipe: Recipe) -> Model {
    Model::shipped(recipe).unwrap_or_else(|e| panic!("{e}"))
}

/// The network that ships for a method, with its exported text; `None` for a method without a network.
pub fn network_of(method: &MethodSpec) -> Option<(LearnedWeight, Model)> {
    let recipe = Recipe::for_method(method.name())?;
    let model = shipped(recipe);
    let wgsl = peelnet_export::wgsl(&model);
    let wgsl = wgsl.unwrap_or_else(|e| panic!("{method}: {e}"));
    Some((LearnedWeight { recipe, wgsl }, model))
}

/// One method each, as people draw it first.
pub fn representatives() -> Vec<MethodSpec> {
    let drawn = METHODS.iter().filter(|m| m.cpu_only.is_none());
    drawn.map(MethodSpec::representative).collect()
}

pub fn specs<const N: usize>(names: [&str; N]) -> Vec<MethodSpec> {
    let spec = |name: &str| name.parse().unwrap_or_else(|e| panic!("{e}"));
    names.map(spec).to_vec()
}

/// Draws a scene's first view; a learned method with its shipped network.
pub fn draw(gpu: &Gpu, scene: &Scene, method: impl Display, size: [u32; 2]) -> Image {
    frame(gpu, scene, method, MethodOptions::sized(size)).image
}

/// The same with what the method reports.
pub fn frame(gpu: &Gpu, scene: &Scene, method: impl Display, options: MethodOptions) -> Frame {
    let renderer = Renderer::new(gpu, scene).unwrap_or_else(|e| panic!("{e}"));
    let spec = method.to_string().parse();
    let mut prepared = spec
        .and_then(|spec| renderer.method(&spec, options))
        .unwrap_or_else(|e| panic!("{method}: {e}"));
    let frame = renderer.image(&mut prepared, &scene.views[0]);
    frame.unwrap_or_else(|e| panic!("{method}: {e}"))
}

pub fn prepare(renderer: &Renderer, method: impl Display, size: [u32; 2]) -> Prepared {
    let spec = method.to_string().parse();
    let prepared = spec.and_then(|spec| renderer.method(&spec, MethodOptions::sized(size)));
    prepared.unwrap_or_else(|e| panic!("{method}: {e}"))
}

/// It is refused, in these words.
pub fn assert_refused<T>(refused: Result<T, impl Display>, words: &[&str]) {
    let error = refused.err().map(|e| e.to_string()).unwrap_or_default();
    let says = words.iter().all(|word| error.contains(word));
    assert!(says, "'{error}' for {words:?}");
}

/// No colour channel of a pixel is farther off than the bound.
pub fn assert_near<const N: usize>(
    found: [f32; 4],
    want: [f32; N],
    bound: f32,
    what: impl Display,
) {
    // Written so that a NaN is far.
    let near = (0..3).all(|k| (found[k] - want[k]).abs() <= bound);
    assert!(near, "{what}: {found:?} for {want:?}, bound {bound:e}");
}

pub fn assert_all<const N: usize>(image: &Image, want: [f32; N], bound: f32, what: impl Display) {
    for (pixel, i) in image.pixels.iter().zip(0..) {
        assert_near(*pixel, want, bound, format_args!("{what}, pixel {i}"));
    }
}

pub fn assert_alike(found: &[[f32; 4]], want: &[[f32; 4]], bound: f32, what: impl Display) {
    assert_eq!(found.len(), want.len(), "{what}");
    for (i, (found, want)) in found.iter().zip(want).enumerate() {
        assert_near(*found, *want, bound, format_args!("{what}, pixel {i}"));
    }
}

pub fn even(texel: [u8; 4]) -> Option<Arc<Texture>> {
    Some(Arc::new(Texture::of("even", [4, 4], |_, _| texel)))
}

/// A surface that hides what lies behind it.
pub fn opaque(color: [f32; 3]) -> Material {
    Material {
        blend: false,
        ..Material::unlit(color, 1.0)
    }
}

pub fn light(position: Vec3, color: [f32; 3]) -> Light {
    Light {
        source: Source::Point(position),
        color,
        intensity: 1.5,
    }
}

/// A camera at the origin that looks along −z with a square frame of 90°, so that a quad of half side `z` at depth
/// `z` just fills it.
pub fn camera() -> Camera {
    Camera {
        position: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        fov_y_degrees: 90.0,
        near: 0.01,
        far: 2e4,
    }
}

/// The window depth that [`camera`] gives to a depth.
pub fn window_depth(depth: f32) -> f32 {
    let clip = camera().clip_from_view(1.0) * glam::Vec4::new(0.0, 0.0, -depth, 1.0);
    clip.z / clip.w
}

/// Relative rounding of a half float.
pub const HALF: f32 = 1.0 / 2048.0;

/// Bound for sums in 16 bits of `n` terms: every addition and the stored T round once, values ≤ `peak`.
pub fn half_sums(n: usize, peak: f32) -> f32 {
    (n as f32 + 2.0) * HALF * peak
}

pub fn quad([a, b, c, d]: [Vec3; 4]) -> [[Vec3; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// A rectangle that faces the camera at depth `z`, from left to right and from bottom to top.
pub fn rectangle(x: [f32; 2], y: [f32; 2], z: f32) -> [[Vec3; 3]; 2] {
    let vertex = |i: usize, j: usize| Vec3::new(x[i], y[j], -z);
    quad([vertex(0, 0), vertex(1, 0), vertex(1, 1), vertex(0, 1)])
}

pub fn object(triangles: &[[Vec3; 3]], material: Material) -> Object {
    Object::of_triangles("test", triangles, material)
}

/// Objects of random triangles, so many each, between these depths; in color and opacity random, too.
pub fn soup(seed: u64, objects: usize, triangles: usize, z: [f32; 2]) -> Vec<Object> {
    let mut random = Random::new(seed, &[]);
    let mut one = || {
        let mut vertex = |()| {
            let z = random.between(z[0], z[1]);
            let mut side = || random.between(-1.2, 1.2) * z;
            Vec3::new(side(), side(), -z)
        };
        let triangles: Vec<_> = (0..triangles).map(|_| [(); 3].map(&mut vertex)).collect();
        let material = Material::unlit(random.color(), random.between(0.05, 0.95));
        object(&triangles, material)
    };
    (0..objects).map(|_| one()).collect()
}

/// A quad facing the camera at depth `z` that covers the whole frame, and more.
pub fn wall(z: f32, material: Material) -> Object {
    let s = 1.5 * z;
    let mut wall = object(&rectangle([-s, s], [-s, s], z), material);
    // It shows the whole of an image.
    let mesh = Arc::make_mut(&mut wall.mesh);
    let (a, b, c, d) = (Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO);
    mesh.uvs = vec![[a, b, c], [a, c, d]];
    wall
}

pub fn scene(name: &str, background: [f32; 3], objects: Vec<Object>) -> Scene {
    Scene::generated(name, "a test", background, camera(), objects)
}

/// Every pixel of it holds exactly these fragments.
pub fn walls(fragments: &[Fragment], background: [f32; 3]) -> Scene {
    let wall = |f: &Fragment| wall(f.depth, Material::unlit(f.color, f.alpha));
    scene("walls", background, fragments.iter().map(wall).collect())
}
