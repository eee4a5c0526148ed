//! What the tests share: one way to open a GPU, scenes with known answers, and the judge's view of a scene.

pub mod readers;

use glam::{Vec2, Vec3};
use peelnet_core::fragment::Fragment;
use peelnet_gpu::{AdapterRequest, Gpu, bind::Bind, wgpu};
use peelnet_model::{Model, Recipe};
use peelnet_render::{
    Image, LearnedWeight, METHODS, MethodOptions, MethodSpec, Prepared, Renderer,
};
use peelnet_scene::{Camera, Light, Material, Object, Scene, Source, Texture};
use std::sync::Arc;

/// The software adapter where there is one, else whatever there is. Never skips: no adapter is a failure that says how to
/// get one.
pub fn gpu() -> Gpu {
    Gpu::open(&AdapterRequest::Software)
        .or_else(|_| Gpu::open(&AdapterRequest::Auto))
        .unwrap_or_else(|e| panic!("{e}"))
}

/// The network that ships for a recipe.
pub fn shipped(recipe: Recipe) -> Model {
    Model::shipped(recipe).unwrap_or_else(|e| panic!("{e}"))
}

/// The network that ships for a method, with its exported text; `None` for a method without a network.
pub fn network_of(method: &MethodSpec) -> Option<(LearnedWeight, Model)> {
    let recipe = Recipe::of_method(method.name())?;
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

/// Draws a scene's first view; a learned method with its shipped network.
pub fn draw(gpu: &Gpu, scene: &Scene, method: &str, size: [u32; 2]) -> Image {
    let renderer = Renderer::new(gpu, scene).unwrap_or_else(|e| panic!("{e}"));
    let mut prepared = prepare(&renderer, method, size);
    let frame = renderer.image(&mut prepared, &scene.views[0]);
    frame.unwrap_or_else(|e| panic!("{method}: {e}")).image
}

/// A method, or its name, made ready for a scene.
pub fn prepare(renderer: &Renderer, method: &(impl ToString + ?Sized), size: [u32; 2]) -> Prepared {
    let name = method.to_string();
    let prepared = name
        .parse()
        .and_then(|method| renderer.method(&method, MethodOptions::sized(size)));
    prepared.unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Runs a compute shader on buffers of inputs and of `count` answers.
pub fn run_text<T: bytemuck::Pod>(
    gpu: &Gpu,
    wgsl: &str,
    inputs: &[[f32; 4]],
    count: usize,
) -> Vec<T> {
    let input = gpu.upload("inputs", inputs, wgpu::BufferUsages::STORAGE);
    let bytes = (count * size_of::<T>()) as u64;
    let output = gpu
        .storage("answers", bytes)
        .unwrap_or_else(|e| panic!("{e}"));
    let bound = gpu.bind(
        "driver",
        wgpu::ShaderStages::COMPUTE,
        &[Bind::Read(&input), Bind::Write(&output)],
    );
    gpu.dispatch("driver", wgsl, &bound, (count as u32).div_ceil(64));
    gpu.read(&output, 0..bytes)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// A texture of one colour.
pub fn even(texel: [u8; 4]) -> Option<Arc<Texture>> {
    Some(Arc::new(Texture::of("even", [4, 4], |_, _| texel)))
}

/// A point light.
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

/// A quad facing the camera at depth `z` that covers the whole frame, and more.
pub fn wall(z: f32, material: Material) -> Object {
    let s = 1.5 * z;
    let v = |x: f32, y: f32| Vec3::new(x * s, y * s, -z);
    let (a, b, c, d) = (v(-1.0, -1.0), v(1.0, -1.0), v(1.0, 1.0), v(-1.0, 1.0));
    let mut wall = Object::of_triangles(&format!("wall at {z}"), &[[a, b, c], [a, c, d]], material);
    // It shows the whole of an image.
    let mesh = Arc::make_mut(&mut wall.mesh);
    let (a, b, c, d) = (Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO);
    mesh.uvs = vec![[a, b, c], [a, c, d]];
    wall
}

/// A scene of these objects.
pub fn scene(name: &str, background: [f32; 3], objects: Vec<Object>) -> Scene {
    Scene::generated(name, "a test", background, camera(), objects)
}

/// Every pixel of it holds exactly these fragments.
pub fn walls(fragments: &[Fragment], background: [f32; 3]) -> Scene {
    scene(
        "walls",
        background,
        fragments
            .iter()
            .map(|f| wall(f.depth, Material::unlit(f.color, f.alpha)))
            .collect(),
    )
}
