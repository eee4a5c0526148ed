//! How many fragments each pixel has, and the prefix sum of that.

use crate::geometry::{
    FrameTargets, GeometryPass, GeometryPipelines, Needs, RenderError, SceneBuffers,
    frame::{unwritten_attachment, unwritten_texture},
};
use crate::gpu::{Kernel, bind::Bind, groups_2d, record::Recorder, wgpu};

/// Pixels of one block of the prefix sum; `BLOCK` in `peel/scan_blocks.wgsl`.
const BLOCK: u32 = 256;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FragmentCount {
    pub total: u64,
    /// Fragments in the fullest pixel.
    pub most: u32,
}

/// The count pass and the three kernels of the prefix sum.
#[derive(Debug)]
pub struct CountPass {
    /// Fragments per pixel, row-major; the S-buffer's second pass counts it down to zero.
    pub counts: wgpu::Buffer,
    /// First fragment of each pixel; one entry more than pixels, the last one the total.
    pub offsets: wgpu::Buffer,
    /// See [`Self::parse`].
    pub total: wgpu::Buffer,
    /// What is wrong with the frame's fragments, see [`Self::check`].
    pub faults: wgpu::Buffer,
    /// See [`unwritten_attachment`].
    pub(crate) attachment: wgpu::TextureView,
    pipelines: GeometryPipelines,
    /// With the threads of each.
    kernels: [(Kernel, u32); 3],
}

impl CountPass {
    /// Builds the pass for a frame. `features` may hold `sampled`.
    pub fn new(
        scene: &SceneBuffers,
        frame: &FrameTargets,
        features: &[&str],
    ) -> Result<Self, RenderError> {
        let gpu = &scene.gpu;
        let pixels = frame.pixels();
        let counts = gpu.storage("fragment counts", u64::from(pixels) * 4)?;
        let offsets = gpu.storage("fragment offsets", u64::from(pixels) * 4 + 4)?;
        let blocks_count = pixels.div_ceil(BLOCK);
        let blocks = gpu.storage("prefix-sum blocks", u64::from(blocks_count) * 8)?;
        let total = gpu.storage("fragment total", 12)?;
        let faults = gpu.storage("faults", 16)?;
        let attachment = unwritten_texture(gpu, frame)?;
        let pass = GeometryPass {
            label: "count",
            shader: "peel::count",
            needs: Needs::DEPTH,
            features,
            entries: &[("counts", Bind::Write(&counts))],
            ..GeometryPass::NONE
        };
        let pipelines = scene.pipelines(frame, &pass)?;
        let extent = [pixels, blocks_count, groups_2d(blocks_count)[0], 0];
        let extent = gpu.upload("extent", &extent, wgpu::BufferUsages::UNIFORM);
        let named = [
            ("extent", Bind::Buffer(&extent)),
            ("counts", Bind::Buffer(&counts)),
            ("blocks", Bind::Buffer(&blocks)),
            ("total", Bind::Buffer(&total)),
            ("offsets", Bind::Buffer(&offsets)),
        ];
        let kernel = |shader| Kernel::link(gpu, shader, &[], &[], &named);
        let kernels = [
            (kernel("peel::scan_blocks")?, blocks_count),
            (kernel("peel::scan_top")?, 1),
            (kernel("peel::scan_pixels")?, blocks_count),
        ];
        Ok(Self {
            counts,
            offsets,
            total,
            faults,
            attachment,
            pipelines,
            kernels,
        })
    }

    /// Counts a frame; [`Self::total`] holds the result once the commands are done.
    pub fn encode(&self, recorder: &mut Recorder<'_>, scene: &SceneBuffers, frame: &FrameTargets) {
        recorder.encoder().clear_buffer(&self.counts, 0, None);
        recorder.encoder().clear_buffer(&self.faults, 0, None);
        let attachment = unwritten_attachment(&self.attachment);
        {
            let mut pass = recorder.render("count", &[attachment], None);
            scene.draw(&mut pass, frame, &self.pipelines);
        }
        for (kernel, threads) in &self.kernels {
            kernel.dispatch(recorder, *threads);
        }
    }

    /// What was found, from the words of [`Self::total`].
    pub fn parse(words: &[u32]) -> Result<FragmentCount, RenderError> {
        let word = |i: usize| u64::from(words.get(i).copied().unwrap_or(0));
        let total = word(2) << 32 | word(0);
        if total > u64::from(u32::MAX) {
            return Err(RenderError::Refused(format!(
                "a frame holds {total} fragments or more, beyond what 32-bit offsets can count; draw it in smaller frames"
            )));
        }
        Ok(FragmentCount {
            total,
            most: word(1) as u32,
        })
    }

    /// Nothing, for words of [`Self::faults`] without a fault in a frame of this width.
    ///
    /// # Errors
    /// How many fragments do not come before the next one of their pixel, were counted and not stored, or stored and not counted: a bug of
    /// ours or of the GPU's driver.
    pub fn check(words: &[u32], width: u32) -> Result<(), RenderError> {
        let &[unsorted, lost, uncounted, last] = words else {
            return Ok(());
        };
        if [unsorted, lost, uncounted] == [0; 3] {
            return Ok(());
        }
        // The last pixel where anything is wrong, counted from 1.
        let pixel = last.saturating_sub(1);
        Err(RenderError::Refused(format!(
            "the fragments of this frame are wrong: {unsorted} out of order, {lost} lost, {uncounted} found twice, the last at pixel \
             ({}, {}). This is a fault of peelnet or of the GPU's driver: please report it with what `peelnet doctor` prints. Depth \
             peeling needs no sort",
            pixel % width,
            pixel / width
        )))
    }
}
