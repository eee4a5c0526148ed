//! Runs of more than [`SHORT`] fragments: sorted by many threads, and gone through in pieces, so that no shader loop is as long as a scene makes it.
//!
//! A thread that sorts or composites thousands of fragments holds its neighbours up, on some systems until a watchdog ends it, and software
//! rasterisers end long loops without an error. Every loop of these kernels is bounded by a constant of `shaders/peel`.

use crate::geometry::{RenderError, fragments::Tile};
use crate::gpu::{Gpu, Kernel, bind::Bind, record::Recorder, wgpu};
use crate::shaders::ShaderError;

/// Fragments of a run that one thread sorts at most: two windows, and few enough that its neighbours do not wait long. Scenes of 100 layers are
/// faster with it than with one thread for all, on a software rasteriser; where the border is best was not searched.
pub const SHORT: u32 = 64;

/// Slots that a thread works on; `WINDOW` in `peel/long_runs.wgsl`.
const WINDOW: u32 = 32;

// A window touches two long runs at most.
const _: () = assert!(SHORT >= WINDOW);

/// Fragments of a pixel at most: 17 doublings of 32 slots, 256 times [`PIECE`].
pub const MAX_RUN: u32 = 1 << 22;

/// Fragments of a run that a thread goes through at a time; `PIECE` in `peel/runs.wgsl`.
pub const PIECE: u32 = 1 << 14;

/// The module `parameters` of the shaders of `peel` that sort or walk runs.
pub fn parameters() -> String {
    format!("const SHORT: u32 = {SHORT}u;\n")
}

/// A kernel of `peel` with its module `parameters`.
pub(crate) fn kernel(
    gpu: &Gpu,
    shader: &str,
    features: &[&str],
    named: &[(&str, Bind<'_>)],
) -> Result<Kernel, ShaderError> {
    let parameters = parameters();
    let extra = [("parameters", parameters.as_str())];
    Kernel::link(gpu, shader, features, &extra, named)
}

#[derive(Debug)]
pub struct LongRuns {
    /// Slots in sorted order.
    pub order: wgpu::Buffer,
    /// How often the sorted length doubles.
    doublings: u32,
    windows: u32,
    find: Kernel,
    sort: Kernel,
    /// From the other buffer into `order`, and back.
    merge: [Kernel; 2],
    step: wgpu::Buffer,
    check: Kernel,
}

impl LongRuns {
    /// Bytes of a fragment: its place in two orders, and its part of a window.
    pub const BYTES: f64 = 4.0 + 4.0 + 8.0 / WINDOW as f64;

    /// For runs of at most `most` fragments in storage of so many `fragments`; `named` is what the S-buffer's kernels bind.
    pub(crate) fn new(
        gpu: &Gpu,
        named: &[(&str, Bind<'_>)],
        fragments: u64,
        most: u32,
    ) -> Result<Self, RenderError> {
        let windows = fragments.div_ceil(WINDOW.into());
        let order = gpu.storage("fragment order", fragments * 4)?;
        let other = gpu.storage("other fragment order", fragments * 4)?;
        let touched = gpu.storage("long runs", windows * 8)?;
        let step = gpu.upload("merge step", &[0u32; 4], wgpu::BufferUsages::UNIFORM);
        let common = [("windows", &touched), ("step", &step)];
        let kernel = |shader, own: &[(&'static str, &wgpu::Buffer)]| {
            let own = common.iter().chain(own);
            let own = own.map(|&(name, buffer)| (name, Bind::Buffer(buffer)));
            let named: Vec<_> = named.iter().copied().chain(own).collect();
            kernel(gpu, shader, &[], &named)
        };
        let merge = |from, to| kernel("peel::long_merge", &[("sorted", from), ("merged", to)]);
        let doublings = most.div_ceil(WINDOW).max(1).next_power_of_two().ilog2();
        let first = if doublings.is_multiple_of(2) {
            &order
        } else {
            &other
        };
        Ok(Self {
            doublings,
            windows: windows as u32,
            find: kernel("peel::long_windows", &[])?,
            sort: kernel("peel::long_chunks", &[("order", first)])?,
            merge: [merge(&other, &order)?, merge(&order, &other)?],
            check: kernel("peel::check_long", &[("order", &order)])?,
            order,
            step,
        })
    }

    /// Sorts the long runs of a tile, and checks that they are.
    pub(crate) fn sort(&self, recorder: &mut Recorder<'_>) {
        let windows = self.windows;
        self.find.dispatch(recorder, windows);
        self.sort.dispatch(recorder, windows);
        for doubling in 0..self.doublings {
            recorder.write(&self.step, &[WINDOW << doubling, 0, 0, 0]);
            // The last one writes `order`.
            let left = (self.doublings - 1 - doubling) % 2;
            self.merge[left as usize].dispatch(recorder, windows);
        }
        self.check.dispatch(recorder, windows);
    }
}

/// Composites what lies before the last piece of every long run: see `peel/runs.wgsl`.
#[derive(Debug)]
pub struct Fold {
    kernel: Kernel,
    step: wgpu::Buffer,
    pieces: u32,
}

impl Fold {
    /// For runs of at most `most` fragments; `features` name the pass that composites, `parameters` is its module of that name, and
    /// `entries` what its names stand for.
    pub fn new(
        gpu: &Gpu,
        features: &[&str],
        parameters: &str,
        entries: &[(&str, Bind<'_>)],
        most: u32,
    ) -> Result<Self, RenderError> {
        let step = gpu.upload("piece", &[0u32; 4], wgpu::BufferUsages::UNIFORM);
        let entries = [entries, &[("step", Bind::Uniform(&step))]].concat();
        let extra = [("parameters", parameters)];
        Ok(Self {
            kernel: Kernel::link(gpu, "peel::fold", features, &extra, &entries)?,
            pieces: most.div_ceil(PIECE),
            step,
        })
    }

    /// Records one dispatch for each piece but the last.
    pub fn encode(&self, recorder: &mut Recorder<'_>, tile: &Tile) {
        for piece in 0..self.pieces.saturating_sub(1) {
            recorder.write(&self.step, &[piece, 0, 0, 0]);
            self.kernel.dispatch(recorder, tile.end - tile.begin);
        }
    }
}
