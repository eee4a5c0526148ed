//! Depth peeling front to back (Everitt, NVIDIA 2001): the geometry passes. Portable WebGPU throughout, and lossless
//! on coplanar fragments, see `peel/single.wgsl`.

use crate::geometry::{
    FrameTargets, GeometryPass, GeometryPipelines, Needs, RenderError, SceneBuffers,
    frame::{attachment, clear_color, depth_attachment, depth_state},
};
use crate::gpu::{bind::Bind, record::Recorder, wgpu};

/// Bytes of the targets, a pixel: two keys in turn, the layer, the depth test.
pub const BYTES_PER_PIXEL: f64 = 2.0 * 8.0 + 16.0 + 4.0;

#[derive(Debug)]
pub struct SinglePeel {
    /// Key of the last peeled fragment (bits of linear depth, triangle + 1), written in turn.
    pub keys: [wgpu::TextureView; 2],
    pub layer: wgpu::TextureView,
    depth: wgpu::TextureView,
    peel: [GeometryPipelines; 2],
}

impl SinglePeel {
    pub fn new(
        scene: &SceneBuffers,
        frame: &FrameTargets,
        features: &[&str],
    ) -> Result<Self, RenderError> {
        use wgpu::TextureFormat::{Depth32Float, Rg32Uint, Rgba32Float};
        let gpu = &scene.gpu;
        let none = wgpu::TextureUsages::empty();
        let texture = |label: &str, format| gpu.texture(label, format, frame.size, 1, none);
        let keys = [
            texture("last key", Rg32Uint)?,
            texture("last key", Rg32Uint)?,
        ];
        let peel = |key: &wgpu::TextureView| {
            let pass = GeometryPass {
                label: "peel",
                shader: "peel::single",
                needs: Needs::COLOR | Needs::TRIANGLE,
                features,
                entries: &[("last", Bind::Texture(key))],
                targets: &[Some(Rgba32Float.into()), Some(Rg32Uint.into())],
                depth: Some(depth_state(Depth32Float)),
                ..GeometryPass::NONE
            };
            scene.pipelines(frame, &pass)
        };
        Ok(Self {
            peel: [peel(&keys[0])?, peel(&keys[1])?],
            keys,
            layer: texture("layer", Rgba32Float)?,
            depth: texture("peel depth", Depth32Float)?,
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
        scene.draw(&mut pass, frame, &self.peel[from]);
    }
}
