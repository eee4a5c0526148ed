//! A pass over every pixel, without geometry.

use crate::geometry::RenderError;
use crate::gpu::{
    Gpu, RenderPipeline,
    bind::{Bind, Bound, numbered},
    record::Recorder,
    wgpu,
};

/// What a pass draws onto besides its colours.
#[derive(Debug)]
pub struct Onto {
    /// Samples of a pixel.
    pub samples: u32,
    /// The depth that it writes.
    pub depth: Option<wgpu::DepthStencilState>,
}

impl From<u32> for Onto {
    fn from(samples: u32) -> Self {
        Self {
            samples,
            depth: None,
        }
    }
}

#[derive(Debug)]
pub struct FullscreenPass {
    label: String,
    pipeline: wgpu::RenderPipeline,
    group: Bound,
}

impl FullscreenPass {
    /// Builds the pass, onto targets of so many samples a pixel. The shader has the fragment stage alone; `extra` are modules that are not in `shaders/`, `entries` what the names of
    /// group 0 stand for.
    pub fn new(
        gpu: &Gpu,
        shader: &str,
        features: &[&str],
        extra: &[(&str, &str)],
        entries: &[(&str, Bind<'_>)],
        targets: &[Option<wgpu::ColorTargetState>],
        onto: impl Into<Onto>,
    ) -> Result<Self, RenderError> {
        let Onto { samples, depth } = onto.into();
        let linked = crate::shaders::link(shader, features, extra)?;
        let triangle = crate::shaders::link("helpers::screen", &[], &[])?;
        let entries = numbered(&linked, 0, entries)?;
        let group = gpu.bind(shader, wgpu::ShaderStages::FRAGMENT, &entries);
        let pipeline = gpu.render_pipeline(&RenderPipeline {
            label: shader,
            vertex: &triangle,
            fragment: &linked,
            groups: &[Some(&group)],
            buffers: &[],
            targets,
            depth,
            samples,
            culled: None,
        });
        Ok(Self {
            label: shader.to_owned(),
            pipeline,
            group,
        })
    }

    /// Records the pass, over a rectangle where there is one: x, y, width, height.
    pub fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        rectangle: Option<[u32; 4]>,
    ) {
        self.draw_depth(recorder, colors, None, rectangle);
    }

    /// The same with a depth that it writes.
    pub fn draw_depth(
        &self,
        recorder: &mut Recorder<'_>,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
        rectangle: Option<[u32; 4]>,
    ) {
        let mut pass = recorder.render(&self.label, colors, depth);
        if let Some([x, y, width, height]) = rectangle {
            pass.set_scissor_rect(x, y, width, height);
        }
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
