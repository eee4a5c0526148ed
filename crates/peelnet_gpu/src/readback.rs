//! From the GPU to memory, in chunks of bounded size.
//!
//! Functions named `_async` run wherever a future can be awaited, in a browser too. The others wait, and do not exist there.

use crate::{Gpu, GpuError, device::locked};
use std::{
    future::Future,
    ops::Range,
    pin::Pin,
    sync::{Arc, Mutex},
    task::{Context, Poll, Waker},
};

/// Bytes of one staging buffer: larger ones were measured to be slower, see the peak in page faults.
#[cfg(not(target_arch = "wasm32"))]
const CHUNK: u64 = 16 << 20;

/// How long a device may take before it counts as lost. Software rasterisers on busy machines are slow.
#[cfg(not(target_arch = "wasm32"))]
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(300);

const DID_NOT_MAP: &str = "a buffer did not map";

/// What a mapping, or a submission, came to, and who waits for it.
#[derive(Debug, Default)]
struct Mapping {
    result: Option<Result<(), wgpu::BufferAsyncError>>,
    waker: Option<Waker>,
}

impl Mapping {
    fn done(shared: &Mutex<Self>, result: Result<(), wgpu::BufferAsyncError>) {
        let mut mapping = locked(shared);
        mapping.result = Some(result);
        if let Some(waker) = mapping.waker.take() {
            waker.wake();
        }
    }

    fn poll(shared: &Mutex<Self>, cx: &Context<'_>) -> Poll<()> {
        let mut mapping = locked(shared);
        if mapping.result.is_some() {
            return Poll::Ready(());
        }
        mapping.waker = Some(cx.waker().clone());
        Poll::Pending
    }
}

/// Bytes on their way from the GPU: ready once the commands that write them are done.
#[derive(Debug)]
pub struct Download {
    staging: wgpu::Buffer,
    mapping: Arc<Mutex<Mapping>>,
}

impl Download {
    /// Records a copy of a buffer's range (multiples of 4), which is mapped when the encoder's commands are submitted.
    pub fn record(
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        buffer: &wgpu::Buffer,
        range: Range<u64>,
    ) -> Self {
        let bytes = range.end - range.start;
        let staging = gpu.staging(bytes);
        encoder.copy_buffer_to_buffer(buffer, range.start, &staging, 0, bytes);
        let mapping = Arc::new(Mutex::new(Mapping::default()));
        let sink = Arc::clone(&mapping);
        encoder.map_buffer_on_submit(&staging, wgpu::MapMode::Read, .., move |result| {
            Mapping::done(&sink, result);
        });
        Self { staging, mapping }
    }

    /// Whether the bytes are there, without waiting.
    pub fn is_ready(&self) -> bool {
        locked(&self.mapping).result.is_some()
    }

    /// The bytes, once [`Self::is_ready`] or after awaiting.
    ///
    /// # Errors
    /// A mapping that failed, as on a lost device.
    pub fn take<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(
        &self,
    ) -> Result<Vec<T>, GpuError> {
        match locked(&self.mapping).result.take() {
            Some(Ok(())) => {}
            Some(Err(e)) => return Err(GpuError::Lost(e.to_string())),
            None => return Err(GpuError::Lost(DID_NOT_MAP.into())),
        }
        let view = self
            .staging
            .get_mapped_range(..)
            .map_err(|e| GpuError::Lost(e.to_string()))?;
        let values = bytemuck::pod_collect_to_vec(&view);
        drop(view);
        self.staging.unmap();
        Ok(values)
    }
}

impl Future for &Download {
    type Output = ();

    fn poll(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<()> {
        Mapping::poll(&self.mapping, cx)
    }
}

impl Gpu {
    /// Copies a byte range of a buffer: all of it at once, after everything submitted so far.
    ///
    /// # Errors
    /// A lost device, or a validation error.
    pub async fn read_async<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(
        &self,
        buffer: &wgpu::Buffer,
        range: Range<u64>,
    ) -> Result<Vec<T>, GpuError> {
        if range.is_empty() {
            self.check()?;
            return Ok(Vec::new());
        }
        let mut encoder = self.encoder();
        let download = Download::record(self, &mut encoder, buffer, range);
        self.queue.submit([encoder.finish()]);
        (&download).await;
        self.check()?;
        download.take()
    }

    /// Copies an RGBA32F texture: `height × width` pixels, row 0 at the top.
    ///
    /// # Errors
    /// A lost device, or a validation error.
    pub async fn read_rgba32f_async(
        &self,
        view: &wgpu::TextureView,
    ) -> Result<Vec<[f32; 4]>, GpuError> {
        let (buffer, row) = self.copied(view);
        let padded: Vec<[f32; 4]> = self.read_async(&buffer, 0..buffer.size()).await?;
        Ok(without_padding(&padded, row, view.texture().width()))
    }

    /// Ends when everything submitted so far is done.
    pub async fn submitted_async(&self) {
        let mapping = Arc::new(Mutex::new(Mapping::default()));
        let sink = Arc::clone(&mapping);
        self.queue
            .on_submitted_work_done(move || Mapping::done(&sink, Ok(())));
        std::future::poll_fn(|cx| Mapping::poll(&mapping, cx)).await;
    }

    /// Runs a future of this device to its end, waiting for the device where the future does. Not in a browser.
    ///
    /// # Errors
    /// Those of the future, and a lost device.
    #[cfg(not(target_arch = "wasm32"))]
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
                return Err(GpuError::Lost(DID_NOT_MAP.into()).into());
            }
        }
    }

    /// Copies an RGBA32F texture into a buffer of padded rows; returns it with the texels of a row.
    fn copied(&self, view: &wgpu::TextureView) -> (wgpu::Buffer, usize) {
        let texture = view.texture();
        let (width, height) = (texture.width(), texture.height());
        let texel = texture.format().block_copy_size(None).unwrap_or(1);
        let row = (width * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("image read-back"),
            size: u64::from(row) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
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
        (buffer, (row / texel) as usize)
    }

    fn staging(&self, size: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("staging"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    }
}

/// Rows of `row` texels without what pads them behind `width`.
fn without_padding<T: Copy>(padded: &[T], row: usize, width: u32) -> Vec<T> {
    padded
        .chunks_exact(row)
        .flat_map(|r| &r[..width as usize])
        .copied()
        .collect()
}

/// What waits: everywhere but in a browser.
#[cfg(not(target_arch = "wasm32"))]
impl Gpu {
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
    pub fn read_into<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(
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
        let staging = [0, 1].map(|_| self.staging(size));
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
            let view = staging[slot]
                .get_mapped_range(..chunks[i].1)
                .map_err(|e| GpuError::Lost(e.to_string()))?;
            out.extend_from_slice(bytemuck::cast_slice(&view));
            drop(view);
            staging[slot].unmap();
        }
        self.check()
    }

    /// Copies a byte range of a buffer.
    ///
    /// # Errors
    /// A lost device, or a validation error.
    pub fn read<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(
        &self,
        buffer: &wgpu::Buffer,
        range: Range<u64>,
    ) -> Result<Vec<T>, GpuError> {
        let mut out = Vec::new();
        self.read_into(buffer, range, &mut out)?;
        Ok(out)
    }

    /// Copies a texture whose texels are `T`s: `height × width` of them, row 0 at the top.
    ///
    /// # Errors
    /// A lost device, or a validation error.
    ///
    /// # Panics
    /// If a texel has another size than `T`.
    pub fn read_texture<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(
        &self,
        view: &wgpu::TextureView,
    ) -> Result<Vec<T>, GpuError> {
        let format = view.texture().format();
        let texel = format.block_copy_size(None);
        assert_eq!(texel, Some(size_of::<T>() as u32), "a texel of {format:?}");
        let (buffer, row) = self.copied(view);
        let padded: Vec<T> = self.read(&buffer, 0..buffer.size())?;
        Ok(without_padding(&padded, row, view.texture().width()))
    }

    fn map(
        &self,
        buffer: &wgpu::Buffer,
        bytes: u64,
        after: wgpu::SubmissionIndex,
    ) -> Result<(), GpuError> {
        let (sender, receiver) = std::sync::mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, ..bytes, move |result| {
            // The receiver is alive until it has got this one message.
            let _ = sender.send(result);
        });
        self.poll(Some(after))?;
        let lost = match receiver.try_recv() {
            Ok(Ok(())) => return Ok(()),
            Ok(Err(e)) => e.to_string(),
            Err(_) => DID_NOT_MAP.into(),
        };
        self.check()?;
        Err(GpuError::Lost(lost))
    }

    /// Waits until a submission, or all of them, is done.
    fn poll(&self, after: Option<wgpu::SubmissionIndex>) -> Result<wgpu::PollStatus, GpuError> {
        let waited = self.device.poll(wgpu::PollType::Wait {
            submission_index: after,
            timeout: Some(PATIENCE),
        });
        waited.map_err(|e| GpuError::Lost(e.to_string()))
    }
}
