//! The view of layers: one layer of a nested object highlighted, the others around it as a veil. It composites by itself, from the
//! sorted fragments of the S-buffer, and is no method of transparency.

use super::{
    abuffer::{self, Composite},
    compositor::Compositor,
};
use crate::error::RenderError;
use peelnet_gpu::Gpu;
use peelnet_raster::{FrameTargets, SceneBuffers};

/// The share of a pixel that the highlighted fragment takes where others lie in front of it.
pub const HIGHLIGHT_SHARE: f32 = 0.5;

/// What is seen of the layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerView {
    /// The layer that is highlighted; 0 is the outermost.
    pub highlight: u32,
    /// Whether fragments count only where the number of their layer increases: then an object's own far side is not seen.
    pub increasing: bool,
}

pub(crate) fn build(
    gpu: &Gpu,
    scene: &SceneBuffers,
    frame: &FrameTargets,
    view: LayerView,
) -> Result<Box<dyn Compositor>, RenderError> {
    let parameters = format!(
        "const HIGHLIGHT: f32 = {:?};\nconst HIGHLIGHT_SHARE: f32 = {HIGHLIGHT_SHARE:?};\n",
        view.highlight as f32
    );
    let features: &'static [&'static str] = if view.increasing {
        &["increasing"]
    } else {
        &[]
    };
    let composite = Composite {
        shader: "methods::layers::composite",
        features,
        parameters,
    };
    abuffer::build_with(gpu, scene, frame, None, &["layered"], composite)
}
