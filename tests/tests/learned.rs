//! The learned methods: the exported text against its CPU twin, closed forms, scale, hard cases. All with the shipped
//! networks.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_core::{
    absorbance::{DepthWarp, absorbance},
    fragment::Fragment,
    methods::{
        anchored::{self, Place, Seen, seen},
        over,
    },
    random::Random,
    statistics::{FAR_END, NEAR_END, SumPrecision},
};
use peelnet_gpu::{Gpu, bind::Bind, record::Recorder, wgpu};
use peelnet_model::{Model, Recipe};
use peelnet_render::{Image, LearnedWeight, MethodSpec, Renderer, srgb_encode};
use peelnet_scene::{Scene, suite};
use peelnet_tests::{gpu, walls};
use std::path::Path;

const ANCHORED: [Recipe; 3] = [Recipe::Small, Recipe::Medium, Recipe::Large];

fn shipped(recipe: Recipe) -> Model {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let file = root.join(format!("models/{recipe}/model.safetensors"));
    Model::load(&file).unwrap_or_else(|e| panic!("{e}; make it with: cargo xtask train-models"))
}

fn learned(model: &Model) -> LearnedWeight {
    LearnedWeight {
        recipe: model.meta.recipe,
        wgsl: peelnet_export::wgsl(model, &Default::default()).unwrap(),
    }
}

/// Both precisions of a learned method's targets.
fn specs(recipe: Recipe) -> [MethodSpec; 2] {
    ["f16", "f32"].map(|targets| {
        format!("{}:targets={targets}", recipe.method_name())
            .parse()
            .unwrap()
    })
}

fn draw(gpu: &Gpu, scene: &Scene, spec: &MethodSpec, model: &Model, size: [u32; 2]) -> Image {
    let renderer = Renderer::new(gpu, scene).unwrap();
    let mut prepared = renderer.prepare(spec, size, Some(&learned(model))).unwrap();
    renderer.draw(&mut prepared, &scene.views[0]).unwrap().image
}

/// Relative rounding of a half float.
const HALF: f64 = 1.0 / 2048.0;

// ---------------------------------------------------------------------------------------------------------------------
// The exported text, function by function.

/// A pixel's fragments as (warped depth, α), front to back in no order.
type Points = Vec<(f32, f32)>;

/// Pixels of every kind: few and many layers, narrow and wide, faint, opaque, equal depths.
///
/// A depth or opacity that lies on the edge between two levels may be rounded to either, in 32 bits otherwise than in 64:
/// such values are drawn again, so that the same fragments are the ends on both sides.
fn pixels() -> Vec<Points> {
    let mut random = Random::new(31, &[]);
    let clear = |x: f64| (x - x.round()).abs() > 1e-2;
    (0..600)
        .map(|i| {
            let n = [1, 2, 3, 4, 5, 8, 13, 40][i % 8];
            let (from, width) = (random.between(-1.0, 0.8), random.between(0.01, 1.9));
            let kind = random.below(4);
            (0..n)
                .map(|_| {
                    loop {
                        let zeta = (from + width * random.unit()).min(1.0);
                        let alpha = match kind {
                            0 => random.between(0.01, 0.2),
                            1 => random.between(0.7, 1.0),
                            2 => [0.001, 0.3, 1.0][random.below(3) as usize],
                            _ => random.between(0.02, 0.98),
                        };
                        let t = f64::from(zeta) * 0.5 + 0.5;
                        let b = absorbance(alpha);
                        let opacity = b / (b + 1.0) * 1.0625;
                        let levels = [
                            t * 61_439.0 + 0.5,
                            t * f64::from(NEAR_END.bins),
                            t * f64::from(FAR_END.bins),
                            opacity * f64::from(NEAR_END.alphas - 1) + 0.5,
                            opacity * f64::from(FAR_END.alphas - 1) + 0.5,
                        ];
                        // α = 0.001 and 1 have levels of their own.
                        let fixed = [0.001, 0.3, 1.0].contains(&alpha);
                        if levels[..3].iter().copied().all(clear)
                            && (fixed || levels[3..].iter().copied().all(clear))
                        {
                            break (zeta, alpha);
                        }
                    }
                })
                .collect()
        })
        .collect()
}

/// What `peelnet_place`, `peelnet_features` and `peelnet_fragment` say of every fragment, with targets that add and take
/// maxima as blending does: end, absorbance in front, five features, weight.
fn on_the_gpu(gpu: &Gpu, model: &Model, pixels: &[Points], half: bool) -> Vec<[f32; 8]> {
    let rounded = if half {
        "vec4f(unpack2x16float(pack2x16float(x.xy)), unpack2x16float(pack2x16float(x.zw)))"
    } else {
        "x"
    };
    let root = format!(
        "import package::learned::weight::{{peelnet_statistics, peelnet_place, peelnet_features, peelnet_fragment}};
        @group(0) @binding(0) var<storage, read> fragments: array<vec4f>;
        @group(0) @binding(1) var<storage, read_write> answers: array<vec4f>;
        fn stored(x: vec4f) -> vec4f {{ return {rounded}; }}
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x >= arrayLength(&fragments) {{ return; }}
            let own = fragments[id.x];
            var moments = vec4f(0.0);
            var extent = vec4f(vec3f(-65504.0), 0.0);
            for (var i = u32(own.z); i < u32(own.w); i++) {{
                let s = peelnet_statistics(fragments[i].y, fragments[i].x);
                moments = stored(moments + stored(s.moments));
                let e = stored(s.extent);
                extent = stored(vec4f(max(extent.xyz, e.xyz), extent.w + e.w));
            }}
            let place = peelnet_place(own.y, own.x, moments, extent);
            let f = peelnet_features(place, moments, extent);
            let w = peelnet_fragment(own.y, own.x, moments, extent);
            answers[2u * id.x] = vec4f(place.end, place.in_front, f.root_absorbance, f.depth_fraction);
            answers[2u * id.x + 1u] = vec4f(f.mean_fraction, f.share_low, f.share_high, w.x);
        }}"
    );
    let text = learned(model).wgsl;
    let wgsl = peelnet_shaders::link(
        "driver",
        &[],
        &[("driver", &root), ("learned::weight", &text)],
    )
    .unwrap();
    let mut fragments: Vec<[f32; 4]> = Vec::new();
    for pixel in pixels {
        let first = fragments.len();
        let end = (first + pixel.len()) as f32;
        fragments.extend(pixel.iter().map(|&(z, a)| [z, a, first as f32, end]));
    }
    let input = gpu.upload("fragments", &fragments, wgpu::BufferUsages::STORAGE);
    let bytes = fragments.len() as u64 * 32;
    let output = gpu.storage("answers", bytes).unwrap();
    let bound = gpu.bind(
        "driver",
        wgpu::ShaderStages::COMPUTE,
        &[Bind::Read(&input), Bind::Write(&output)],
    );
    let pipeline = gpu.compute("driver", &wgsl, &[&bound.layout]);
    let mut recorder = Recorder::new(gpu, false);
    {
        let mut pass = recorder.compute("driver");
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bound.group, &[]);
        pass.dispatch_workgroups((fragments.len() as u32).div_ceil(64), 1, 1);
    }
    recorder.finish().unwrap();
    gpu.read(&output, 0..bytes).unwrap()
}

/// Depth from −1 … 1 by e^ζ, so that ζ is what the range's logarithm gives back.
fn on_the_cpu(pixel: &[(f32, f32)], precision: SumPrecision) -> Vec<Seen> {
    let warp = DepthWarp {
        log_near: -1.0,
        scale: 1.0,
    };
    let points: Vec<(f64, f32)> = pixel.iter().map(|&(z, a)| (z.into(), a)).collect();
    anchored::seen_at(&points, &warp_identity(&warp), precision)
}

fn warp_identity(warp: &DepthWarp) -> DepthWarp {
    *warp
}
