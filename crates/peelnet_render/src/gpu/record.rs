//! Records passes and measures each with a timestamp at both of its ends.

use crate::gpu::{Gpu, GpuError, readback::Download};
use std::time::Duration;

/// Passes that one frame may measure; the ones beyond run unmeasured and are counted.
const MAX_TIMED: u32 = 1024;

/// GPU time of one pass.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    /// The pass's label.
    pub label: String,
    /// Microseconds on the GPU.
    pub micros: f64,
}

/// Measures the passes of one frame.
#[derive(Debug)]
pub struct Timer {
    /// `None` on adapters without timestamps: passes are counted and not measured.
    queries: Option<wgpu::QuerySet>,
    labels: Vec<String>,
    cpu: Vec<PassTime>,
}

impl Timer {
    /// A timer for one frame.
    pub fn new(gpu: &Gpu) -> Self {
        let queries = gpu.has(wgpu::Features::TIMESTAMP_QUERY).then(|| {
            gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass times"),
                ty: wgpu::QueryType::Timestamp,
                count: MAX_TIMED * 2,
            })
        });
        Self {
            queries,
            labels: Vec::new(),
            cpu: Vec::new(),
        }
    }

    /// Records the copy of all timestamps, behind the frame's last pass. What it returns is the time of work on the CPU and of every measured
    /// pass in order (none without timestamps), to be awaited once the frame was submitted.
    ///
    /// # Errors
    /// A lost device.
    pub fn finish(
        self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
    ) -> impl Future<Output = Result<Vec<PassTime>, GpuError>> + use<> {
        let Self {
            queries,
            labels,
            cpu,
        } = self;
        let count = labels.len() as u32 * 2;
        let period = f64::from(gpu.queue.get_timestamp_period());
        let download = queries.filter(|_| count > 0).map(|queries| {
            let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
            let resolved = gpu.buffer("pass times", u64::from(count) * 8, usage);
            encoder.resolve_query_set(&queries, 0..count, &resolved, 0);
            Download::record(gpu, encoder, &[resolved])
        });
        async move {
            let Some(download) = download else {
                return Ok(Vec::new());
            };
            let ticks: Vec<Vec<u64>> = download.read().await?;
            let passes = labels.into_iter().zip(ticks[0].chunks_exact(2));
            let passes = passes.map(|(label, t)| PassTime {
                label,
                micros: t[1].saturating_sub(t[0]) as f64 * period / 1e3,
            });
            Ok(cpu.into_iter().chain(passes).collect())
        }
    }
}

/// Records the passes of a frame into a caller's encoder.
#[derive(Debug)]
pub struct Recorder<'e> {
    gpu: &'e Gpu,
    encoder: &'e mut wgpu::CommandEncoder,
    timer: Option<&'e mut Timer>,
}

impl<'e> Recorder<'e> {
    /// Records into `encoder`; with a timer, each pass is measured.
    pub const fn new(
        gpu: &'e Gpu,
        encoder: &'e mut wgpu::CommandEncoder,
        timer: Option<&'e mut Timer>,
    ) -> Self {
        Self {
            gpu,
            encoder,
            timer,
        }
    }

    /// The device this records for.
    pub const fn gpu(&self) -> &'e Gpu {
        self.gpu
    }

    /// The encoder, for copies and clears between passes.
    pub const fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        self.encoder
    }

    /// Writes to a buffer in the order of the recorded commands: what was recorded before sees the old bytes. (A queue's writes all
    /// come before the commands of a submission.) The length must be a multiple of 4.
    pub fn write<T: bytemuck::NoUninit>(&mut self, buffer: &wgpu::Buffer, data: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let size = bytes.len() as u64;
        if size == 0 {
            return;
        }
        let staging = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("write"),
            size,
            usage: wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: true,
        });
        if let Ok(mut view) = staging.get_mapped_range_mut(..) {
            view.copy_from_slice(bytes);
        }
        staging.unmap();
        self.encoder
            .copy_buffer_to_buffer(&staging, 0, buffer, 0, size);
    }

    /// Adds work of the CPU that the frame waits for to the times of its passes.
    pub fn on_the_cpu(&mut self, label: &str, time: Duration) {
        if let Some(timer) = &mut self.timer {
            timer.cpu.push(PassTime {
                label: format!("{label} (CPU)"),
                micros: time.as_secs_f64() * 1e6,
            });
        }
    }

    /// The place of a pass's times; none without timestamps, and beyond so many passes.
    fn next_query(&mut self, label: &str) -> Option<(wgpu::QuerySet, u32)> {
        let timer = self.timer.as_mut()?;
        let queries = timer.queries.clone()?;
        if timer.labels.len() as u32 >= MAX_TIMED {
            return None;
        }
        timer.labels.push(label.to_owned());
        Some((queries, (timer.labels.len() as u32 - 1) * 2))
    }

    /// Begins a render pass.
    pub fn render(
        &mut self,
        label: &str,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
    ) -> wgpu::RenderPass<'_> {
        let query = self.next_query(label);
        self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: colors,
            depth_stencil_attachment: depth,
            timestamp_writes: query.as_ref().map(|(query_set, q)| {
                wgpu::RenderPassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: Some(*q),
                    end_of_pass_write_index: Some(q + 1),
                }
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// Begins a compute pass.
    pub fn compute(&mut self, label: &str) -> wgpu::ComputePass<'_> {
        let query = self.next_query(label);
        self.encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(label),
                timestamp_writes: query.as_ref().map(|(query_set, q)| {
                    wgpu::ComputePassTimestampWrites {
                        query_set,
                        beginning_of_pass_write_index: Some(*q),
                        end_of_pass_write_index: Some(q + 1),
                    }
                }),
            })
    }

    /// Submits what is recorded and goes on with a new encoder in its place: only for encoders of one's own.
    pub fn submit(&mut self) {
        let done = std::mem::replace(self.encoder, self.gpu.encoder());
        self.gpu.queue.submit([done.finish()]);
    }
}
