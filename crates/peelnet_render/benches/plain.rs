//! A scene of unlit transparent meshes without images, drawn by the renderer and by a path written for just that: one buffer of
//! vertices, one shader without a switch, two targets, one resolve. Measures what specialisation costs where nothing is needed.
//!
//! `cargo bench -p peelnet_render --bench plain`; frames in turn, the median of their ratios is what counts.

use peelnet_render::geometry::{
    Blend,
    frame::{Output, attachment, clear_color},
    fullscreen::FullscreenPass,
};
use peelnet_render::gpu::{
    AdapterRequest, Gpu, RenderPipeline,
    bind::{Bind, Bound},
    record::{Recorder, Timer},
    wgpu,
};
use peelnet_render::{MethodOptions, Renderer, milliseconds};
use peelnet_scene::{Camera, Effect, Scene, suite};
use std::error::Error;

const SIZE: [u32; 2] = [512, 384];
const FRAMES: usize = 61;

const SHADER: &str = "
struct Camera { clip_from_world: mat4x4f }
struct Surface { @builtin(position) position: vec4f, @location(0) depth: f32, @location(1) @interpolate(flat) material: u32 }
struct Sums { @location(0) color: vec4f, @location(1) alpha: f32 }
@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<storage, read> colors: array<vec4f>;

// A position and its material.
@vertex
fn vertex_main(@location(0) vertex: vec4f) -> Surface {
    let clip = camera.clip_from_world * vec4f(vertex.xyz, 1.0);
    return Surface(clip, clip.w, u32(vertex.w));
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    let color = colors[surface.material];
    let a = surface.depth / 200.0;
    let weight = color.a * clamp(0.03 / (1e-5 + a * a * a * a), 1e-2, 3e3);
    return Sums(vec4f(color.rgb * color.a, color.a) * weight, color.a);
}
";

const RESOLVE: &str = "
@group(0) @binding(0) var sums: texture_2d<f32>;
@group(0) @binding(1) var transmittances: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let transmittance = textureLoad(transmittances, pixel, 0).x;
    if transmittance == 1.0 {
        return vec4f(0.0);
    }
    let found = min(textureLoad(sums, pixel, 0), vec4f(65504.0));
    let average = found.rgb / max(found.a, 5.9604645e-8);
    return vec4f(average, 1.0) * (1.0 - transmittance);
}
";

/// The path written for just that.
struct Plain<'g> {
    gpu: &'g Gpu,
    vertices: wgpu::Buffer,
    count: u32,
    camera: wgpu::Buffer,
    scene: Bound,
    gather: wgpu::RenderPipeline,
    sums: wgpu::TextureView,
    transmittance: wgpu::TextureView,
    image: wgpu::TextureView,
    resolve: FullscreenPass,
    clear: [f64; 4],
}

impl<'g> Plain<'g> {
    fn new(gpu: &'g Gpu, scene: &Scene) -> Result<Self, Box<dyn Error>> {
        use wgpu::TextureFormat as T;
        let (mut vertices, mut colors) = (Vec::new(), Vec::new());
        for object in &scene.objects {
            for (part, material) in object.mesh.parts.iter().zip(&object.materials) {
                let [r, g, b] = material.color;
                let triangles = &object.mesh.triangles[part.triangles.clone()];
                for i in triangles.as_flattened() {
                    let position = object.mesh.positions[*i as usize];
                    let position = object.world_from_object.transform_point3(position);
                    let material = colors.len() as f32;
                    vertices.push(position.extend(material).to_array());
                }
                colors.push([r, g, b, material.alpha]);
            }
        }
        let none = wgpu::TextureUsages::empty();
        let texture = |label, format| gpu.texture(label, format, SIZE, 1, none);
        let sums = texture("sums", T::Rgba16Float)?;
        let transmittance = texture("transmittance", T::R16Float)?;
        // As the renderer's own profiles.
        let image = texture("image", T::Rgba16Float)?;
        let camera = gpu.upload("camera", &[[0.0f32; 16]], wgpu::BufferUsages::UNIFORM);
        let colors = gpu.upload("colors", &colors, wgpu::BufferUsages::STORAGE);
        let entries = [(0, Bind::Uniform(&camera)), (1, Bind::Read(&colors))];
        let scene_group = gpu.bind("scene", wgpu::ShaderStages::VERTEX_FRAGMENT, &entries);
        let buffers = [Some(wgpu::VertexBufferLayout {
            array_stride: 16,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4],
        })];
        let shader = peelnet_render::shaders::plain("plain", SHADER);
        let gather = gpu.render_pipeline(&RenderPipeline {
            label: "plain",
            vertex: &shader,
            fragment: &shader,
            groups: &[Some(&scene_group)],
            buffers: &buffers,
            targets: &[
                Some(Blend::Add.state(T::Rgba16Float)),
                Some(Blend::Transmit.state(T::R16Float)),
            ],
            depth: None,
            samples: 1,
            culled: None,
        });
        let output = Output::Target {
            format: T::Rgba16Float,
            samples: 1,
            over: true,
        };
        let resolve = FullscreenPass::new(
            gpu,
            "plain",
            &[],
            &[("plain", RESOLVE)],
            &[
                ("sums", Bind::Texture(&sums)),
                ("transmittances", Bind::Texture(&transmittance)),
            ],
            &[Some(output.state())],
            1,
        )?;
        let [r, g, b] = scene.background.map(f64::from);
        Ok(Self {
            vertices: gpu.upload("vertices", &vertices, wgpu::BufferUsages::VERTEX),
            count: vertices.len() as u32,
            gather,
            camera,
            scene: scene_group,
            sums,
            transmittance,
            image,
            resolve,
            clear: [r, g, b, 1.0],
            gpu,
        })
    }

    /// Draws a frame and returns its milliseconds.
    fn time(&self, camera: &Camera) -> Result<f64, Box<dyn Error>> {
        let start = std::time::Instant::now();
        let aspect = SIZE[0] as f32 / SIZE[1] as f32;
        let clip = camera.clip_from_view(aspect) * camera.view_from_world();
        let clip = clip.to_cols_array();
        let queue = &self.gpu.queue;
        queue.write_buffer(&self.camera, 0, bytemuck::bytes_of(&clip));
        let (mut encoder, mut timer) = (self.gpu.encoder(), Timer::new(self.gpu));
        let mut recorder = Recorder::new(self.gpu, &mut encoder, Some(&mut timer));
        let background = [clear_color(&self.image, self.clear)];
        drop(recorder.render("background", &background, None));
        {
            let targets = [
                clear_color(&self.sums, [0.0; 4]),
                clear_color(&self.transmittance, [1.0; 4]),
            ];
            let mut pass = recorder.render("gather", &targets, None);
            pass.set_pipeline(&self.gather);
            pass.set_bind_group(0, &self.scene.group, &[]);
            pass.set_vertex_buffer(0, self.vertices.slice(..));
            pass.draw(0..self.count, 0..1);
        }
        let over = attachment(&self.image, wgpu::LoadOp::Load);
        self.resolve.draw(&mut recorder, &[over], None);
        let times = timer.finish(self.gpu, &mut encoder);
        queue.submit([encoder.finish()]);
        let passes = self.gpu.block_on(times)?;
        let clock = start.elapsed().as_secs_f64() * 1e3;
        Ok(milliseconds(&passes).unwrap_or(clock))
    }
}

fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

fn main() -> Result<(), Box<dyn Error>> {
    let gpu = Gpu::open(&AdapterRequest::Auto)?;
    println!(
        "adapter {}, {}x{}, wboit-eq9, medians of {FRAMES} frames in turn",
        gpu.info.name, SIZE[0], SIZE[1]
    );
    for name in ["sixteen-050", "smoke-30", "panes"] {
        // Unlit, two-sided, without anything opaque.
        let scene = ["opaque", "lighting", "culling"]
            .into_iter()
            .filter_map(Effect::find)
            .fold(suite::load(name)?, |scene, effect| scene.without(effect));
        let camera = scene.views[0];
        let plain = Plain::new(&gpu, &scene)?;
        let renderer = Renderer::new(&gpu, &scene)?;
        assert_eq!(renderer.bindings(), ["camera", "materials"]);
        let mut prepared = renderer.method(&"wboit-eq9".parse()?, MethodOptions::sized(SIZE))?;
        let mut ours = || -> Result<f64, Box<dyn Error>> {
            let frame = renderer.profile(&mut prepared, &camera)?;
            Ok(milliseconds(&frame.times).unwrap_or(frame.wall_micros / 1e3))
        };
        plain.time(&camera)?;
        ours()?;
        let (mut times, mut ratios) = ([Vec::new(), Vec::new()], Vec::new());
        for i in 0..FRAMES {
            // Each goes first as often as the other.
            let (written, drawn) = if i % 2 == 0 {
                let written = plain.time(&camera)?;
                (written, ours()?)
            } else {
                let drawn = ours()?;
                (plain.time(&camera)?, drawn)
            };
            times[0].push(written);
            times[1].push(drawn);
            ratios.push(drawn / written);
        }
        // Both draw the same colours; alpha is coverage in images alone.
        let image = gpu.read_texture::<[u16; 4]>(&plain.image)?;
        let image = image
            .iter()
            .map(|p| p.map(|c| half::f16::from_bits(c).to_f32()));
        let image: Vec<[f32; 4]> = image.collect();
        let frame = renderer.image(&mut prepared, &camera)?;
        let differs = |(a, b): (&[f32; 4], &[f32; 4])| (0..3).any(|k| (a[k] - b[k]).abs() > 1e-3);
        let pairs = image.iter().zip(&frame.image.pixels);
        let apart = pairs.filter(|p| differs(*p)).count();
        let [written, drawn] = times.map(median);
        println!(
            "{name}: {written:.3} ms written for just that, {drawn:.3} ms the renderer: {:.3} times; {apart} of {} pixels differ",
            median(ratios),
            image.len()
        );
    }
    Ok(())
}
