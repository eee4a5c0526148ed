//! A scene of unlit transparent meshes without images, drawn by the renderer and by a path written for just that: one buffer of
//! vertices, one shader without a switch, two targets, one resolve. Measures what specialisation costs where nothing is needed.
//!
//! `cargo bench -p peelnet_render --bench plain`; frames in turn, the median of their ratios is what counts.

use bytemuck::{Pod, Zeroable};
use peelnet_gpu::{
    AdapterRequest, Gpu,
    bind::Bind,
    record::{Recorder, Timer},
    wgpu,
};
use peelnet_render::{MethodOptions, Renderer};
use peelnet_scene::{Camera, Effect, Scene, suite};

const SIZE: [u32; 2] = [512, 384];
const FRAMES: usize = 61;

const SHADER: &str = "
struct Camera { clip_from_world: mat4x4f }
struct Surface { @builtin(position) position: vec4f, @location(0) depth: f32, @location(1) @interpolate(flat) material: u32 }
struct Sums { @location(0) color: vec4f, @location(1) alpha: f32 }
@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<storage, read> colors: array<vec4f>;

@vertex
fn vertex_main(@location(0) position: vec3f, @location(1) material: u32) -> Surface {
    let clip = camera.clip_from_world * vec4f(position, 1.0);
    return Surface(clip, clip.w, material);
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

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

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

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Vertex {
    position: [f32; 3],
    material: u32,
}

/// The path written for just that.
struct Plain<'g> {
    gpu: &'g Gpu,
    vertices: wgpu::Buffer,
    count: u32,
    camera: wgpu::Buffer,
    scene: peelnet_gpu::bind::Bound,
    gather: wgpu::RenderPipeline,
    sums: wgpu::TextureView,
    transmittance: wgpu::TextureView,
    image: wgpu::TextureView,
    resolved: peelnet_gpu::bind::Bound,
    resolve: wgpu::RenderPipeline,
    clear: [f32; 3],
}

fn pipeline(
    gpu: &Gpu,
    wgsl: &str,
    layout: &wgpu::BindGroupLayout,
    buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
    targets: &[Option<wgpu::ColorTargetState>],
) -> wgpu::RenderPipeline {
    let module = gpu.shader("plain", wgsl);
    gpu.device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("plain"),
            layout: Some(&gpu.layout(&[Some(layout)])),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers,
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets,
            }),
            multiview_mask: None,
            cache: None,
        })
}

impl<'g> Plain<'g> {
    fn new(gpu: &'g Gpu, scene: &Scene) -> Self {
        let (mut vertices, mut colors) = (Vec::new(), Vec::new());
        for object in &scene.objects {
            for (part, material) in object.mesh.parts.iter().zip(&object.materials) {
                let [r, g, b] = material.color;
                for i in object.mesh.triangles[part.triangles.clone()]
                    .iter()
                    .flatten()
                {
                    let position = object.mesh.positions[*i as usize];
                    vertices.push(Vertex {
                        position: object
                            .world_from_object
                            .transform_point3(position)
                            .to_array(),
                        material: colors.len() as u32,
                    });
                }
                colors.push([r, g, b, material.alpha]);
            }
        }
        let texture = |label, format| {
            gpu.texture(label, format, SIZE, 1, wgpu::TextureUsages::empty())
                .unwrap_or_else(|e| panic!("{e}"))
        };
        use wgpu::{BlendFactor as F, TextureFormat as T};
        let [sums, transmittance, image] = [
            texture("sums", T::Rgba16Float),
            texture("transmittance", T::R16Float),
            // As the renderer's own profiles.
            texture("image", T::Rgba16Float),
        ];
        let camera = gpu.upload("camera", &[[0.0f32; 16]], wgpu::BufferUsages::UNIFORM);
        let colors = gpu.upload("colors", &colors, wgpu::BufferUsages::STORAGE);
        let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let bound = gpu.bind(
            "scene",
            both,
            &[Bind::Uniform(&camera), Bind::Read(&colors)],
        );
        let component = |src_factor, dst_factor| wgpu::BlendComponent {
            src_factor,
            dst_factor,
            operation: wgpu::BlendOperation::Add,
        };
        let target = |format, component| {
            Some(wgpu::ColorTargetState {
                format,
                blend: Some(wgpu::BlendState {
                    color: component,
                    alpha: component,
                }),
                write_mask: wgpu::ColorWrites::ALL,
            })
        };
        let gather = pipeline(
            gpu,
            SHADER,
            &bound.layout,
            &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Vertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32],
            })],
            &[
                target(T::Rgba16Float, component(F::One, F::One)),
                target(T::R16Float, component(F::Zero, F::OneMinusSrc)),
            ],
        );
        let entries = [&sums, &transmittance].map(Bind::Texture);
        let resolved = gpu.bind("resolve", wgpu::ShaderStages::FRAGMENT, &entries);
        let image_target = [Some(wgpu::ColorTargetState {
            format: T::Rgba16Float,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::ALL,
        })];
        let resolve = pipeline(gpu, RESOLVE, &resolved.layout, &[], &image_target);
        Self {
            vertices: gpu.upload("vertices", &vertices, wgpu::BufferUsages::VERTEX),
            count: vertices.len() as u32,
            camera,
            scene: bound,
            gather,
            sums,
            transmittance,
            image,
            resolved,
            resolve,
            clear: scene.background,
            gpu,
        }
    }

    /// Draws a frame and returns its milliseconds.
    fn time(&self, camera: &Camera) -> f64 {
        let start = std::time::Instant::now();
        let aspect = SIZE[0] as f32 / SIZE[1] as f32;
        let clip = camera.clip_from_view(aspect) * camera.view_from_world();
        self.gpu
            .queue
            .write_buffer(&self.camera, 0, bytemuck::bytes_of(&clip.to_cols_array()));
        fn clear(
            view: &wgpu::TextureView,
            to: [f32; 4],
        ) -> Option<wgpu::RenderPassColorAttachment<'_>> {
            let [r, g, b, a] = to.map(f64::from);
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                    store: wgpu::StoreOp::Store,
                },
            })
        }
        let (mut encoder, mut timer) = (self.gpu.encoder(), Timer::new(self.gpu));
        let mut recorder = Recorder::new(self.gpu, &mut encoder, Some(&mut timer));
        let [r, g, b] = self.clear;
        let background = [clear(&self.image, [r, g, b, 1.0])];
        drop(recorder.render("background", &background, None));
        {
            let targets = [
                clear(&self.sums, [0.0; 4]),
                clear(&self.transmittance, [1.0; 4]),
            ];
            let mut pass = recorder.render("gather", &targets, None);
            pass.set_pipeline(&self.gather);
            pass.set_bind_group(0, &self.scene.group, &[]);
            pass.set_vertex_buffer(0, self.vertices.slice(..));
            pass.draw(0..self.count, 0..1);
        }
        {
            let mut over = clear(&self.image, [0.0; 4]);
            if let Some(attachment) = &mut over {
                attachment.ops.load = wgpu::LoadOp::Load;
            }
            let mut pass = recorder.render("resolve", &[over], None);
            pass.set_pipeline(&self.resolve);
            pass.set_bind_group(0, &self.resolved.group, &[]);
            pass.draw(0..3, 0..1);
        }
        let times = timer.finish(self.gpu, &mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        let passes = self
            .gpu
            .block_on(times.read())
            .unwrap_or_else(|e| panic!("{e}"));
        let micros: f64 = passes.iter().map(|p| p.micros).sum();
        let clock = start.elapsed().as_secs_f64() * 1e6;
        (if micros > 0.0 { micros } else { clock }) / 1e3
    }
}

fn main() {
    let gpu = Gpu::open(&AdapterRequest::Auto).unwrap_or_else(|e| panic!("{e}"));
    println!(
        "adapter {}, {}x{}, wboit-eq9, medians of {FRAMES} frames in turn",
        gpu.info.name, SIZE[0], SIZE[1]
    );
    for name in ["sixteen-050", "smoke-30", "panes"] {
        let scene = suite::load(name).unwrap_or_else(|e| panic!("{e}"));
        // Unlit, two-sided, without anything opaque.
        let scene = [Effect::Opaque, Effect::Lighting, Effect::Culling]
            .into_iter()
            .fold(scene, |scene, effect| scene.without(effect));
        let camera = scene.views[0];
        let plain = Plain::new(&gpu, &scene);
        let renderer = Renderer::new(&gpu, &scene).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(renderer.bindings(), ["camera", "materials"]);
        let method = "wboit-eq9".parse().unwrap_or_else(|e| panic!("{e}"));
        let mut prepared = renderer
            .method(&method, MethodOptions::sized(SIZE))
            .unwrap_or_else(|e| panic!("{e}"));
        let mut times = [Vec::new(), Vec::new()];
        let mut ratios = Vec::new();
        let ours = |prepared: &mut _| {
            let timed = renderer.profile(prepared, &camera);
            let frame = timed.unwrap_or_else(|e| panic!("{e}"));
            let micros: f64 = frame.times.iter().map(|p| p.micros).sum();
            (if micros > 0.0 {
                micros
            } else {
                frame.wall_micros
            }) / 1e3
        };
        plain.time(&camera);
        ours(&mut prepared);
        for i in 0..FRAMES {
            // Each goes first as often as the other.
            let (written, drawn) = if i % 2 == 0 {
                let written = plain.time(&camera);
                (written, ours(&mut prepared))
            } else {
                let drawn = ours(&mut prepared);
                (plain.time(&camera), drawn)
            };
            times[0].push(written);
            times[1].push(drawn);
            ratios.push(drawn / written);
        }
        // Both draw the same.
        let image = gpu
            .read_rgba32f(&plain.image)
            .unwrap_or_else(|e| panic!("{e}"));
        let frame = renderer
            .image(&mut prepared, &camera)
            .unwrap_or_else(|e| panic!("{e}"));
        let differs = |(a, b): (&[f32; 4], &[f32; 4])| (0..4).any(|k| (a[k] - b[k]).abs() > 1e-3);
        let apart = image
            .iter()
            .zip(&frame.image.pixels)
            .filter(|p| differs(*p))
            .count();
        let median = |mut all: Vec<f64>| {
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        let [written, drawn] = times.map(median);
        println!(
            "{name}: {written:.3} ms written for just that, {drawn:.3} ms the renderer: {:.3} times; {apart} of {} pixels differ",
            median(ratios),
            image.len()
        );
    }
}
