//! A pass over every pixel, without geometry.

use crate::{RasterError, frame::Output};
use peelnet_gpu::{
    Gpu, RenderPipeline,
    bind::{Bind, Bound},
    record::Recorder,
    wgpu,
};

/// A pipeline that covers the frame, with its bind group.
#[derive(Debug)]
pub struct FullscreenPass {
    label: String,
    pipeline: wgpu::RenderPipeline,
    group: Bound,
}

impl FullscreenPass {
    /// Builds the pass; `extra` are modules that are not in `shaders/`, `entries` the bindings of group 0 in order.
    ///
    /// # Errors
    /// A shader that does not link.
    pub fn new(
        gpu: &Gpu,
        shader: &str,
        features: &[&str],
        extra: &[(&str, &str)],
        entries: &[Bind<'_>],
        targets: &[Option<wgpu::ColorTargetState>],
    ) -> Result<Self, RasterError> {
        Self::with_samples(gpu, shader, features, extra, entries, targets, 1)
    }

    /// The same for the pass that writes finished pixels to where the frame's output goes.
    ///
    /// # Errors
    /// A shader that does not link.
    pub fn resolve(
        gpu: &Gpu,
        shader: &str,
        features: &[&str],
        extra: &[(&str, &str)],
        entries: &[Bind<'_>],
        output: Output,
    ) -> Result<Self, RasterError> {
        let targets = [Some(output.state())];
        Self::with_samples(
            gpu,
            shader,
            features,
            extra,
            entries,
            &targets,
            output.samples(),
        )
    }

    fn with_samples(
        gpu: &Gpu,
        shader: &str,
        features: &[&str],
        extra: &[(&str, &str)],
        entries: &[Bind<'_>],
        targets: &[Option<wgpu::ColorTargetState>],
        samples: u32,
    ) -> Result<Self, RasterError> {
        let group = gpu.bind(shader, wgpu::ShaderStages::FRAGMENT, entries);
        let wgsl = peelnet_shaders::link(shader, features, extra)?;
        let pipeline = gpu.render_pipeline(&RenderPipeline {
            label: shader,
            vertex: [shader, &wgsl],
            fragment: [shader, &wgsl],
            groups: &[Some(&group)],
            buffers: &[],
            targets,
            depth: None,
            samples,
            culled: None,
        });
        Ok(Self {
            label: shader.to_owned(),
            pipeline,
            group,
        })
    }

    /// Records the pass.
    pub fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
    ) {
        self.draw_within(recorder, colors, None);
    }

    /// Records the pass over a rectangle: x, y, width, height.
    pub fn draw_within(
        &self,
        recorder: &mut Recorder<'_>,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        rectangle: Option<[u32; 4]>,
    ) {
        let mut pass = recorder.render(&self.label, colors, None);
        if let Some([x, y, width, height]) = rectangle {
            pass.set_scissor_rect(x, y, width, height);
        }
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
