//! Every method: one home each, a module that declares a [`Method`] and draws it behind [`Compositor`].
//!
//! [`METHODS`] lists the declarations; names, help texts, benchmarks, hard cases and tests are made from them. [`MethodSpec`] is a
//! method's name with its parameters, parsed. CONTRIBUTING.md adds a method step by step.

pub mod abuffer;
mod anchored;
mod blended;
mod commutative;
mod deep_thesis;
pub mod depth_peel;
mod dfaoit;
pub mod dual_peel;
mod kbuffer;
pub mod layers;
mod linked_list;
mod low_resolution;
mod mboit;
mod method;
mod nmt;
mod painter;
mod parameter;
mod peeling;
mod present;
mod spec;
mod stochastic;
mod wavelet;
mod wboit;
mod weighted;
mod weighted_average;
mod weighted_sum;

pub use method::{Estimate, Method, Numbered, Pixel, Promises, Role, Twin};
pub use parameter::{Count, Number, Parameter, Precision, SCALE, Targets, Whole, Word};
pub use spec::MethodSpec;

use crate::{LearnedWeight, RenderError};
use parameter::{MOMENT_TARGETS, TARGETS};
use peelnet_core::{absorbance::DepthWarp, statistics::SumPrecision};
use peelnet_gpu::{Gpu, record::Recorder, wgpu};
use peelnet_model::Model;
use peelnet_raster::{FrameTargets, SceneBuffers};
use peelnet_scene::Camera;
use std::{fmt, ops::Range};

/// What a method reports of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Transparent fragments of the frame, where the method counts them.
    pub fragments: Option<u64>,
    /// Fragments of the fullest pixel, where the method counts them.
    pub max_layers: Option<u32>,
    /// Fragments that the method did not composite: coplanar ones in dual peeling, those beyond a cap on passes.
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

/// What a compositor draws with.
#[derive(Debug)]
pub struct DrawContext<'a, 'e> {
    /// Records passes.
    pub recorder: &'a mut Recorder<'e>,
    /// The scene.
    pub scene: &'a SceneBuffers,
    /// The view.
    pub camera: &'a Camera,
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
}

/// Whether a frame had room for all of its fragments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// It had, and took what it needed.
    Whole,
    /// It had, and did more than it needed: its time is not the method's.
    Loose,
    /// It lacks fragments.
    TooSmall,
}

/// What a compositor learns the counts of a frame with.
#[derive(Debug)]
pub struct Learning<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The scene.
    pub scene: &'a SceneBuffers,
    /// The frame's targets.
    pub frame: &'a FrameTargets,
    /// Whether the same view is drawn again, so that room needs no reserve for movement.
    pub exact: bool,
}

impl Learning<'_> {
    /// Room for what was needed, with a quarter more where views move.
    pub const fn room(&self, needed: u64) -> u64 {
        if self.exact {
            needed
        } else {
            needed + needed / 4
        }
    }
}

/// A method made ready for one scene and frame size.
pub trait Compositor: fmt::Debug + wgpu::WasmNotSend {
    /// Records the passes that composite the transparent fragments: over `C_0` into the frame's image, or onto the caller's target.
    ///
    /// # Errors
    /// A lost device, or a frame beyond the adapter's limits.
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError>;

    /// Whether it knows how much room a frame needs, or need not know.
    fn is_ready(&self) -> bool {
        true
    }

    /// What to read back of the frame just recorded; empty for methods that need no counts.
    fn feedback(&self) -> Vec<(wgpu::Buffer, Range<u64>)> {
        Vec::new()
    }

    /// Takes what was read back, word by word, completes the statistics, and makes room for the next frame.
    ///
    /// # Errors
    /// A pixel or frame beyond what storage can hold, or a lost device.
    fn learn(
        &mut self,
        _cx: &Learning<'_>,
        _words: &[Vec<u32>],
        _stats: &mut FrameStats,
    ) -> Result<Fit, RenderError> {
        Ok(Fit::Whole)
    }

    /// Counts how often the room changed: counts of frames before say nothing of what there is now.
    fn version(&self) -> u64 {
        0
    }
}

/// What a method is built from.
pub(crate) struct Build<'a> {
    pub gpu: &'a Gpu,
    pub scene: &'a SceneBuffers,
    pub frame: &'a FrameTargets,
    pub spec: &'a MethodSpec,
    pub learned: Option<&'a LearnedWeight>,
}

impl Build<'_> {
    /// The text that a learned method draws with.
    ///
    /// # Errors
    /// No model, or one that was trained for another method.
    pub(crate) fn learned_weight(&self) -> Result<&LearnedWeight, RenderError> {
        let learned = self
            .learned
            .ok_or_else(|| RenderError::NeedsModel(self.spec.to_string()))?;
        let method = learned.recipe.method;
        if method != self.spec.name() {
            return Err(RenderError::Parameter {
                method: self.spec.to_string(),
                message: format!(
                    "the model given was trained for method {method}; use that method, or another model"
                ),
            });
        }
        Ok(learned)
    }
}

/// Every method, in the order of lists and reports.
pub const METHODS: &[Method] = &[
    abuffer::METHOD,
    linked_list::METHOD,
    depth_peel::METHOD,
    dual_peel::METHOD,
    painter::OBJECTS,
    painter::TRIANGLES,
    weighted_sum::METHOD,
    weighted_average::METHOD,
    blended::METHOD,
    wboit::EQ7,
    wboit::EQ8,
    wboit::EQ9,
    wboit::EQ10,
    wboit::PAPAKOSTAS,
    wboit::INVERSE_POWER,
    mboit::FOUR,
    mboit::SIX,
    wavelet::METHOD,
    kbuffer::PLAIN,
    kbuffer::HYBRID,
    stochastic::METHOD,
    deep_thesis::METHOD,
    nmt::METHOD,
    dfaoit::METHOD,
    anchored::SMALL,
    anchored::MEDIUM,
    anchored::LARGE,
];

/// The transmittance that a learned method's network estimates.
fn learned_transmittances(
    spec: &MethodSpec,
    fragments: &[(f32, f32)],
    warp: &DepthWarp,
    model: Option<&Model>,
) -> Option<Vec<f64>> {
    let precision = match spec.promises().statistics {
        Precision::Half => SumPrecision::Half,
        Precision::Full => SumPrecision::Exact,
    };
    let all = model?.transmittances(fragments, warp, precision);
    (!all.is_empty() || fragments.is_empty()).then_some(all)
}

/// The methods that draw light which takes a colour where it passes, for messages.
pub(crate) fn tinted() -> String {
    let tinted = METHODS.iter().filter(|m| m.is_tinted());
    tinted.map(Method::usage).collect::<Vec<_>>().join(", ")
}

/// Makes a method ready.
pub(crate) fn build(b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
    let spec = b.spec;
    let promises = (spec.method().promises)(spec);
    // A scene's scale concerns estimates; the methods that judge them stay exact unless they are asked for a scale themselves.
    let default = if spec.method().is_exact() {
        1.0
    } else {
        b.scene.transparency_scale
    };
    let scale = SCALE.given(spec).map_or(default, |s| s as f32);
    if b.scene.tinted && (!promises.tinted || scale < 1.0) {
        return Err(RenderError::OneTransmittance(spec.to_string()));
    }
    if scale < 1.0 {
        low_resolution::build(b, scale)
    } else {
        (spec.method().build)(b)
    }
}
