//! Methods that peel until a pass finds nothing: as many passes as an earlier frame needed. What a pass found is logged on the GPU and
//! read back with the frame.

use super::compositor::{Build, Compositor, DrawContext, Fit, FrameStats};
use crate::RenderError;
use crate::geometry::{count::CountPass, fullscreen::FullscreenPass};
use crate::gpu::wgpu;
use crate::methods::parameter::Parameter;
use std::fmt;

/// A cap on the number of passes.
pub(crate) const PASSES: Parameter = Parameter::whole(
    "passes",
    "a cap on the number of peeling passes",
    None,
    (1, 1 << 20),
);

/// Passes of the first frame, where nothing is known yet.
const FIRST_GUESS: u32 = 8;

/// What the passes of a peeling method do.
pub(crate) trait Peel: fmt::Debug + wgpu::WasmNotSend {
    /// Layers that a pass peels.
    const LAYERS: u32;

    fn begin(&self, cx: &mut DrawContext<'_, '_>);

    /// Records a pass, and what it composites.
    fn pass(&self, cx: &mut DrawContext<'_, '_>, number: u32);

    /// The pass that writes finished pixels after so many passes.
    fn resolve(&self, passes: u32) -> &FullscreenPass;

    /// Passes over the geometry and over the pixels beside those of so many passes, and bytes a pixel.
    fn besides(&self) -> (u32, u32, f64);
}

#[derive(Debug)]
pub(crate) struct Peeling<P> {
    peel: P,
    /// Word 0: whether the last pass found anything that another must peel. Word 1: fragments peeled in the frame.
    found: wgpu::Buffer,
    /// Word 0 of `found` after each pass.
    log: wgpu::Buffer,
    count: Option<CountPass>,
    /// Passes that a frame takes, once one is known.
    known: Option<u32>,
    most: u32,
    /// Passes of the frame just recorded.
    recorded: u32,
    counted: bool,
}

pub(crate) fn found_buffer(b: &Build<'_>) -> Result<wgpu::Buffer, RenderError> {
    Ok(b.scene.gpu.storage("found", 8)?)
}

impl<P: Peel + 'static> Peeling<P> {
    /// Of passes that write to `found`.
    pub fn boxed(
        b: &Build<'_>,
        found: wgpu::Buffer,
        peel: P,
    ) -> Result<Box<dyn Compositor>, RenderError> {
        Ok(Box::new(Self {
            peel,
            found,
            log: (b.scene.gpu).storage("found by pass", 4 * u64::from(FIRST_GUESS))?,
            count: None,
            known: None,
            most: PASSES.count(b.spec).map_or(u32::MAX, |n| n as u32),
            recorded: 0,
            counted: false,
        }))
    }
}

impl<P: Peel + 'static> Compositor for Peeling<P> {
    fn draw(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<FrameStats, RenderError> {
        let gpu = &cx.scene.gpu;
        self.counted = cx.counting || cx.only_count;
        if self.counted && self.count.is_none() {
            self.count = Some(CountPass::new(cx.scene, cx.frame, &[])?);
        }
        if let Some(count) = self.count.as_ref().filter(|_| self.counted) {
            count.encode(cx.recorder, cx.scene, cx.frame);
        }
        cx.recorder.encoder().clear_buffer(&self.found, 0, None);
        self.recorded = 0;
        if cx.only_count {
            return Ok(FrameStats::default());
        }
        let passes = self.known.unwrap_or(FIRST_GUESS).min(self.most);
        self.recorded = passes;
        let bytes = 4 * u64::from(passes);
        if self.log.size() < bytes {
            self.log = gpu.storage("found by pass", bytes)?;
        }
        self.peel.begin(cx);
        for number in 0..passes {
            let (found, at) = (&self.found, 4 * u64::from(number));
            cx.recorder.encoder().clear_buffer(found, 0, Some(4));
            self.peel.pass(cx, number);
            cx.recorder
                .encoder()
                .copy_buffer_to_buffer(found, 0, &self.log, at, 4);
        }
        cx.resolve(self.peel.resolve(passes));
        let (geometry, fullscreen, bytes_per_pixel) = self.peel.besides();
        Ok(FrameStats {
            tiles: 1,
            geometry_passes: passes + geometry,
            fullscreen_passes: passes + fullscreen,
            bytes_per_pixel,
            ..Default::default()
        })
    }

    fn is_ready(&self) -> bool {
        self.known.is_some()
    }

    fn feedback(&self) -> Vec<wgpu::Buffer> {
        let count = self.count.as_ref().filter(|_| self.counted);
        let found = [self.found.clone(), self.log.clone()].into_iter();
        found
            .chain(count.map(|count| count.total.clone()))
            .collect()
    }

    /// Learns how many passes the frame needed: those that left something to peel, and the one that found this out.
    fn learn(
        &mut self,
        _: &Build<'_>,
        _: bool,
        words: &[Vec<u32>],
        stats: &mut FrameStats,
    ) -> Result<Fit, RenderError> {
        let log = &words[1][..self.recorded as usize];
        let useful = log.iter().take_while(|&&found| found != 0).count() as u32;
        let is_whole = useful < self.recorded || self.recorded == self.most;
        if let Some(total) = words.get(2) {
            let found = CountPass::parse(total)?;
            stats.fragments = Some(found.total);
            stats.max_layers = Some(found.most);
            stats.lost = found.total.saturating_sub(words[0][1].into());
            if !is_whole {
                // One layer a pass: another pass finds out that none is left. Two: the last pass knows.
                let empty = u32::from(P::LAYERS == 1);
                self.known = Some((found.most.div_ceil(P::LAYERS) + empty).max(1));
                return Ok(Fit::TooSmall);
            }
        }
        if !is_whole {
            self.known = Some(self.recorded.saturating_mul(2).max(FIRST_GUESS));
            return Ok(Fit::TooSmall);
        }
        let needed = (useful + 1).min(self.most);
        let spare = self.recorded - needed;
        // Statistics report what a frame of this view takes.
        stats.geometry_passes = stats.geometry_passes.saturating_sub(spare);
        stats.fullscreen_passes = stats.fullscreen_passes.saturating_sub(spare);
        self.known = Some(needed);
        Ok(if spare > 0 { Fit::Loose } else { Fit::Whole })
    }
}
