//! The view of layers: one layer of a nested object highlighted, the others around it as a veil. It composites by itself, from the
//! sorted fragments of the S-buffer, and is no method of transparency.

use super::{
    abuffer::{self, Composite},
    prelude::*,
};
use peelnet_gpu::Gpu;
use peelnet_raster::{FrameTargets, SceneBuffers};

/// The share of a pixel that the highlighted fragment takes among others.
pub const HIGHLIGHT_SHARE: f32 = 0.5;

/// Which fragments of a pixel are seen besides the highlighted one, the nearest of its layer, and what each of them weighs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LayerFormula {
    /// Those in front of it share `1 − v` in equal parts, with v = [`HIGHLIGHT_SHARE`]; those behind it are hidden. Without any in front
    /// the highlighted one takes the whole pixel. Weights add up to 1.
    #[default]
    Front,
    /// All of them, as the formula of the ageing renderer (Adamopoulos 2018) is printed: the highlighted one weighs v, and each other one,
    /// in front of it or behind, `(1 − v) / n` with n the number of all fragments. Weights add up to `1 − (1 − v) / n`.
    Printed,
}

/// What is seen of the layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerView {
    /// The layer that is highlighted; 0 is the outermost.
    pub highlight: u32,
    /// Whether fragments count only where the number of their layer increases: then an object's own far side is not seen.
    pub increasing: bool,
    /// Which fragments are seen, and what they weigh.
    pub formula: LayerFormula,
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
    let features: &'static [&'static str] = match (view.increasing, view.formula) {
        (false, LayerFormula::Front) => &[],
        (true, LayerFormula::Front) => &["increasing"],
        (false, LayerFormula::Printed) => &["printed"],
        (true, LayerFormula::Printed) => &["increasing", "printed"],
    };
    let composite = Composite {
        shader: "methods::layers::composite",
        fold: "layers",
        features,
        parameters,
    };
    abuffer::build_with(gpu, scene, frame, None, &["layered"], composite)
}
