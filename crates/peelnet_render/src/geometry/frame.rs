//! The targets of one frame size, and where the finished picture goes.

use crate::geometry::{GeometryPass, GeometryPipelines, RenderError, SceneBuffers};
use crate::gpu::{Gpu, bind::Bound, wgpu};

/// Where the finished picture goes, as pipelines need to know it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Into [`FrameTargets::image`], with the background in it: RGBA32F, linear colour and coverage.
    Image,
    Target {
        format: wgpu::TextureFormat,
        samples: u32,
        /// Whether transparency is blended over what the target holds. Otherwise the whole pixel is written, background included.
        over: bool,
    },
}

impl Output {
    pub const fn samples(self) -> u32 {
        match self {
            Self::Image => 1,
            Self::Target { samples, .. } => samples,
        }
    }

    /// Whether resolves blend over what the target holds.
    pub const fn is_over(self) -> bool {
        matches!(self, Self::Target { over: true, .. })
    }

    /// The colour target of a pass that writes finished pixels: premultiplied colour and coverage.
    pub fn state(self) -> wgpu::ColorTargetState {
        match self {
            Self::Image => IMAGE.into(),
            Self::Target { format, over, .. } => {
                let mut state = wgpu::ColorTargetState::from(format);
                if over {
                    state.blend = Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
                } else {
                    // The background is in the pixel: it is opaque, as its target was cleared.
                    state.write_mask = wgpu::ColorWrites::COLOR;
                }
                state
            }
        }
    }

    /// Format and samples a pixel of what opaque surfaces are drawn onto: a target that is blended over, and `C_0` otherwise.
    pub(crate) const fn opaque(self) -> (wgpu::TextureFormat, u32) {
        match self {
            Self::Target {
                format,
                samples,
                over: true,
            } => (format, samples),
            _ => (IMAGE, 1),
        }
    }
}

/// Format of `C_0` and of the finished image.
const IMAGE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

#[derive(Clone, Debug, PartialEq)]
pub struct OpaqueDepth {
    /// A view of depth alone, which passes bind and attach.
    pub view: wgpu::TextureView,
    /// Whether the caller drew it: it is loaded, not cleared.
    pub is_callers: bool,
}

impl OpaqueDepth {
    pub fn samples(&self) -> u32 {
        self.view.texture().sample_count()
    }

    /// The shader features of passes that compare with it.
    pub(crate) fn features(&self) -> &'static [&'static str] {
        &["opaque", "multisampled"][..1 + usize::from(self.samples() > 1)]
    }
}

/// The frame's own targets: `C_0`, the opaque depth and the finished image.
#[derive(Debug)]
pub struct FrameTargets {
    pub size: [u32; 2],
    /// Width over height of the view: that of `size`, unless it is set for pixels that are not square.
    pub aspect: f32,
    /// `C_0`, RGBA32F: the opaque image over the background; one black texel where the output blends over a target. Loads outside
    /// of a texture give zero or one of its texels (WGSL), so that shaders find black everywhere.
    pub background: wgpu::TextureView,
    pub depth: Option<OpaqueDepth>,
    pub output: Output,
    /// The finished image, RGBA32F, of [`Output::Image`].
    pub image: Option<wgpu::TextureView>,
    /// Those of the scene's opaque surfaces, where there are any.
    pub(crate) opaque: Option<GeometryPipelines>,
    pub(crate) scene_group: Bound,
    pub(crate) opaque_group: Bound,
}

impl FrameTargets {
    pub const fn pixels(&self) -> u32 {
        self.size[0] * self.size[1]
    }

    /// The attachment of a pass that writes finished pixels, to `target` where the output is one.
    pub fn attachment<'a>(
        &'a self,
        target: Option<&'a wgpu::TextureView>,
    ) -> Option<wgpu::RenderPassColorAttachment<'a>> {
        let load = match self.output {
            Output::Image => wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            Output::Target { over: true, .. } => wgpu::LoadOp::Load,
            Output::Target { over: false, .. } => wgpu::LoadOp::Clear(wgpu::Color::BLACK),
        };
        attachment(self.image.as_ref().or(target)?, load)
    }
}

impl SceneBuffers {
    /// Makes the targets of a frame: of the image alone, or of what is drawn onto a caller's target with the depth that the caller
    /// drew.
    pub fn targets(
        &self,
        size: [u32; 2],
        output: Output,
        depth: Option<&wgpu::TextureView>,
    ) -> Result<FrameTargets, RenderError> {
        let (gpu, [width, height]) = (&self.gpu, size);
        if width == 0 || height == 0 {
            return Err(RenderError::Refused(format!(
                "a frame of {width}×{height} pixels: both sides must be at least 1"
            )));
        }
        let none = wgpu::TextureUsages::empty();
        let is_callers = depth.is_some();
        let view = match depth {
            Some(view) => Some(view.clone()),
            None if self.has_opaque() => {
                let (format, samples) = (wgpu::TextureFormat::Depth32Float, output.opaque().1);
                Some(gpu.texture("opaque depth", format, size, samples, none)?)
            }
            None => None,
        };
        let depth = view.map(|view| OpaqueDepth { view, is_callers });
        let [opaque_group, scene_group] = self.groups(depth.as_ref());
        let background = if output.is_over() { [1, 1] } else { size };
        let mut frame = FrameTargets {
            size,
            aspect: width as f32 / height as f32,
            background: gpu.texture("background", IMAGE, background, 1, none)?,
            image: match output {
                Output::Image => Some(gpu.texture("image", IMAGE, size, 1, none)?),
                Output::Target { .. } => None,
            },
            output,
            depth,
            scene_group,
            opaque_group,
            opaque: None,
        };
        if let Some(depth) = frame.depth.as_ref().filter(|_| self.has_opaque()) {
            let (color, samples) = output.opaque();
            let pass = GeometryPass {
                label: "opaque",
                shader: "scene::opaque",
                opaque: true,
                targets: &[Some(color.into())],
                depth: Some(depth_state(depth.view.texture().format())),
                samples,
                ..GeometryPass::NONE
            };
            frame.opaque = Some(self.pipelines(&frame, &pass)?);
        }
        Ok(frame)
    }
}

/// A depth test that keeps the nearest.
pub(crate) fn depth_state(format: wgpu::TextureFormat) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Less),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

pub(crate) fn depth_attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<f32>,
    store: wgpu::StoreOp,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load, store }),
        stencil_ops: None,
    }
}

pub fn clear_color(
    view: &wgpu::TextureView,
    [r, g, b, a]: [f64; 4],
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    attachment(view, wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }))
}

pub fn attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load,
            store: wgpu::StoreOp::Store,
        },
    })
}

/// Format of the attachment of passes that write storage alone: WebGPU wants one.
pub(crate) const UNWRITTEN: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// That attachment's texture, a byte a pixel.
pub fn unwritten_texture(
    gpu: &Gpu,
    frame: &FrameTargets,
) -> Result<wgpu::TextureView, RenderError> {
    let none = wgpu::TextureUsages::empty();
    Ok(gpu.texture("no attachment", UNWRITTEN, frame.size, 1, none)?)
}

/// The attachment, cleared and not stored.
pub fn unwritten_attachment(
    view: &wgpu::TextureView,
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let mut cleared = attachment(view, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT))?;
    cleared.ops.store = wgpu::StoreOp::Discard;
    Some(cleared)
}
