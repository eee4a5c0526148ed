//! Depth peeling front to back (Everitt, NVIDIA 2001): the geometry passes. Portable WebGPU throughout, and lossless
//! on coplanar fragments, see `peel/single.wgsl`.

use crate::{
    FrameTargets, GeometryPass, GeometryPipelines, RasterError, SceneBuffers, Surfaces,
    frame::{attachment, clear_color, depth_attachment, depth_state},
};
use peelnet_gpu::{
    Gpu,
    bind::{Bind, Bound},
    record::Recorder,
    wgpu,
};

/// Bytes of the targets, a pixel: two keys in turn, the layer, the depth test.
pub const BYTES_PER_PIXEL: f64 = 2.0 * 8.0 + 16.0 + 4.0;

/// The targets and pipelines of front-to-back peeling.
#[derive(Debug)]
pub struct SinglePeel {
    /// Key of the last peeled fragment (bits of linear depth, triangle + 1), written in turn.
    pub keys: [wgpu::TextureView; 2],
    /// The layer peeled in the last pass.
    pub layer: wgpu::TextureView,
    depth: wgpu::TextureView,
    peel: GeometryPipelines,
    groups: [Bound; 2],
}

impl SinglePeel {
    /// Builds the passes.
    ///
    /// # Errors
    /// A frame beyond the adapter's limits, or a shader that does not link.
    pub fn new(
        gpu: &Gpu,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        features: &[&str],
    ) -> Result<Self, RasterError> {
        let texture = |label: &str, format| {
            gpu.texture(label, format, frame.size, 1, wgpu::TextureUsages::empty())
        };
        let (key_format, layer_format) = (
            wgpu::TextureFormat::Rg32Uint,
            wgpu::TextureFormat::Rgba32Float,
        );
        let keys = [
            texture("last key", key_format)?,
            texture("last key", key_format)?,
        ];
        let groups = [0, 1].map(|i| {
            gpu.bind(
                "last key",
                wgpu::ShaderStages::FRAGMENT,
                &[Bind::Uint(&keys[i])],
            )
        });
        let peel = scene.pipelines(
            gpu,
            frame,
            Surfaces::Transparent,
            &GeometryPass {
                label: "peel",
                shader: "peel::single",
                features,
                group: Some(&groups[0]),
                targets: &[Some(layer_format.into()), Some(key_format.into())],
                depth: Some(depth_state(
                    wgpu::TextureFormat::Depth32Float,
                    true,
                    wgpu::CompareFunction::Less,
                )),
                ..GeometryPass::NONE
            },
        )?;
        Ok(Self {
            keys,
            layer: texture("layer", layer_format)?,
            depth: texture("peel depth", wgpu::TextureFormat::Depth32Float)?,
            peel,
            groups,
        })
    }

    /// Puts the key before the first fragment into `keys[0]`.
    pub fn init(&self, recorder: &mut Recorder<'_>) {
        let start = attachment(&self.keys[0], wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT));
        drop(recorder.render("peel init", &[start], None));
    }

    /// Peeling pass `index` (from 0): reads `keys[index % 2]`, writes the other one and the layer.
    pub fn peel(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        index: u32,
    ) {
        let from = (index % 2) as usize;
        // All ones: nothing peeled, and nothing can lie behind.
        let end = f64::from(u32::MAX);
        let targets = [
            clear_color(&self.layer, [0.0; 4]),
            clear_color(&self.keys[1 - from], [end; 4]),
        ];
        let clear = wgpu::LoadOp::Clear(1.0);
        let depth = depth_attachment(&self.depth, clear, wgpu::StoreOp::Discard);
        let mut pass = recorder.render("peel", &targets, Some(depth));
        pass.set_bind_group(1, &self.groups[from].group, &[]);
        scene.draw(&mut pass, frame, Surfaces::Transparent, &self.peel);
    }
}
