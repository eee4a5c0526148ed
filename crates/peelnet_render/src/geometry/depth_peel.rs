//! Depth peeling: the geometry passes.
//!
//! *Front to back* (Everitt, NVIDIA 2001), one layer a pass: portable WebGPU throughout, and lossless on coplanar fragments, see
//! `peel/single.wgsl`.
//!
//! *Dual* (Bavoil & Myers, NVIDIA 2008), two layers a pass: one RG32F target holds `(−nearest, farthest)` under MAX blending; each pass peels
//! both ends of what is left. Coplanar fragments match the same end. The original keeps the component-wise maximum of their colours. Here a
//! layer composites them one under the other in the order of drawing, which is that of the triangles' numbers: it is the exact composite of
//! all of them, and none is lost. A dataset needs fragments one by one, not composited. Its layers keep the maximum, and callers count what
//! is found less than there is.

use crate::geometry::{
    Blend, FrameTargets, GeometryPass, GeometryPipelines, Needs, RenderError, SceneBuffers,
    frame::{clear_color, depth_attachment, depth_state},
};
use crate::gpu::{Gpu, bind::Bind, record::Recorder, wgpu};
use wgpu::TextureFormat::{Depth32Float, Rg32Float, Rg32Uint, Rgba32Float};

/// Bytes of the targets of front-to-back peeling, a pixel: two keys in turn, the layer, the depth test.
pub const SINGLE_BYTES: f64 = 2.0 * 8.0 + 16.0 + 4.0;

/// Bytes of the targets of dual peeling, a pixel: two ranges in turn, front and back layer.
pub const DUAL_BYTES: f64 = 2.0 * 8.0 + 2.0 * 16.0;

#[derive(Debug)]
pub struct DepthPeel {
    /// How far peeling is, written in turn: the key of the last peeled fragment (bits of linear depth, triangle + 1), or
    /// `(−nearest, farthest)` of what is left.
    pub reached: [wgpu::TextureView; 2],
    /// What the last pass peeled, radiance and alpha; of dual peeling from the front and from the back, premultiplied colour and
    /// transmittance but in a dataset's passes.
    pub layers: Vec<wgpu::TextureView>,
    depth: Option<wgpu::TextureView>,
    /// Of the first pass and the others.
    labels: [&'static str; 2],
    /// What the first pass, the others and layers are cleared to.
    clear: [[f64; 4]; 3],
    init: Option<GeometryPipelines>,
    /// The peeling passes, by what they go on from.
    peel: [GeometryPipelines; 2],
    /// The same passes, which also count the fragments they peel.
    counting: Option<[GeometryPipelines; 2]>,
}

impl DepthPeel {
    /// Builds the passes of front-to-back peeling.
    pub fn single(
        scene: &SceneBuffers,
        frame: &FrameTargets,
        features: &[&str],
    ) -> Result<Self, RenderError> {
        let reached = [0, 1].map(|_| texture(scene, frame, "last key", Rg32Uint));
        let reached = both(reached)?;
        let peel = reached.each_ref().map(|key| {
            let pass = GeometryPass {
                label: "peel",
                shader: "peel::single",
                needs: Needs::COLOR | Needs::TRIANGLE,
                features,
                entries: &[("last", Bind::Texture(key))],
                targets: &[Some(Rg32Uint.into()), Some(Rgba32Float.into())],
                depth: Some(depth_state(Depth32Float)),
                ..GeometryPass::NONE
            };
            scene.pipelines(frame, &pass)
        });
        Ok(Self {
            peel: both(peel)?,
            reached,
            layers: vec![texture(scene, frame, "layer", Rgba32Float)?],
            depth: Some(texture(scene, frame, "peel depth", Depth32Float)?),
            labels: ["peel init", "peel"],
            // Before the first fragment. All ones: nothing peeled, and nothing can lie behind.
            clear: [[0.0; 4], [u32::MAX.into(); 4], [0.0; 4]],
            init: None,
            counting: None,
        })
    }

    /// Builds the passes of dual peeling. `found` is where counting passes add the number of fragments that they peel, in its second word.
    ///
    /// # Errors
    /// Adapters without 32-bit blending or with fewer than 40 bytes of colour a sample are refused, with the way out.
    pub fn dual(
        scene: &SceneBuffers,
        frame: &FrameTargets,
        features: &[&str],
        found: Option<&wgpu::Buffer>,
    ) -> Result<Self, RenderError> {
        check_adapter(&scene.gpu)?;
        let reached = [0, 1].map(|_| texture(scene, frame, "depth range", Rg32Float));
        let reached = both(reached)?;
        let max = |format| Some(Blend::Max.state(format));
        let (layer, start) = if features.contains(&"dataset") {
            (max(Rgba32Float), [0.0; 4])
        } else {
            let under = Blend::Under;
            (Some(under.state(Rgba32Float)), under.start())
        };
        let init = GeometryPass {
            label: "dual init",
            shader: "peel::dual_init",
            needs: Needs::DEPTH,
            features,
            targets: &[max(Rg32Float)],
            ..GeometryPass::NONE
        };
        let peels = |found: Option<&wgpu::Buffer>| {
            let mut features = features.to_vec();
            features.extend(found.map(|_| "counted"));
            let peels = reached.each_ref().map(|range| {
                let mut entries = vec![("range", Bind::Texture(range))];
                entries.extend(found.map(|found| ("found", Bind::Write(found))));
                let pass = GeometryPass {
                    label: "dual peel",
                    shader: "peel::dual",
                    needs: Needs::COLOR,
                    features: &features,
                    entries: &entries,
                    targets: &[max(Rg32Float), layer.clone(), layer.clone()],
                    ..GeometryPass::NONE
                };
                scene.pipelines(frame, &pass)
            });
            both(peels)
        };
        // Below every depth, see `peel/dual.wgsl`.
        let nothing = [-3.0e38; 4];
        let layers = ["front layer", "back layer"].into_iter();
        let layers = layers.map(|label| texture(scene, frame, label, Rgba32Float));
        Ok(Self {
            init: Some(scene.pipelines(frame, &init)?),
            peel: peels(None)?,
            counting: found.map(|found| peels(Some(found))).transpose()?,
            labels: ["dual init", "dual peel"],
            clear: [nothing, nothing, start],
            layers: layers.collect::<Result<_, _>>()?,
            depth: None,
            reached,
        })
    }

    /// The first pass: initialises `reached[0]`.
    pub fn init(&self, recorder: &mut Recorder<'_>, scene: &SceneBuffers, frame: &FrameTargets) {
        let start = clear_color(&self.reached[0], self.clear[0]);
        let mut pass = recorder.render(self.labels[0], &[start], None);
        if let Some(init) = &self.init {
            scene.draw(&mut pass, frame, init);
        }
    }

    /// Peeling pass `index` (from 0): reads `reached[index % 2]`, writes the other one and the layers, and with `counts` counts what it
    /// peels where the passes were built to.
    pub fn peel(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        index: u32,
        counts: bool,
    ) {
        let from = (index % 2) as usize;
        let mut targets = vec![clear_color(&self.reached[1 - from], self.clear[1])];
        let layers = self.layers.iter();
        targets.extend(layers.map(|layer| clear_color(layer, self.clear[2])));
        let clear = wgpu::LoadOp::Clear(1.0);
        let depth = self.depth.as_ref();
        let depth = depth.map(|depth| depth_attachment(depth, clear, wgpu::StoreOp::Discard));
        let peel = self.counting.as_ref().filter(|_| counts);
        let peel = peel.unwrap_or(&self.peel);
        let mut pass = recorder.render(self.labels[1], &targets, depth);
        scene.draw(&mut pass, frame, &peel[from]);
    }
}

fn texture(
    scene: &SceneBuffers,
    frame: &FrameTargets,
    label: &str,
    format: wgpu::TextureFormat,
) -> Result<wgpu::TextureView, RenderError> {
    let none = wgpu::TextureUsages::empty();
    Ok((scene.gpu).texture(label, format, frame.size, 1, none)?)
}

fn both<T>([first, second]: [Result<T, RenderError>; 2]) -> Result<[T; 2], RenderError> {
    Ok([first?, second?])
}

/// Refuses adapters that cannot blend in 32 bits, or not into all targets at once.
fn check_adapter(gpu: &Gpu) -> Result<(), RenderError> {
    const HINT: &str = "use S-buffer or single peeling, or the methods abuffer or depth-peel";
    let feature = wgpu::Features::FLOAT32_BLENDABLE;
    gpu.need(feature, "dual depth peeling", HINT)?;
    let (needed, what) = (8 + 16 + 16, "dual depth peeling with its colour targets");
    let limit = gpu.limits.max_color_attachment_bytes_per_sample.into();
    gpu.check_limit(what, needed, limit, "bytes a sample", HINT)?;
    Ok(())
}
