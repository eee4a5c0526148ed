use super::Conditions;
use crate::geometry::{FrameTargets, SamplePoint, SceneBuffers, fullscreen::FullscreenPass};
use crate::gpu::{Gpu, bind::Bind, record::Recorder, wgpu};
use crate::methods::MethodSpec;
use crate::{RenderError, target::MethodOptions};
use peelnet_scene::Camera;
use std::fmt;

/// What a method reports of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Transparent fragments of the frame, where the method counts them.
    pub fragments: Option<u64>,
    /// Fragments of the fullest pixel, where the method counts them.
    pub max_layers: Option<u32>,
    /// Fragments that the method did not composite: those beyond a cap on passes.
    pub lost: u64,
    /// Tiles that the frame was drawn in.
    pub tiles: u32,
    /// Passes over the transparent geometry.
    pub geometry_passes: u32,
    /// Passes over the pixels.
    pub fullscreen_passes: u32,
    /// Bytes that the method allocates a pixel, beyond colour target and `C_0`; storage per fragment included.
    pub bytes_per_pixel: f64,
}

#[derive(Debug)]
pub(crate) struct DrawContext<'a, 'e> {
    pub recorder: &'a mut Recorder<'e>,
    pub scene: &'a SceneBuffers,
    pub camera: &'a Camera,
    pub point: SamplePoint,
    /// `C_0` and where the finished picture goes.
    pub frame: &'a FrameTargets,
    /// The caller's target, where the frame's output is one.
    pub target: Option<&'a wgpu::TextureView>,
    /// Whether to count what statistics need and compositing does not.
    pub counting: bool,
    /// Whether only to count, for a method that does not know yet how much room it needs.
    pub only_count: bool,
}

impl<'a> DrawContext<'a, '_> {
    /// The attachment that the finished picture is written to.
    pub fn output(&self) -> Option<wgpu::RenderPassColorAttachment<'a>> {
        self.frame.attachment(self.target)
    }

    /// Records the pass that writes finished pixels: over a target only those that a transparent surface can touch.
    pub fn resolve(&mut self, pass: &FullscreenPass) {
        let output = [self.output()];
        let over = self.frame.output.is_over();
        let touched = || self.scene.touched(self.camera, self.frame, self.point);
        pass.draw(self.recorder, &output, over.then(touched));
    }
}

/// Whether a frame had room for all of its fragments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fit {
    /// It had, and took what it needed.
    Whole,
    /// It had, and did more than it needed: its time is not the method's.
    Loose,
    /// It lacks fragments.
    TooSmall,
}

/// A method made ready for one scene and frame size.
pub(crate) trait Compositor: fmt::Debug + wgpu::WasmNotSend {
    /// Records the passes that composite the transparent fragments: over `C_0` into the frame's image, or onto the caller's target.
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError>;

    /// Whether it knows how much room a frame needs, or need not know.
    fn is_ready(&self) -> bool {
        true
    }

    /// Whether a still image would not change any more, for a method that makes frames from those before.
    fn is_settled(&self) -> bool {
        true
    }

    /// What to read back of the frame just recorded; empty for methods that need no counts.
    fn feedback(&self) -> Vec<wgpu::Buffer> {
        Vec::new()
    }

    /// Takes what was read back, word by word, completes the statistics, and makes room for the next frame: without a reserve for movement
    /// where `exact`ly the same view is drawn again.
    fn learn(
        &mut self,
        _b: &Build<'_>,
        _exact: bool,
        _words: &[Vec<u32>],
        _stats: &mut FrameStats,
    ) -> Result<Fit, RenderError> {
        Ok(Fit::Whole)
    }
}

pub(crate) struct Build<'a> {
    pub scene: &'a SceneBuffers,
    pub frame: &'a FrameTargets,
    pub spec: &'a MethodSpec,
    pub options: &'a MethodOptions,
}

impl<'a> Build<'a> {
    /// What the method's passes depend on.
    pub fn conditions(&self) -> Conditions<'a> {
        Conditions {
            spec: self.spec,
            recipe: self.options.learned.as_ref().map(|learned| learned.recipe),
            size: self.frame.size,
            grey: self.scene.grey,
            tinted: self.scene.tinted,
            over: self.frame.output.is_over(),
        }
    }
}

/// The pass that writes finished pixels to where the frame's output goes.
pub(crate) fn resolve(
    gpu: &Gpu,
    frame: &FrameTargets,
    shader: &str,
    features: &[&str],
    extra: &[(&str, &str)],
    entries: &[(&str, Bind<'_>)],
) -> Result<FullscreenPass, RenderError> {
    let (targets, samples) = ([Some(frame.output.state())], frame.output.samples());
    FullscreenPass::new(gpu, shader, features, extra, entries, &targets, samples)
}
