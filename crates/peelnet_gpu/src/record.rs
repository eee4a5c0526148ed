//! Records passes and measures each with a timestamp at both of its ends.

use crate::{Gpu, GpuError};

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

/// Records the passes of one frame, over as many submissions as it takes.
#[derive(Debug)]
pub struct Recorder<'g> {
    gpu: &'g Gpu,
    encoder: wgpu::CommandEncoder,
    timer: Option<wgpu::QuerySet>,
    labels: Vec<String>,
    cpu: Vec<PassTime>,
    passes: u32,
}

impl<'g> Recorder<'g> {
    /// A recorder; with `timed` it measures where the adapter has timestamps.
    pub fn new(gpu: &'g Gpu, timed: bool) -> Self {
        let timer = (timed && gpu.has(wgpu::Features::TIMESTAMP_QUERY)).then(|| {
            gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass times"),
                ty: wgpu::QueryType::Timestamp,
                count: MAX_TIMED * 2,
            })
        });
        Self {
            gpu,
            encoder: gpu
                .device
                .create_command_encoder(&wgpu::CommandEncoderDescriptor::default()),
            timer,
            labels: Vec::new(),
            cpu: Vec::new(),
            passes: 0,
        }
    }

    /// The device this records for.
    pub const fn gpu(&self) -> &'g Gpu {
        self.gpu
    }

    /// The encoder, for copies and clears between passes.
    pub const fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        &mut self.encoder
    }

    /// Number of passes so far.
    pub const fn passes(&self) -> u32 {
        self.passes
    }

    /// Adds work of the CPU that the frame waits for to the times of its passes.
    pub fn on_the_cpu(&mut self, label: &str, time: std::time::Duration) {
        self.cpu.push(PassTime {
            label: format!("{label} (CPU)"),
            micros: time.as_secs_f64() * 1e6,
        });
    }

    fn next_query(&mut self, label: &str) -> Option<u32> {
        self.passes += 1;
        if self.timer.is_none() || self.labels.len() as u32 >= MAX_TIMED {
            return None;
        }
        self.labels.push(label.to_owned());
        Some((self.labels.len() as u32 - 1) * 2)
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
            timestamp_writes: self.timer.as_ref().zip(query).map(|(query_set, q)| {
                wgpu::RenderPassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: Some(q),
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
                timestamp_writes: self.timer.as_ref().zip(query).map(|(query_set, q)| {
                    wgpu::ComputePassTimestampWrites {
                        query_set,
                        beginning_of_pass_write_index: Some(q),
                        end_of_pass_write_index: Some(q + 1),
                    }
                }),
            })
    }

    /// Submits what is recorded and goes on recording.
    pub fn submit(&mut self) {
        let next = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let done = std::mem::replace(&mut self.encoder, next);
        self.gpu.queue.submit([done.finish()]);
    }

    /// Submits the rest, waits, and returns the time of work on the CPU and of every measured pass in order (none without
    /// timestamps).
    ///
    /// # Errors
    /// A lost device, or a validation error.
    pub fn finish(mut self) -> Result<Vec<PassTime>, GpuError> {
        let count = self.labels.len() as u32 * 2;
        let Some(timer) = self.timer.take().filter(|_| count > 0) else {
            self.submit();
            self.gpu.wait()?;
            return Ok(Vec::new());
        };
        let bytes = u64::from(count) * 8;
        let resolved = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("pass times"),
            size: bytes,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        self.encoder
            .resolve_query_set(&timer, 0..count, &resolved, 0);
        self.submit();
        let ticks: Vec<u64> = self.gpu.read(&resolved, 0..bytes)?;
        let period = f64::from(self.gpu.queue.get_timestamp_period());
        let passes = self
            .labels
            .into_iter()
            .zip(ticks.chunks_exact(2))
            .map(|(label, t)| PassTime {
                label,
                micros: t[1].saturating_sub(t[0]) as f64 * period / 1e3,
            });
        Ok(self.cpu.into_iter().chain(passes).collect())
    }
}
