//! Dual depth peeling (Bavoil & Myers, NVIDIA 2008): the geometry passes.
//!
//! One RG32F target holds `(−nearest, farthest)` under MAX blending; each pass peels both ends of what is left. Coplanar fragments match
//! the same end. The original keeps the component-wise maximum of their colours. Here a layer composites them one under the other in the
//! order of drawing, which is that of the triangles' numbers: it is the exact composite of all of them, and none is lost.
//!
//! A dataset needs fragments one by one, not composited. Its layers keep the maximum, and callers count what is found less than there is.

use crate::geometry::{
    Blend, FrameTargets, GeometryPass, GeometryPipelines, Needs, RenderError, SceneBuffers,
    frame::clear_color,
};
use crate::gpu::{Gpu, bind::Bind, record::Recorder, wgpu};

/// Below every depth, see `peel/dual.wgsl`.
const NOTHING: f64 = -3.0e38;

/// Bytes of the targets, a pixel: two ranges in turn, front and back layer.
pub const BYTES_PER_PIXEL: f64 = 2.0 * 8.0 + 2.0 * 16.0;

#[derive(Debug)]
pub struct DualPeel {
    /// `(−nearest, farthest)` of what is left, written in turn.
    pub ranges: [wgpu::TextureView; 2],
    /// The layer peeled from the front in the last pass: premultiplied colour and transmittance. In a dataset's passes radiance and alpha.
    pub front: wgpu::TextureView,
    pub back: wgpu::TextureView,
    init: GeometryPipelines,
    /// The peeling passes, which read the two ranges in turn.
    peel: [GeometryPipelines; 2],
    /// The same passes, which also count the fragments they peel.
    counting: Option<[GeometryPipelines; 2]>,
    /// What layers are cleared to.
    start: [f64; 4],
}

impl DualPeel {
    /// Builds the passes. `found` is where counting passes add the number of fragments that they peel, in its second word.
    ///
    /// # Errors
    /// Adapters without 32-bit blending or with fewer than 40 bytes of colour a sample are refused, with the way out.
    pub fn new(
        scene: &SceneBuffers,
        frame: &FrameTargets,
        features: &[&str],
        found: Option<&wgpu::Buffer>,
    ) -> Result<Self, RenderError> {
        use wgpu::TextureFormat::{Rg32Float, Rgba32Float};
        let gpu = &scene.gpu;
        check_adapter(gpu)?;
        let none = wgpu::TextureUsages::empty();
        let texture = |label: &str, format| gpu.texture(label, format, frame.size, 1, none);
        let range = || texture("depth range", Rg32Float);
        let ranges = [range()?, range()?];
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
        let peel = |range: &wgpu::TextureView, found: Option<&wgpu::Buffer>| {
            let entries: Vec<_> = [("range", Bind::Texture(range))]
                .into_iter()
                .chain(found.map(|found| ("found", Bind::Write(found))))
                .collect();
            let mut features = features.to_vec();
            features.extend(found.map(|_| "counted"));
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
        };
        let peels =
            |found| Ok::<_, RenderError>([peel(&ranges[0], found)?, peel(&ranges[1], found)?]);
        Ok(Self {
            init: scene.pipelines(frame, &init)?,
            peel: peels(None)?,
            counting: found.map(|found| peels(Some(found))).transpose()?,
            start,
            front: texture("front layer", Rgba32Float)?,
            back: texture("back layer", Rgba32Float)?,
            ranges,
        })
    }

    /// The first pass: initialises `ranges[0]`.
    pub fn init(&self, recorder: &mut Recorder<'_>, scene: &SceneBuffers, frame: &FrameTargets) {
        let range = clear_color(&self.ranges[0], [NOTHING; 4]);
        let mut pass = recorder.render("dual init", &[range], None);
        scene.draw(&mut pass, frame, &self.init);
    }

    /// Peeling pass `index` (from 0): reads `ranges[index % 2]`, writes the other one and both layers, and with `counts` counts what it
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
        let targets = [
            clear_color(&self.ranges[1 - from], [NOTHING; 4]),
            clear_color(&self.front, self.start),
            clear_color(&self.back, self.start),
        ];
        let peel = self.counting.as_ref().filter(|_| counts);
        let peel = peel.unwrap_or(&self.peel);
        let mut pass = recorder.render("dual peel", &targets, None);
        scene.draw(&mut pass, frame, &peel[from]);
    }
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
