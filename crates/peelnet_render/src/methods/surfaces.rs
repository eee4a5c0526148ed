//! Which transparent surfaces each pixel shows, as numbers in place of colours. It reads the sorted fragments of the S-buffer, and is no
//! method of transparency.
//!
//! A *surface* is one side, front or back, of a part of an object with one material. Red and green of a pixel are two hashes of the list of
//! its surfaces, nearest first; alpha is the number of its fragments. Opacity is not read: a fragment that lets all light through counts, the
//! hole of a cut-out and what an opaque object hides do not.
//!
//! Two pixels with the same surfaces in the same order have the same numbers. Two with others have the same with a probability of
//! 2⁻⁴⁴: each hash is 22 bits. So the sum of four samples is a whole number below 2²⁴, which 32-bit floats hold, and their mean is exact.

use super::{
    abuffer::{self, Composite},
    prelude::*,
};
use peelnet_gpu::Gpu;
use peelnet_raster::{FrameTargets, SceneBuffers};

pub(crate) fn build(
    gpu: &Gpu,
    scene: &SceneBuffers,
    frame: &FrameTargets,
) -> Result<Box<dyn Compositor>, RenderError> {
    let composite = Composite {
        shader: "methods::surfaces::composite",
        fold: "surfaces",
        features: &[],
        parameters: String::new(),
    };
    abuffer::build_with(gpu, scene, frame, None, &["named"], composite)
}
