//! What the tests share: one way to open a GPU, scenes with known answers, and the judge's view of a scene.

pub mod readers;

use glam::{Vec2, Vec3};
use peelnet_core::{absorbance::DepthWarp, fragment::Fragment};
use peelnet_gpu::{AdapterRequest, Gpu, bind::Bind, wgpu};
use peelnet_model::{Model, Recipe};
use peelnet_render::{Image, LearnedWeight, MethodOptions, MethodSpec, Renderer};
use peelnet_scene::{Camera, Light, Material, Object, Scene, Source, Texture};
use std::sync::Arc;

/// The folder of the committed results of a step of `cargo xtask measure`, such as `held-out`. Machines come and go: each step's results are of one,
/// and its folder has that machine's name.
pub fn results(step: &str) -> String {
    let machine = match step {
        "held-out" | "validation" | "path" | "samples" | "stress" => "llvmpipe-xeon-2cores",
        _ => "llvmpipe-epyc-2cores",
    };
    format!("docs/results/{machine}/{step}")
}

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

/// Draws a scene's first view with a method that needs no network.
pub fn draw(gpu: &Gpu, scene: &Scene, method: &str, size: [u32; 2]) -> Image {
    let drawn = || {
        let renderer = Renderer::new(gpu, scene)?;
        let mut prepared = renderer.method(&method.parse()?, MethodOptions::sized(size))?;
        renderer.image(&mut prepared, &scene.views[0])
    };
    drawn().unwrap_or_else(|e| panic!("{e}")).image
}

/// Runs `body`, which reads `a = inputs[2i]` and `b = inputs[2i + 1]` and sets `y`, with functions of an exported text.
pub fn evaluate_text(
    gpu: &Gpu,
    text: &str,
    functions: &str,
    body: &str,
    inputs: &[[[f32; 4]; 2]],
) -> Vec<[f32; 4]> {
    let root = format!(
        "import package::learned::weight::{{{functions}}};
        @group(0) @binding(0) var<storage, read> inputs: array<vec4f>;
        @group(0) @binding(1) var<storage, read_write> answers: array<vec4f>;
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x >= arrayLength(&answers) {{ return; }}
            let a = inputs[2u * id.x];
            let b = inputs[2u * id.x + 1u];
            var y = vec4f(0.0);
            {body}
            answers[id.x] = y;
        }}"
    );
    let sources = [("driver", root.as_str()), ("learned::weight", text)];
    let wgsl = peelnet_shaders::link("driver", &[], &sources).unwrap_or_else(|e| panic!("{e}"));
    run_text(gpu, &wgsl, inputs.as_flattened(), inputs.len())
}

/// A pixel's fragments as (linear depth, α), in no order.
pub type Points = Vec<(f32, f32)>;

/// WGSL for `x` as a target of 16 bits keeps it, or one of 32.
pub const fn stored(half: bool) -> &'static str {
    if half {
        "vec4f(unpack2x16float(pack2x16float(x.xy)), unpack2x16float(pack2x16float(x.zw)))"
    } else {
        "x"
    }
}

/// Rows `(ζ, α, first, end)` of all fragments of pixels, each with the rows of its pixel.
pub fn in_runs(pixels: &[Points], warp: &DepthWarp) -> Vec<[f32; 4]> {
    let mut rows: Vec<[f32; 4]> = Vec::new();
    for pixel in pixels {
        let first = rows.len();
        let end = (first + pixel.len()) as f32;
        let fragments = pixel.iter();
        rows.extend(fragments.map(|&(z, a)| [warp.apply(z.into()) as f32, a, first as f32, end]));
    }
    rows
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
