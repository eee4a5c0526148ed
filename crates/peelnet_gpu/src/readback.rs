//! From the GPU to memory, in chunks of bounded size.

use crate::{Gpu, GpuError};
use std::{ops::Range, time::Duration};

/// Bytes of one staging buffer: larger ones were measured to be slower, see the peak in page faults.
const CHUNK: u64 = 16 << 20;

/// How long a device may take before it counts as lost. Software rasterisers on busy machines are slow.
const PATIENCE: Duration = Duration::from_secs(300);

impl Gpu {
    /// Waits until everything submitted is done.
    ///
    /// # Errors
    /// A lost device, or the first validation error since the last call.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.device
            .poll(wgpu::PollType::Wait {
                submission_index: None,
                timeout: Some(PATIENCE),
            })
            .map_err(|e| GpuError::Lost(e.to_string()))?;
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
            let mut encoder = self
                .device
                .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
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

    /// Copies an RGBA32F texture: `height × width` pixels, row 0 at the top.
    ///
    /// # Errors
    /// A lost device, or a validation error.
    pub fn read_rgba32f(&self, view: &wgpu::TextureView) -> Result<Vec<[f32; 4]>, GpuError> {
        let texture = view.texture();
        let (width, height) = (texture.width(), texture.height());
        let row = (width * 16).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("image read-back"),
            size: u64::from(row) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let mut encoder = self
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
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
        let padded: Vec<[f32; 4]> = self.read(&buffer, 0..u64::from(row) * u64::from(height))?;
        Ok(padded
            .chunks_exact(row as usize / 16)
            .flat_map(|r| &r[..width as usize])
            .copied()
            .collect())
    }

    fn staging(&self, size: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("staging"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
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
        self.device
            .poll(wgpu::PollType::Wait {
                submission_index: Some(after),
                timeout: Some(PATIENCE),
            })
            .map_err(|e| GpuError::Lost(e.to_string()))?;
        match receiver.try_recv() {
            Ok(Ok(())) => Ok(()),
            Ok(Err(e)) => {
                self.check()?;
                Err(GpuError::Lost(e.to_string()))
            }
            Err(_) => {
                self.check()?;
                Err(GpuError::Lost("a buffer did not map".into()))
            }
        }
    }
}
