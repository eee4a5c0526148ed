//! What a method is made ready with, what it draws onto, and what becomes of the frame.

use crate::gpu::wgpu;
use crate::passes::views::Shows;
use peelnet_model::Recipe;
#[cfg(doc)]
use peelnet_scene::Camera;

/// The exported text that a learned method draws with.
#[derive(Clone, Debug)]
pub struct LearnedWeight {
    /// The recipe that the network was trained by.
    pub recipe: Recipe,
    /// The exported WGSL.
    pub wgsl: String,
}

/// What a method is made ready with.
#[derive(Clone, Debug)]
pub struct MethodOptions {
    /// Size of [`crate::Renderer::image`]s, width and height in pixels. [`crate::Renderer::draw`] takes that of its target.
    pub size: [u32; 2],
    /// The network of a learned method; by default the one that ships for it.
    pub learned: Option<LearnedWeight>,
    /// Samples a pixel of [`crate::Renderer::image`]s and [`crate::Renderer::profile`]s: 1, or 4 where WebGPU's multisampling has them. The
    /// method composites every sample by itself, and the pixel is their mean in linear light.
    pub samples: u32,
    /// What images hold.
    pub shows: Shows,
}

impl Default for MethodOptions {
    fn default() -> Self {
        Self::sized([1024, 768])
    }
}

impl MethodOptions {
    /// For images of this size.
    pub const fn sized(size: [u32; 2]) -> Self {
        Self {
            size,
            learned: None,
            samples: 1,
            shows: Shows::Colors,
        }
    }

    /// With so many samples a pixel, 1 or 4.
    #[must_use]
    pub const fn sampled(mut self, samples: u32) -> Self {
        self.samples = samples;
        self
    }

    /// With a network.
    #[must_use]
    pub fn with(mut self, learned: Option<&LearnedWeight>) -> Self {
        self.learned = learned.cloned();
        self
    }
}

/// A texture of the caller's to draw onto.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// The colour target, of any format that can be blended, with 1 or 4 samples a pixel. Values written are linear; an sRGB format encodes
    /// them.
    pub color: &'a wgpu::TextureView,
    /// Depth of opaque surfaces that the caller drew with [`Camera::clip_from_view`] (0 near, 1 far), in a format of depth alone, of the
    /// colour's size, to be bound and attached. The scene's own opaque surfaces are drawn into it.
    pub depth: Option<&'a wgpu::TextureView>,
    /// Whether the scene's background replaces what the target holds.
    pub clear: bool,
}

impl<'a> Target<'a> {
    /// Over what the target holds, without a depth buffer of the caller's.
    pub const fn over(color: &'a wgpu::TextureView) -> Self {
        Self {
            color,
            depth: None,
            clear: false,
        }
    }

    /// Over the scene's background.
    pub const fn cleared(color: &'a wgpu::TextureView) -> Self {
        Self {
            color,
            depth: None,
            clear: true,
        }
    }
}

/// Whether frames have room for all of their fragments, as far as counts have come back from the GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameStatus {
    /// The last frame that is known of was whole, or the method needs no counts.
    Whole,
    /// Nothing is known yet: room for a first guess.
    Unknown,
    /// The last frame that is known of was too small and lacks fragments; this one has the room that it needed.
    Grown,
}
