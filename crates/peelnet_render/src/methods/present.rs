//! The last step of methods whose compute shaders write finished pixels: onto the caller's target, where the frame's output is one.

use super::compositor::{Build, DrawContext};
use crate::error::RenderError;
use peelnet_gpu::{Gpu, bind::Bind, wgpu};
use peelnet_raster::{FrameTargets, frame::Output, fullscreen::FullscreenPass};

/// The image that a compute shader writes, and the pass that puts it onto the target.
#[derive(Debug)]
pub(super) struct Present {
    /// Finished pixels, RGBA32F.
    pub image: wgpu::TextureView,
    pass: Option<FullscreenPass>,
}

impl Present {
    pub fn new(gpu: &Gpu, frame: &FrameTargets) -> Result<Self, RenderError> {
        let image = frame.storage_image(gpu)?;
        let pass = match frame.output {
            Output::Image => None,
            output @ Output::Target { .. } => Some(FullscreenPass::resolve(
                gpu,
                "helpers::present",
                &[],
                &[],
                &[Bind::Texture(&image)],
                output,
            )?),
        };
        Ok(Self { image, pass })
    }

    pub fn of(b: &Build<'_>) -> Result<Self, RenderError> {
        Self::new(b.gpu, b.frame)
    }

    /// Records the pass, where there is one.
    pub fn draw(&self, cx: &mut DrawContext<'_, '_>) {
        if let Some(pass) = &self.pass {
            let output = cx.output();
            pass.draw(cx.recorder, &[output]);
        }
    }
}
