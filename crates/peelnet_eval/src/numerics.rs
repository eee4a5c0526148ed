//! What target formats cost in accuracy: how far sums and products of blending are from the exact ones, measured on this
//! adapter, with the bound that follows from the format. docs/numerics.md explains the formulas.

use crate::EvalError;
use peelnet_core::{fragment::Fragment, methods::over, random::Random};
use peelnet_gpu::{
    Gpu, GpuError,
    bind::Bind,
    record::Recorder,
    wgpu::{self, BlendFactor, BlendOperation, TextureFormat},
};
use peelnet_render::{Image, MethodOptions, MethodSpec, RenderError, Renderer};
use peelnet_scene::{Camera, Material, Object, Scene};
use serde::{Deserialize, Serialize};

/// A sum or product of blending in one format.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Blended {
    /// The format: `R8`, `R16F`, `R32F`, `RGBA16F`, `RGBA32F`.
    pub format: String,
    /// `transmittance` (`dst · (1 − src)`) or `sum` (`dst + src`).
    pub blending: String,
    /// The opacity, or the term of the sum.
    pub source: f32,
    /// How often it is blended.
    pub layers: u32,
    /// What the target should hold, in 64 bits.
    pub exact: f64,
    /// What it holds; none where that is not finite.
    pub measured: Option<f64>,
    /// The most that it can be off.
    pub bound: f64,
}

impl Blended {
    /// The distance from the exact value; infinite where the target is not finite.
    pub fn error(&self) -> f64 {
        self.measured
            .map_or(f64::INFINITY, |m| (m - self.exact).abs())
    }
}

/// What 16-bit targets add to the error of a method, against 32-bit ones, over random stacks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Added {
    /// The method.
    pub method: String,
    /// Layers of each stack.
    pub layers: u32,
    /// Largest difference of any component between the two, linear light.
    pub worst: f64,
    /// Root of the mean squared difference.
    pub typical: f64,
    /// The largest error of the method itself with 32-bit targets, for comparison.
    pub own_error: f64,
    /// The bound of a weighted mean of `n` terms: both sums round `n` times, and in one direction, so that their quotient errs by `n`
    /// roundings of itself; so does the transmittance, and what it takes from the one it gives to the other. None for moments, which are
    /// read through the roots of a polynomial, and where the bound is more than a tenth of the brightest colour: it says nothing there.
    pub bound: Option<f64>,
}

/// Everything that was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numerics {
    /// Formats by themselves.
    pub blended: Vec<Blended>,
    /// Methods in 16 bits against 32.
    pub added: Vec<Added>,
}

/// Where a format ends.
fn largest(format: TextureFormat) -> f64 {
    match format {
        TextureFormat::R8Unorm => 1.0,
        TextureFormat::R16Float | TextureFormat::Rgba16Float => 65_504.0,
        _ => f64::from(f32::MAX),
    }
}

fn name(format: TextureFormat) -> &'static str {
    match format {
        TextureFormat::R8Unorm => "R8",
        TextureFormat::R16Float => "R16F",
        TextureFormat::R32Float => "R32F",
        TextureFormat::Rgba16Float => "RGBA16F",
        _ => "RGBA32F",
    }
}

/// How an adapter rounds what it blends: the specifications leave it open.
#[derive(Clone, Copy, Debug)]
struct Rounding {
    /// Of results: to the nearest number of the format, else towards zero, as blending in halves does in software here.
    to_nearest: bool,
    /// Whether the source is first rounded to the format. It always is in R8, to the nearest.
    source: bool,
}

const ROUNDINGS: [Rounding; 4] = {
    const fn of(to_nearest: bool, source: bool) -> Rounding {
        Rounding { to_nearest, source }
    }
    [
        of(true, true),
        of(true, false),
        of(false, true),
        of(false, false),
    ]
};

/// The distance between a format's numbers at a value: constant, or that of a significand of so many bits.
fn step(format: TextureFormat, x: f64) -> f64 {
    let floating = |bits: i32, least: i32| {
        // The least exponent of normal numbers, which 0 has too.
        let exponent = x.log2().max(f64::from(least)).floor();
        2f64.powi(exponent as i32 - bits)
    };
    match format {
        TextureFormat::R8Unorm => 1.0 / 255.0,
        TextureFormat::R16Float | TextureFormat::Rgba16Float => floating(10, -14),
        _ => floating(23, -126),
    }
}

/// The number of a format that a value becomes.
fn rounded(format: TextureFormat, x: f64, to_nearest: bool) -> f64 {
    let x = x.min(largest(format));
    let step = step(format, x);
    let steps = x / step;
    // What 64 bits left just below a number of the format is that number.
    let cut = (steps * (1.0 + 1e-12)).floor();
    (if to_nearest {
        steps.round_ties_even()
    } else {
        cut
    }) * step
}

/// What a target holds after blending `n` times with one way of rounding.
fn emulated(format: TextureFormat, product: bool, source: f64, n: u32, rounding: Rounding) -> f64 {
    let source = if rounding.source || format == TextureFormat::R8Unorm {
        rounded(
            format,
            source,
            rounding.to_nearest || format == TextureFormat::R8Unorm,
        )
    } else {
        source
    };
    let start = f64::from(u8::from(product));
    (0..n).fold(start, |held, _| {
        let next = if product {
            held * (1.0 - source)
        } else {
            held + source
        };
        rounded(format, next, rounding.to_nearest)
    })
}

/// The most that a target can be off: what the worst way of rounding gives, and one step more.
fn bound(format: TextureFormat, product: bool, source: f64, n: u32, exact: f64) -> f64 {
    let off = ROUNDINGS.map(|r| {
        let held = emulated(format, product, source, n, r);
        (held - exact).abs() + step(format, held)
    });
    off.into_iter().fold(0.0, f64::max)
}

/// Measures all formats and methods.
///
/// # Errors
/// A GPU that fails.
pub fn measure(gpu: &Gpu) -> Result<Numerics, EvalError> {
    Ok(Numerics {
        blended: blended(gpu)?,
        added: added(gpu)?,
    })
}

/// The formats by themselves. Formats that the adapter cannot blend are left out.
///
/// # Errors
/// A GPU that fails.
pub fn blended(gpu: &Gpu) -> Result<Vec<Blended>, EvalError> {
    use TextureFormat as F;
    let full = gpu.has(wgpu::Features::FLOAT32_BLENDABLE);
    let mut all = Vec::new();
    let products = [F::R8Unorm, F::R16Float, F::R32Float];
    let opacities = [
        (0.0001, 1024),
        (0.001, 256),
        (0.005, 256),
        (0.05, 32),
        (0.3, 8),
        (0.9, 4),
        (0.99, 2),
    ];
    let sums = [F::Rgba16Float, F::Rgba32Float];
    let terms = [
        (1.0, 1000),
        (1.0, 2048),
        (1.0, 3000),
        (0.1, 4096),
        (3000.0, 21),
        (3000.0, 22),
        (3000.0, 64),
    ];
    let cases = products.map(|f| (f, &opacities[..], true)).into_iter();
    for (format, sources, product) in cases.chain(sums.map(|f| (f, &terms[..], false))) {
        if matches!(format, F::R32Float | F::Rgba32Float) && !full {
            continue;
        }
        for &(source, layers) in sources {
            let (s, n) = (f64::from(source), f64::from(layers));
            let measured = blend(gpu, format, product, source, layers)?;
            all.push(Blended {
                format: name(format).to_owned(),
                blending: if product { "transmittance" } else { "sum" }.to_owned(),
                source,
                layers,
                exact: if product { (1.0 - s).powf(n) } else { s * n },
                measured: measured.is_finite().then_some(measured.into()),
                bound: bound(
                    format,
                    product,
                    s,
                    layers,
                    if product { (1.0 - s).powf(n) } else { s * n },
                ),
            });
        }
    }
    Ok(all)
}

const SHADER: &str = "
@group(0) @binding(0) var<uniform> source: vec4f;
@vertex fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0, 0.0, 1.0);
}
@fragment fn fragment_main() -> @location(0) vec4f { return source; }
@group(0) @binding(1) var target_texture: texture_2d<f32>;
@group(0) @binding(2) var<storage, read_write> answer: array<f32>;
@compute @workgroup_size(1) fn main() { answer[0] = textureLoad(target_texture, vec2u(0u), 0).x; }
";

/// What a target of one pixel holds after `layers` equal fragments.
fn blend(
    gpu: &Gpu,
    format: TextureFormat,
    product: bool,
    source: f32,
    layers: u32,
) -> Result<f32, EvalError> {
    let failed = |e: GpuError| EvalError::render("numerics", name(format))(RenderError::Gpu(e));
    let none = wgpu::TextureUsages::empty();
    let view = gpu
        .texture("target", format, [1, 1], 1, none)
        .map_err(failed)?;
    let answer = gpu.storage("answer", 4).map_err(failed)?;
    let uniform = gpu.upload("source", &[[source; 4]], wgpu::BufferUsages::UNIFORM);
    let stages = wgpu::ShaderStages::FRAGMENT;
    let drawn = gpu.bind("blend", stages, &[Bind::Uniform(&uniform)]);
    let read = gpu.bind(
        "read",
        wgpu::ShaderStages::COMPUTE,
        &[
            Bind::Uniform(&uniform),
            Bind::Texture(&view),
            Bind::Write(&answer),
        ],
    );
    let pipeline = pipeline(gpu, format, product, &drawn.layout);
    let reader = gpu.compute("read", SHADER, &read);
    let mut encoder = gpu.encoder();
    let mut recorder = Recorder::new(gpu, &mut encoder, None);
    {
        let start = f64::from(u8::from(product));
        let color = wgpu::Color {
            r: start,
            g: start,
            b: start,
            a: start,
        };
        let attachment = Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(color),
                store: wgpu::StoreOp::Store,
            },
        });
        let mut pass = recorder.render("blend", &[attachment], None);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &drawn.group, &[]);
        // Instances blend one after the other.
        pass.draw(0..3, 0..layers);
    }
    {
        let mut pass = recorder.compute("read");
        pass.set_pipeline(&reader);
        pass.set_bind_group(0, &read.group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
    gpu.queue.submit([encoder.finish()]);
    let found: Vec<f32> = gpu.read(&answer, 0..4).map_err(failed)?;
    Ok(found[0])
}

/// A pipeline that blends fragments over the whole target.
fn pipeline(
    gpu: &Gpu,
    format: TextureFormat,
    product: bool,
    drawn: &wgpu::BindGroupLayout,
) -> wgpu::RenderPipeline {
    let module = gpu.shader("numerics", SHADER);
    let component = wgpu::BlendComponent {
        src_factor: if product {
            BlendFactor::Zero
        } else {
            BlendFactor::One
        },
        dst_factor: if product {
            BlendFactor::OneMinusSrc
        } else {
            BlendFactor::One
        },
        operation: BlendOperation::Add,
    };
    let blend = wgpu::BlendState {
        color: component,
        alpha: component,
    };
    gpu.device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("numerics"),
            layout: Some(&gpu.layout(&[Some(drawn)])),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format,
                    blend: Some(blend),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
}

/// Methods without a network whose targets may have either precision, on stacks of these many layers.
const LAYERS: [u32; 4] = [4, 16, 64, 256];

/// Stacks of each number of layers: one a pixel.
const STACKS: [u32; 2] = [8, 8];

/// A bound of more, of colours up to 1, is not worth its name.
const LARGEST_BOUND: f64 = 0.1;

fn added(gpu: &Gpu) -> Result<Vec<Added>, EvalError> {
    let mut all = Vec::new();
    if !gpu.has(wgpu::Features::FLOAT32_BLENDABLE) {
        return Ok(all);
    }
    for layers in LAYERS {
        let (scene, exact) = stacks(layers);
        let failed = |method: &str| EvalError::render(&scene.name, method);
        let renderer = Renderer::new(gpu, &scene).map_err(failed("upload"))?;
        for declared in peelnet_render::METHODS {
            if declared.learned || !declared.has_targets() {
                continue;
            }
            let spec = MethodSpec::representative(declared);
            let method = spec.to_string();
            let draw = |targets: &str| -> Result<Image, EvalError> {
                let spec = spec.with("targets", targets).map_err(failed(&method))?;
                let name = spec.to_string();
                let prepared = renderer.method(&spec, MethodOptions::sized(STACKS));
                let mut prepared = prepared.map_err(failed(&name))?;
                let frame = renderer.image(&mut prepared, &scene.views[0]);
                Ok(frame.map_err(failed(&name))?.image)
            };
            let [half, full] = [draw("f16")?, draw("f32")?];
            let (mut worst, mut squares, mut own_error) = (0.0f64, 0.0, 0.0f64);
            for ((a, b), exact) in half.pixels.iter().zip(&full.pixels).zip(&exact) {
                for k in 0..3 {
                    let difference = f64::from((a[k] - b[k]).abs());
                    worst = worst.max(difference);
                    squares += difference * difference;
                    own_error = own_error.max((f64::from(b[k]) - exact[k]).abs());
                }
            }
            let n = f64::from(layers);
            all.push(Added {
                method,
                layers,
                worst,
                typical: (squares / (3 * exact.len()) as f64).sqrt(),
                own_error,
                // Roots of the statistics have no bound as simple.
                bound: Some((n + 1.0) * 0.5f64.powi(10))
                    .filter(|bound| spec.promises().root.is_none() && *bound <= LARGEST_BOUND),
            });
        }
    }
    all.sort_by_key(|a| {
        let place = peelnet_render::METHODS
            .iter()
            .position(|m| a.method.starts_with(m.name));
        (place, a.layers)
    });
    Ok(all)
}

/// One random stack a pixel, side by side, and its exact colours.
fn stacks(layers: u32) -> (Scene, Vec<[f64; 3]>) {
    let mut random = Random::new(u64::from(layers), &[]);
    let [width, height] = STACKS;
    let background = [0.2, 0.4, 0.6];
    let (mut objects, mut exact) = (Vec::new(), Vec::new());
    for i in 0..width * height {
        let (x, y) = (i % width, i / width);
        let mut fragments = Vec::new();
        // About a third of the light passes whatever the number.
        let mean = 1.0 - (1.0f32 / 3.0).powf(1.0 / layers as f32);
        for k in 0..layers {
            let depth = 1.0 + 20.0 * (k as f32 + random.unit()) / layers as f32;
            let f = Fragment {
                triangle: 2 * objects.len() as u32,
                ..Fragment::new(depth, (mean * 2.0 * random.unit()).min(1.0), random.color())
            };
            let v = |px: u32, py: u32| {
                glam::Vec3::new(
                    (2.0 * px as f32 / width as f32 - 1.0) * depth,
                    (1.0 - 2.0 * py as f32 / height as f32) * depth,
                    -depth,
                )
            };
            let [a, b, c, d] = [v(x, y + 1), v(x + 1, y + 1), v(x + 1, y), v(x, y)];
            let material = Material::unlit(f.color, f.alpha);
            objects.push(Object::of_triangles(
                "layer",
                &[[a, b, c], [a, c, d]],
                material,
            ));
            fragments.push(f);
        }
        exact.push(over::composite_f64(&fragments, background));
    }
    let camera = Camera {
        position: glam::Vec3::ZERO,
        target: glam::Vec3::NEG_Z,
        up: glam::Vec3::Y,
        fov_y_degrees: 90.0,
        near: 0.1,
        far: 100.0,
    };
    let name = format!("{layers} layers");
    let scene = Scene::generated(&name, "the precision study", background, camera, objects);
    (scene, exact)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The emulation against numbers that are known: halves stop at 2,048 ones, and end; R8 loses opacities below half a step.
    #[test]
    fn formats_round_as_they_are_known_to() {
        use TextureFormat as F;
        let nearest = ROUNDINGS[1];
        let cut = ROUNDINGS[3];
        assert_eq!(emulated(F::Rgba16Float, false, 1.0, 3000, nearest), 2048.0);
        assert_eq!(
            emulated(F::Rgba16Float, false, 3000.0, 64, nearest),
            65_504.0
        );
        assert_eq!(emulated(F::Rgba32Float, false, 1.0, 3000, cut), 3000.0);
        assert_eq!(emulated(F::R8Unorm, true, 0.001, 256, cut), 1.0);
        assert_eq!(emulated(F::R8Unorm, true, 1.0, 1, nearest), 0.0);
        for x in [1.0, 0.333, 6e-8, 1e-5, 1000.7, 65_000.0] {
            let half = f64::from(half::f16::from_f64(x));
            assert_eq!(rounded(F::R16Float, x, true), half, "{x}");
            let cut = rounded(F::R16Float, x, false);
            assert!(cut <= x && x - cut < step(F::R16Float, x), "{x}: {cut}");
            assert_eq!(rounded(F::R32Float, x, true), f64::from(x as f32), "{x}");
        }
    }

    /// A bound reaches the whole value only where a way of rounding loses the whole value.
    #[test]
    fn bounds_are_of_what_is_lost() {
        use TextureFormat as F;
        let of = |format, alpha: f64, n: u32| {
            let exact = (1.0 - alpha).powf(n.into());
            bound(format, true, alpha, n, exact) / exact
        };
        assert!(of(F::R16Float, 0.3, 8) < 0.01 && of(F::R16Float, 0.9, 4) < 0.01);
        assert!(of(F::R32Float, 0.0001, 1024) < 2e-4);
        assert!(of(F::R8Unorm, 0.3, 8) < 0.3);
        let sum = |term: f64, n: u32| {
            let exact = term * f64::from(n);
            bound(F::Rgba16Float, false, term, n, exact) / exact
        };
        assert!(sum(1.0, 1000) < 1e-3 && sum(3000.0, 21) < 0.02);
        // All beyond 2,048 are lost, where a step is 2.
        assert!((sum(1.0, 3000) - 954.0 / 3000.0).abs() < 1e-9);
    }
}
