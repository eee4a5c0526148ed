//! How many passes peeling takes: as many as an earlier frame needed. What a pass found is logged on the GPU and read back with the frame.

use super::compositor::{DrawContext, Fit, FrameStats};
use crate::error::RenderError;
use peelnet_gpu::{Gpu, wgpu};
use peelnet_raster::count::CountPass;
use std::ops::Range;

/// Passes of the first frame, where nothing is known yet.
const FIRST_GUESS: u32 = 8;

/// Counts the passes of peeling methods.
#[derive(Debug)]
pub(super) struct Passes {
    /// Word 0: whether the last pass found anything that another must peel. Word 1: fragments peeled in the frame.
    pub found: wgpu::Buffer,
    /// Word 0 of `found` after each pass.
    log: wgpu::Buffer,
    /// Layers that a pass peels.
    layers: u32,
    count: Option<CountPass>,
    /// Passes that a frame takes, once one is known.
    known: Option<u32>,
    most: u32,
    /// Passes of the frame just recorded.
    recorded: u32,
    counted: bool,
    version: u64,
}

impl Passes {
    /// Of a method that peels `layers` a pass, and takes `most` passes at most.
    pub fn new(gpu: &Gpu, layers: u32, most: Option<u64>) -> Result<Self, RenderError> {
        Ok(Self {
            found: gpu.storage("found", 8)?,
            log: gpu.storage("found by pass", 4 * u64::from(FIRST_GUESS))?,
            layers,
            count: None,
            known: None,
            most: most.map_or(u32::MAX, |most| u32::try_from(most).unwrap_or(u32::MAX)),
            recorded: 0,
            counted: false,
            version: 0,
        })
    }

    /// Begins a frame; returns how many passes it takes.
    pub fn begin(&mut self, cx: &mut DrawContext<'_, '_>) -> Result<u32, RenderError> {
        let gpu = cx.recorder.gpu();
        self.counted = cx.counting || cx.only_count;
        if self.counted {
            let count = match &self.count {
                Some(count) => count,
                None => {
                    let made = CountPass::new(gpu, cx.scene, cx.frame, &[])?;
                    self.count.insert(made)
                }
            };
            count.encode(cx.recorder, cx.scene, cx.frame);
        }
        cx.recorder.encoder().clear_buffer(&self.found, 0, None);
        self.recorded = if cx.only_count {
            0
        } else {
            self.known.unwrap_or(FIRST_GUESS).min(self.most)
        };
        let bytes = 4 * u64::from(self.recorded.max(1));
        if self.log.size() < bytes {
            self.log = gpu.storage("found by pass", bytes)?;
        }
        Ok(self.recorded)
    }

    /// Before each pass.
    pub fn before(&self, cx: &mut DrawContext<'_, '_>) {
        cx.recorder.encoder().clear_buffer(&self.found, 0, Some(4));
    }

    /// After pass `number`.
    pub fn after(&self, cx: &mut DrawContext<'_, '_>, number: u32) {
        let at = 4 * u64::from(number);
        cx.recorder
            .encoder()
            .copy_buffer_to_buffer(&self.found, 0, &self.log, at, 4);
    }

    pub const fn is_known(&self) -> bool {
        self.known.is_some()
    }

    pub const fn version(&self) -> u64 {
        self.version
    }

    pub fn feedback(&self) -> Vec<(wgpu::Buffer, Range<u64>)> {
        let log = 0..4 * u64::from(self.recorded.max(1));
        let mut all = vec![(self.found.clone(), 0..8), (self.log.clone(), log)];
        if let Some(count) = self.count.as_ref().filter(|_| self.counted) {
            all.push((count.total.clone(), CountPass::TOTAL));
        }
        all
    }

    /// Learns how many passes the frame needed: those that left something to peel, and the one that found this out.
    pub fn learn(
        &mut self,
        words: &[Vec<u32>],
        stats: &mut FrameStats,
    ) -> Result<Fit, RenderError> {
        let log = &words[1][..self.recorded as usize];
        let useful = log.iter().take_while(|&&found| found != 0).count() as u32;
        let is_whole = useful < self.recorded || self.recorded == self.most;
        if let Some(total) = words.get(2) {
            let found = CountPass::found(total)?;
            stats.fragments = Some(found.total);
            stats.max_layers = Some(found.most);
            stats.lost = found.total.saturating_sub(words[0][1].into());
            if !is_whole {
                // One layer a pass: another pass finds out that none is left. Two: the last pass knows.
                let empty = u32::from(self.layers == 1);
                self.room((found.most.div_ceil(self.layers) + empty).max(1));
                return Ok(Fit::TooSmall);
            }
        }
        if !is_whole {
            self.room(self.recorded.saturating_mul(2).max(FIRST_GUESS));
            return Ok(Fit::TooSmall);
        }
        let needed = (useful + 1).min(self.most);
        let spare = self.recorded - needed;
        // Statistics report what a frame of this view takes.
        stats.geometry_passes = stats.geometry_passes.saturating_sub(spare);
        stats.fullscreen_passes = stats.fullscreen_passes.saturating_sub(spare);
        self.room(needed);
        Ok(if spare > 0 { Fit::Loose } else { Fit::Whole })
    }

    fn room(&mut self, passes: u32) {
        if self.known != Some(passes) {
            self.known = Some(passes);
            self.version += 1;
        }
    }
}
