//! How many fragments each pixel has, and the prefix sum of that.

use crate::{
    FrameTargets, GeometryPass, GeometryPipelines, RasterError, SceneBuffers, Surfaces,
    frame::attachment, long_runs::Kernel,
};
use peelnet_gpu::{
    Gpu,
    bind::{Bind, Bound},
    record::Recorder,
    wgpu,
};

/// Pixels of one block of the prefix sum; `BLOCK` in `peel/scan_blocks.wgsl`.
const BLOCK: u32 = 256;

/// What the count pass found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FragmentCount {
    /// Fragments in the frame.
    pub total: u64,
    /// Fragments in the fullest pixel.
    pub most: u32,
}

/// What the checks of a frame found wrong, fragment by fragment. Anything is a bug of ours or of the GPU's driver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// Fragments that do not come before the next one of their pixel.
    pub unsorted: u32,
    /// Fragments that were counted and not stored.
    pub lost: u32,
    /// Fragments that were stored and not counted.
    pub uncounted: u32,
    /// The last pixel where anything is wrong.
    pub pixel: [u32; 2],
}

impl Faults {
    /// The bytes of [`CountPass::faults`] that are read back.
    pub const BYTES: std::ops::Range<u64> = 0..16;

    /// Nothing, for words without a fault in a frame of this width.
    ///
    /// # Errors
    /// [`RasterError::Faults`].
    pub fn check(words: &[u32], width: u32) -> Result<(), RasterError> {
        match *words {
            [0, 0, 0, ..] => Ok(()),
            [unsorted, lost, uncounted, last, ..] => {
                let pixel = last.saturating_sub(1);
                Err(RasterError::Faults(Self {
                    unsorted,
                    lost,
                    uncounted,
                    pixel: [pixel % width, pixel / width],
                }))
            }
            _ => Ok(()),
        }
    }
}

/// The count pass and the three kernels of the prefix sum.
#[derive(Debug)]
pub struct CountPass {
    /// Fragments per pixel, row-major; the S-buffer's second pass counts it down to zero.
    pub counts: wgpu::Buffer,
    /// First fragment of each pixel; one entry more than pixels, the last one the total.
    pub offsets: wgpu::Buffer,
    /// See [`Self::found`]; the bytes [`Self::TOTAL`].
    pub total: wgpu::Buffer,
    /// What is wrong with the frame's fragments, see [`Faults`]; the bytes [`Faults::BYTES`].
    pub faults: wgpu::Buffer,
    // A pass needs an attachment; nothing is written to this one.
    attachment: wgpu::TextureView,
    pipelines: GeometryPipelines,
    group: Bound,
    kernels: [(Kernel, [u32; 2]); 3],
}

impl CountPass {
    /// The bytes of [`Self::total`] that are read back.
    pub const TOTAL: std::ops::Range<u64> = 0..12;

    /// Builds the pass for a frame. `features` may hold `sampled`.
    ///
    /// # Errors
    /// A frame whose counters exceed a storage binding, or a shader that does not link.
    pub fn new(
        gpu: &Gpu,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        features: &[&str],
    ) -> Result<Self, RasterError> {
        let pixels = frame.pixels();
        let counts = gpu.storage("fragment counts", u64::from(pixels) * 4)?;
        let offsets = gpu.storage("fragment offsets", u64::from(pixels) * 4 + 4)?;
        let blocks_count = pixels.div_ceil(BLOCK);
        let blocks = gpu.storage("prefix-sum blocks", u64::from(blocks_count) * 8)?;
        let total = gpu.storage("fragment total", 12)?;
        let faults = gpu.storage("faults", 16)?;
        let attachment = unwritten_texture(gpu, frame)?;
        let group = gpu.bind(
            "count",
            wgpu::ShaderStages::FRAGMENT,
            &[Bind::Write(&counts)],
        );
        let pipelines = scene.pipelines(
            gpu,
            frame,
            Surfaces::Transparent,
            &GeometryPass {
                label: "count",
                shader: "peel::count",
                features,
                group: Some(&group),
                targets: &[unwritten()],
                ..GeometryPass::NONE
            },
        )?;
        let groups = groups_2d(blocks_count);
        let extent = gpu.upload(
            "extent",
            &[pixels, blocks_count, groups[0], 0],
            wgpu::BufferUsages::UNIFORM,
        );
        let extent = Bind::Uniform(&extent);
        let kernels = [
            (
                "peel::scan_blocks",
                vec![extent, Bind::Read(&counts), Bind::Write(&blocks)],
            ),
            (
                "peel::scan_top",
                vec![extent, Bind::Write(&blocks), Bind::Write(&total)],
            ),
            (
                "peel::scan_pixels",
                vec![
                    extent,
                    Bind::Read(&counts),
                    Bind::Read(&blocks),
                    Bind::Write(&offsets),
                ],
            ),
        ];
        let kernels = kernels.map(|(name, entries)| Kernel::new(gpu, name, &[], &entries));
        let [blocks, top, pixels] = kernels;
        let kernels = [(blocks?, groups), (top?, [1, 1]), (pixels?, groups)];
        Ok(Self {
            counts,
            offsets,
            total,
            faults,
            attachment,
            pipelines,
            group,
            kernels,
        })
    }

    /// Counts a frame; [`Self::total`] holds the result once the commands are done.
    pub fn encode(&self, recorder: &mut Recorder<'_>, scene: &SceneBuffers, frame: &FrameTargets) {
        recorder.encoder().clear_buffer(&self.counts, 0, None);
        recorder.encoder().clear_buffer(&self.faults, 0, None);
        {
            let mut pass =
                recorder.render("count", &[unwritten_attachment(&self.attachment)], None);
            pass.set_bind_group(1, &self.group.group, &[]);
            scene.draw(&mut pass, frame, Surfaces::Transparent, &self.pipelines);
        }
        for (kernel, groups) in &self.kernels {
            kernel.dispatch(recorder, *groups);
        }
    }

    /// What was found, from the words of [`Self::total`].
    ///
    /// # Errors
    /// More fragments than 32-bit offsets can count.
    pub fn found(words: &[u32]) -> Result<FragmentCount, RasterError> {
        let word = |i: usize| u64::from(words.get(i).copied().unwrap_or(0));
        let total = word(2) << 32 | word(0);
        if total > u64::from(u32::MAX) {
            return Err(RasterError::TooManyFragments(total));
        }
        Ok(FragmentCount {
            total,
            most: word(1) as u32,
        })
    }

    /// Counts a frame, submits and reads the result back.
    ///
    /// # Errors
    /// A lost device, or more fragments than 32-bit offsets can count.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn run(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &SceneBuffers,
        frame: &FrameTargets,
    ) -> Result<FragmentCount, RasterError> {
        self.encode(recorder, scene, frame);
        recorder.submit();
        Self::found(&recorder.gpu().read::<u32>(&self.total, Self::TOTAL)?)
    }

    /// The attachment of passes that write storage only.
    pub fn attachment(&self) -> Option<wgpu::RenderPassColorAttachment<'_>> {
        unwritten_attachment(&self.attachment)
    }
}

/// Workgroups of 64 threads over `items`, as a 2-D dispatch: one dimension holds at most 65,535 groups.
pub fn groups_2d(items: u32) -> [u32; 2] {
    let groups = items.div_ceil(64).max(1);
    let x = groups.min(32_768);
    [x, groups.div_ceil(x)]
}

/// Format of the attachment of passes that write storage alone: WebGPU wants one.
const UNWRITTEN: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// That attachment's texture, a byte a pixel.
///
/// # Errors
/// A frame beyond the adapter's limits.
pub fn unwritten_texture(
    gpu: &Gpu,
    frame: &FrameTargets,
) -> Result<wgpu::TextureView, RasterError> {
    let none = wgpu::TextureUsages::empty();
    Ok(gpu.texture("no attachment", UNWRITTEN, frame.size, 1, none)?)
}

/// A colour target that nothing is written to.
pub fn unwritten() -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState {
        format: UNWRITTEN,
        blend: None,
        write_mask: wgpu::ColorWrites::empty(),
    })
}

/// The attachment, cleared and not stored.
pub fn unwritten_attachment(
    view: &wgpu::TextureView,
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let mut cleared = attachment(view, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT))?;
    cleared.ops.store = wgpu::StoreOp::Discard;
    Some(cleared)
}
