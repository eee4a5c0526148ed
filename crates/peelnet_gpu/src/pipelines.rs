//! Compiled pipelines, kept by all that decides them: a resize, a second scene or a second method compiles none anew.

use crate::{Gpu, bind::Bound, device::locked};
use std::{collections::HashMap, sync::Mutex};

/// Pipelines by their keys, for the life of the device.
#[derive(Debug, Default)]
pub(crate) struct PipelineCache {
    render: Mutex<HashMap<String, wgpu::RenderPipeline>>,
    compute: Mutex<HashMap<String, wgpu::ComputePipeline>>,
}

impl Gpu {
    /// The render pipeline of `key`, made where there is none yet. The key holds everything that decides the pipeline: shader
    /// texts, [`Bound::signature`] of each group, targets, states.
    pub fn render_pipeline(
        &self,
        key: String,
        make: impl FnOnce() -> wgpu::RenderPipeline,
    ) -> wgpu::RenderPipeline {
        // Compiling takes long: the lock is not held meanwhile, and the first of two equal pipelines stays.
        if let Some(known) = locked(&self.pipelines().render).get(&key) {
            return known.clone();
        }
        let made = make();
        locked(&self.pipelines().render)
            .entry(key)
            .or_insert(made)
            .clone()
    }

    /// A compute pipeline with one entry point, `main`, and one bind group.
    pub fn compute(&self, label: &str, wgsl: &str, group: &Bound) -> wgpu::ComputePipeline {
        let key = format!("{}\n{wgsl}", group.signature);
        if let Some(known) = locked(&self.pipelines().compute).get(&key) {
            return known.clone();
        }
        let module = self.shader(label, wgsl);
        let made = self
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(label),
                layout: Some(&self.layout(&[Some(&group.layout)])),
                module: &module,
                entry_point: Some("main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
        locked(&self.pipelines().compute)
            .entry(key)
            .or_insert(made)
            .clone()
    }

    /// Submits one compute shader with one bind group, over this many workgroups.
    pub fn dispatch(&self, label: &str, wgsl: &str, group: &Bound, workgroups: u32) {
        let pipeline = self.compute(label, wgsl, group);
        let mut encoder = self.encoder();
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(label),
                timestamp_writes: None,
            });
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group.group, &[]);
            pass.dispatch_workgroups(workgroups, 1, 1);
        }
        self.queue.submit([encoder.finish()]);
    }

    /// Number of pipelines compiled so far.
    pub fn compiled_pipelines(&self) -> usize {
        locked(&self.pipelines().render).len() + locked(&self.pipelines().compute).len()
    }
}
