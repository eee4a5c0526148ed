//! Dual depth peeling (Bavoil & Myers, NVIDIA 2008): the geometry passes.
//!
//! One RG32F target holds `(−nearest, farthest)` under MAX blending; each pass peels both ends of what is left. Two
//! coplanar fragments match the same end, and blending keeps the component-wise maximum of their colours: the known
//! flaw, which callers count as fragments found less than there are.

use crate::{
    FrameTargets, GeometryPass, GeometryPipelines, RasterError, SceneBuffers, Surfaces,
    frame::clear_color,
};
use peelnet_gpu::{
    Gpu, GpuError,
    bind::{Bind, Bound},
    record::Recorder,
    wgpu,
};

/// Below every depth, see `peel/dual.wgsl`.
const NOTHING: f64 = -3.0e38;

/// Bytes of the targets, a pixel: two ranges in turn, front and back layer.
pub const BYTES_PER_PIXEL: f64 = 2.0 * 8.0 + 2.0 * 16.0;

/// The targets and pipelines of dual peeling.
#[derive(Debug)]
pub struct DualPeel {
    /// `(−nearest, farthest)` of what is left, written in turn.
    pub ranges: [wgpu::TextureView; 2],
    /// The layer peeled from the front in the last pass.
    pub front: wgpu::TextureView,
    /// The layer peeled from the back.
    pub back: wgpu::TextureView,
    init: GeometryPipelines,
    peel: GeometryPipelines,
    groups: [Bound; 2],
}

impl DualPeel {
    /// Builds the passes.
    ///
    /// # Errors
    /// Adapters without 32-bit blending or with fewer than 40 bytes of colour a sample are refused, with the way out.
    pub fn new(
        gpu: &Gpu,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        features: &[&str],
    ) -> Result<Self, RasterError> {
        const HINT: &str = "use S-buffer or single peeling, or the methods abuffer or depth-peel";
        gpu.need(
            wgpu::Features::FLOAT32_BLENDABLE,
            "float32-blendable",
            "dual depth peeling",
            HINT,
        )?;
        const SAMPLE_BYTES: u32 = 8 + 16 + 16;
        if gpu.limits.max_color_attachment_bytes_per_sample < SAMPLE_BYTES {
            return Err(RasterError::Gpu(GpuError::TooLarge {
                what: "dual depth peeling with its colour targets".into(),
                needed: u64::from(SAMPLE_BYTES),
                limit: u64::from(gpu.limits.max_color_attachment_bytes_per_sample),
                unit: "bytes a sample",
                adapter: gpu.info.name.clone(),
                hint: HINT,
            }));
        }
        let texture = |label: &str, format| {
            gpu.texture(label, format, frame.size, 1, wgpu::TextureUsages::empty())
        };
        let (range_format, layer_format) = (
            wgpu::TextureFormat::Rg32Float,
            wgpu::TextureFormat::Rgba32Float,
        );
        let ranges = [
            texture("depth range", range_format)?,
            texture("depth range", range_format)?,
        ];
        let groups = [0, 1].map(|i| {
            gpu.bind(
                "depth range",
                wgpu::ShaderStages::FRAGMENT,
                &[Bind::Texture(&ranges[i])],
            )
        });
        // Min and max blending require both factors to be one.
        let component = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Max,
        };
        let max = |format| {
            Some(wgpu::ColorTargetState {
                format,
                blend: Some(wgpu::BlendState {
                    color: component,
                    alpha: component,
                }),
                write_mask: wgpu::ColorWrites::ALL,
            })
        };
        let init = scene.pipelines(
            gpu,
            frame,
            Surfaces::Transparent,
            &GeometryPass {
                label: "dual init",
                shader: "peel::dual_init",
                features,
                targets: &[max(range_format)],
                ..GeometryPass::NONE
            },
        )?;
        let peel = scene.pipelines(
            gpu,
            frame,
            Surfaces::Transparent,
            &GeometryPass {
                label: "dual peel",
                shader: "peel::dual",
                features,
                group: Some(&groups[0]),
                targets: &[max(range_format), max(layer_format), max(layer_format)],
                ..GeometryPass::NONE
            },
        )?;
        Ok(Self {
            ranges,
            front: texture("front layer", layer_format)?,
            back: texture("back layer", layer_format)?,
            init,
            peel,
            groups,
        })
    }

    /// The first pass: initialises `ranges[0]`.
    pub fn init(&self, recorder: &mut Recorder<'_>, scene: &SceneBuffers, frame: &FrameTargets) {
        let range = clear_color(&self.ranges[0], [NOTHING; 4]);
        let mut pass = recorder.render("dual init", &[range], None);
        scene.draw(&mut pass, frame, Surfaces::Transparent, &self.init);
    }

    /// Peeling pass `index` (from 0): reads `ranges[index % 2]`, writes the other one and both layers.
    pub fn peel(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        index: u32,
    ) {
        let from = (index % 2) as usize;
        let targets = [
            clear_color(&self.ranges[1 - from], [NOTHING; 4]),
            clear_color(&self.front, [0.0; 4]),
            clear_color(&self.back, [0.0; 4]),
        ];
        let mut pass = recorder.render("dual peel", &targets, None);
        pass.set_bind_group(1, &self.groups[from].group, &[]);
        scene.draw(&mut pass, frame, Surfaces::Transparent, &self.peel);
    }
}
