//! From the GPU to memory, in chunks of bounded size.
//!
//! Functions named `_async` run wherever a future can be awaited, in a browser too. The others wait, and do not exist there.

use crate::gpu::{Gpu, GpuError};
use bytemuck::{AnyBitPattern, NoUninit};
use futures_channel::oneshot;

#[cfg(not(target_arch = "wasm32"))]
use {
    crate::gpu::{Kernel, bind::Bind, record::Recorder},
    std::{
        future::Future,
        ops::Range,
        task::{Context, Poll, Waker},
    },
};

/// Bytes of one staging buffer: larger ones were measured to be slower, see the peak in page faults.
#[cfg(not(target_arch = "wasm32"))]
const CHUNK: u64 = 16 << 20;

/// How long a device may take before it counts as lost. Software rasterisers on busy machines are slow.
#[cfg(not(target_arch = "wasm32"))]
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(300);

const STAGING: wgpu::BufferUsages =
    wgpu::BufferUsages::COPY_DST.union(wgpu::BufferUsages::MAP_READ);

fn lost(reason: impl ToString) -> GpuError {
    GpuError::Lost(reason.to_string())
}

fn did_not_map() -> GpuError {
    lost("a buffer did not map")
}

/// Bytes of some buffers on their way from the GPU: there once the commands that write them are done.
#[derive(Debug)]
pub struct Download {
    staging: wgpu::Buffer,
    sizes: Vec<u64>,
    mapped: oneshot::Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Download {
    /// Records a copy of buffers, which is mapped when the encoder's commands are submitted.
    pub fn record(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, buffers: &[wgpu::Buffer]) -> Self {
        let sizes: Vec<u64> = buffers.iter().map(wgpu::Buffer::size).collect();
        let staging = gpu.buffer("staging", sizes.iter().sum(), STAGING);
        let mut end = 0;
        for buffer in buffers {
            encoder.copy_buffer_to_buffer(buffer, 0, &staging, end, buffer.size());
            end += buffer.size();
        }
        let (sender, mapped) = oneshot::channel();
        encoder.map_buffer_on_submit(&staging, wgpu::MapMode::Read, .., |result| {
            // Nobody may wait for it any more.
            let _ = sender.send(result);
        });
        Self {
            staging,
            sizes,
            mapped,
        }
    }

    /// The values of each buffer if they are there, without waiting; to be asked until then.
    ///
    /// # Errors
    /// A mapping that failed, as on a lost device.
    pub fn try_read<T: AnyBitPattern + NoUninit>(
        &mut self,
    ) -> Result<Option<Vec<Vec<T>>>, GpuError> {
        match self.mapped.try_recv() {
            Ok(None) => Ok(None),
            Ok(Some(result)) => self.values(result).map(Some),
            Err(_) => Err(did_not_map()),
        }
    }

    /// The values of each buffer, once the encoder's commands are submitted.
    ///
    /// # Errors
    /// A mapping that failed, as on a lost device.
    pub async fn read<T: AnyBitPattern + NoUninit>(mut self) -> Result<Vec<Vec<T>>, GpuError> {
        let result = (&mut self.mapped).await;
        self.values(result.map_err(|_| did_not_map())?)
    }

    fn values<T: AnyBitPattern + NoUninit>(
        &self,
        mapped: Result<(), wgpu::BufferAsyncError>,
    ) -> Result<Vec<Vec<T>>, GpuError> {
        mapped.map_err(lost)?;
        let view = self.staging.get_mapped_range(..).map_err(lost)?;
        let mut left: &[u8] = &view;
        let take = |&size: &u64| {
            let (values, rest) = left.split_at(size as usize);
            left = rest;
            bytemuck::pod_collect_to_vec(values)
        };
        let values = self.sizes.iter().map(take).collect();
        drop(view);
        self.staging.unmap();
        Ok(values)
    }
}

impl Gpu {
    /// Copies a buffer: all of it at once, after everything submitted so far.
    ///
    /// # Errors
    /// A lost device, or a validation error.
    pub async fn read_async<T: AnyBitPattern + NoUninit>(
        &self,
        buffer: &wgpu::Buffer,
    ) -> Result<Vec<T>, GpuError> {
        let mut encoder = self.encoder();
        let download = Download::record(self, &mut encoder, std::slice::from_ref(buffer));
        self.queue.submit([encoder.finish()]);
        let values = download.read().await;
        self.check()?;
        Ok(values?.pop().unwrap_or_default())
    }

    /// Copies a texture whose texels are `T`s: `height × width` of them, row 0 at the top.
    ///
    /// # Errors
    /// A lost device, or a validation error.
    ///
    /// # Panics
    /// If a texel has another size than `T`.
    pub async fn read_texture_async<T: AnyBitPattern + NoUninit>(
        &self,
        view: &wgpu::TextureView,
    ) -> Result<Vec<T>, GpuError> {
        let texture = view.texture();
        let (format, texel) = (texture.format(), size_of::<T>() as u32);
        let is_of_texel = format.block_copy_size(None) == Some(texel);
        assert!(is_of_texel, "a texel of {format:?} has not {texel} bytes");
        // Copies have padded rows.
        let row = (texture.width() * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let size = u64::from(row) * u64::from(texture.height());
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let buffer = self.buffer("image read-back", size, usage);
        let mut encoder = self.encoder();
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        self.queue.submit([encoder.finish()]);
        let padded: Vec<T> = self.read_async(&buffer).await?;
        let rows = padded.chunks_exact((row / texel) as usize);
        let rows = rows.map(|row| &row[..texture.width() as usize]);
        Ok(rows.flatten().copied().collect())
    }

    /// Ends when everything submitted so far is done.
    pub async fn submitted_async(&self) {
        let (sender, done) = oneshot::channel();
        self.queue.on_submitted_work_done(|| {
            // Nobody may wait for it any more.
            let _ = sender.send(());
        });
        // An error is a device that went away: what is read next says so.
        let _ = done.await;
    }
}

/// What waits: everywhere but in a browser.
#[cfg(not(target_arch = "wasm32"))]
impl Gpu {
    /// Runs a future of this device to its end, waiting for the device where the future does.
    ///
    /// # Errors
    /// Those of the future, and a lost device.
    pub fn block_on<T, E: From<GpuError>>(
        &self,
        future: impl Future<Output = Result<T, E>>,
    ) -> Result<T, E> {
        let mut future = std::pin::pin!(future);
        let mut cx = Context::from_waker(Waker::noop());
        // A wait runs the callbacks of everything submitted. What is not done long after the queue is empty never will be.
        let mut waits_in_vain = 0;
        loop {
            if let Poll::Ready(result) = future.as_mut().poll(&mut cx) {
                return result;
            }
            let waited = self.poll(None);
            self.check()?;
            let queue_empty = waited?.is_queue_empty();
            waits_in_vain = if queue_empty { waits_in_vain + 1 } else { 0 };
            if waits_in_vain > 1_000 {
                return Err(did_not_map().into());
            }
        }
    }

    /// Waits until everything submitted is done.
    ///
    /// # Errors
    /// A lost device, or the first validation error since the last call.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.poll(None)?;
        self.check()
    }

    /// Copies a byte range of a buffer into `out`, which it first clears. The range must be a multiple of 4.
    ///
    /// # Errors
    /// A lost device, or a validation error.
    pub fn read_into<T: AnyBitPattern + NoUninit>(
        &self,
        buffer: &wgpu::Buffer,
        range: Range<u64>,
        out: &mut Vec<T>,
    ) -> Result<(), GpuError> {
        out.clear();
        let total = range.end.saturating_sub(range.start);
        if total == 0 {
            return self.check();
        }
        let size = total.min(CHUNK);
        let staging = [0, 1].map(|_| self.buffer("staging", size, STAGING));
        out.reserve((total / size_of::<T>() as u64) as usize);
        // Two chunks in flight: the device copies one while we copy the other.
        let chunks: Vec<_> = (0..total.div_ceil(size))
            .map(|i| (i * size, size.min(total - i * size)))
            .collect();
        let send = |slot: usize, (offset, bytes): (u64, u64)| {
            let mut encoder = self.encoder();
            encoder.copy_buffer_to_buffer(buffer, range.start + offset, &staging[slot], 0, bytes);
            self.queue.submit([encoder.finish()])
        };
        let mut submitted = send(0, chunks[0]);
        for i in 0..chunks.len() {
            let slot = i % 2;
            let this = submitted.clone();
            self.map(&staging[slot], chunks[i].1, this)?;
            if i + 1 < chunks.len() {
                submitted = send(1 - slot, chunks[i + 1]);
            }
            let view = staging[slot].get_mapped_range(..chunks[i].1);
            out.extend_from_slice(bytemuck::cast_slice(&view.map_err(lost)?));
            staging[slot].unmap();
        }
        self.check()
    }

    /// Copies a byte range of a buffer.
    ///
    /// # Errors
    /// A lost device, or a validation error.
    pub fn read<T: AnyBitPattern + NoUninit>(
        &self,
        buffer: &wgpu::Buffer,
        range: Range<u64>,
    ) -> Result<Vec<T>, GpuError> {
        let mut out = Vec::new();
        self.read_into(buffer, range, &mut out)?;
        Ok(out)
    }

    /// The same as [`Gpu::read_texture_async`], waiting for the device.
    ///
    /// # Errors
    /// See there.
    pub fn read_texture<T: AnyBitPattern + NoUninit>(
        &self,
        view: &wgpu::TextureView,
    ) -> Result<Vec<T>, GpuError> {
        self.block_on(self.read_texture_async(view))
    }

    /// Runs a compute shader with a thread for each input or more: binding 0 holds the inputs, 1 is where so many answers are written.
    ///
    /// # Errors
    /// Answers that do not fit the GPU's memory, a lost device, or a validation error.
    pub fn run<I: NoUninit, O: AnyBitPattern + NoUninit>(
        &self,
        wgsl: &str,
        inputs: &[I],
        answers: usize,
        threads: u32,
    ) -> Result<Vec<O>, GpuError> {
        let inputs = self.upload("inputs", inputs, wgpu::BufferUsages::STORAGE);
        let bytes = (answers * size_of::<O>()) as u64;
        let answers = self.storage("answers", bytes)?;
        let entries = [(0, Bind::Read(&inputs)), (1, Bind::Write(&answers))];
        let kernel = Kernel::new(self, &crate::shaders::plain("run", wgsl), &entries);
        let mut encoder = self.encoder();
        kernel.dispatch(&mut Recorder::new(self, &mut encoder, None), threads);
        self.queue.submit([encoder.finish()]);
        self.read(&answers, 0..bytes)
    }

    /// Maps a buffer's first bytes once a submission is done.
    fn map(
        &self,
        buffer: &wgpu::Buffer,
        bytes: u64,
        after: wgpu::SubmissionIndex,
    ) -> Result<(), GpuError> {
        let (sender, mut mapped) = oneshot::channel();
        buffer.map_async(wgpu::MapMode::Read, ..bytes, |result| {
            // The receiver is alive until it has got this one message.
            let _ = sender.send(result);
        });
        self.poll(Some(after))?;
        let error = match mapped.try_recv() {
            Ok(Some(Ok(()))) => return Ok(()),
            Ok(Some(Err(e))) => lost(e),
            Ok(None) | Err(_) => did_not_map(),
        };
        self.check()?;
        Err(error)
    }

    /// Waits until a submission, or all of them, is done.
    fn poll(&self, after: Option<wgpu::SubmissionIndex>) -> Result<wgpu::PollStatus, GpuError> {
        let waited = self.device.poll(wgpu::PollType::Wait {
            submission_index: after,
            timeout: Some(PATIENCE),
        });
        waited.map_err(lost)
    }
}
