//! Compiled pipelines, kept by all that decides them: a resize, a second scene or a second method compiles none anew.

use crate::{Gpu, bind::Bound, device::locked};
use std::{collections::HashMap, sync::Mutex};

/// Pipelines by their keys, for the life of the device.
#[derive(Debug, Default)]
pub(crate) struct PipelineCache {
    render: Mutex<HashMap<String, wgpu::RenderPipeline>>,
    compute: Mutex<HashMap<String, wgpu::ComputePipeline>>,
}

/// A render pipeline that is not made yet, with the entry points `vertex_main` and `fragment_main`.
#[derive(Debug)]
pub struct RenderPipeline<'a> {
    /// Label for messages.
    pub label: &'a str,
    /// Name and text of the vertex shader.
    pub vertex: [&'a str; 2],
    /// Name and text of the fragment shader.
    pub fragment: [&'a str; 2],
    /// Bind groups of the layouts that it takes.
    pub groups: &'a [Option<&'a Bound>],
    /// Vertex buffers.
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// Colour targets.
    pub targets: &'a [Option<wgpu::ColorTargetState>],
    /// Depth state.
    pub depth: Option<wgpu::DepthStencilState>,
    /// Samples a pixel of the targets.
    pub samples: u32,
    /// Faces that are not drawn.
    pub culled: Option<wgpu::Face>,
}

impl Gpu {
    /// A render pipeline, made where there is none that equals it yet.
    pub fn render_pipeline(&self, made_of: &RenderPipeline<'_>) -> wgpu::RenderPipeline {
        let RenderPipeline { groups, .. } = made_of;
        let signatures: Vec<_> = groups.iter().map(|g| g.map(|g| &g.signature)).collect();
        let states = (
            made_of.targets,
            &made_of.depth,
            made_of.samples,
            made_of.culled,
        );
        let ([_, vertex], [_, fragment], buffers) =
            (made_of.vertex, made_of.fragment, made_of.buffers);
        let key = format!(
            "{signatures:?}
{states:?}
{buffers:?}
{vertex}
{fragment}"
        );
        // Compiling takes long: the lock is not held meanwhile, and the first of two equal pipelines stays.
        if let Some(known) = locked(&self.pipelines().render).get(&key) {
            return known.clone();
        }
        let [vertex, fragment] =
            [made_of.vertex, made_of.fragment].map(|[name, wgsl]| self.shader(name, wgsl));
        let layouts: Vec<_> = groups.iter().map(|g| g.map(|g| &g.layout)).collect();
        let descriptor = wgpu::RenderPipelineDescriptor {
            label: Some(made_of.label),
            layout: Some(&self.layout(&layouts)),
            vertex: wgpu::VertexState {
                module: &vertex,
                entry_point: Some("vertex_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: made_of.buffers,
            },
            primitive: wgpu::PrimitiveState {
                cull_mode: made_of.culled,
                ..Default::default()
            },
            depth_stencil: made_of.depth.clone(),
            multisample: wgpu::MultisampleState {
                count: made_of.samples,
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: &fragment,
                entry_point: Some("fragment_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: made_of.targets,
            }),
            multiview_mask: None,
            cache: None,
        };
        let made = self.device.create_render_pipeline(&descriptor);
        let mut all = locked(&self.pipelines().render);
        all.entry(key).or_insert(made).clone()
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
