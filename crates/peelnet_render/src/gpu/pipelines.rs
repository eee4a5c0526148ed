//! Pipelines, compiled where they are not in the cache.

use crate::gpu::{
    Gpu,
    bind::{Bind, Bound, numbered},
    cache::RenderKey,
    locked,
    record::Recorder,
};
use crate::shaders::{self, Shader, ShaderError};

/// A compute shader, whose entry point is `main`, with its bindings.
#[derive(Debug)]
pub struct Kernel {
    label: String,
    pipeline: wgpu::ComputePipeline,
    group: Bound,
}

impl Kernel {
    /// Links a shader of `shaders/` and gives it what its names stand for.
    ///
    /// # Errors
    /// A shader that does not link, or a variable of it for which nothing is given.
    pub fn link(
        gpu: &Gpu,
        shader: &str,
        features: &[&str],
        extra: &[(&str, &str)],
        named: &[(&str, Bind<'_>)],
    ) -> Result<Self, ShaderError> {
        let shader = shaders::link(shader, features, extra)?;
        Ok(Self::new(gpu, &shader, &numbered(&shader, 0, named)?))
    }

    /// Compiles the shader where its pipeline is not known yet.
    pub(crate) fn new(gpu: &Gpu, shader: &Shader, entries: &[(u32, Bind<'_>)]) -> Self {
        let label = shader.name.as_str();
        let group = gpu.bind(label, wgpu::ShaderStages::COMPUTE, entries);
        let key = (shader.id, group.entries.clone());
        let all = &gpu.shared.pipelines.compute;
        let known = locked(all).get(&key).cloned();
        let pipeline = known.unwrap_or_else(|| {
            let descriptor = wgpu::ComputePipelineDescriptor {
                label: Some(label),
                layout: Some(&gpu.layout(&[Some(&group.layout)])),
                module: &gpu.shader(shader),
                entry_point: Some("main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            };
            let made = gpu.device.create_compute_pipeline(&descriptor);
            locked(all).entry(key).or_insert(made).clone()
        });
        Self {
            label: label.to_owned(),
            pipeline,
            group,
        }
    }

    /// Records it over this many threads, in workgroups of 64.
    pub fn dispatch(&self, recorder: &mut Recorder<'_>, threads: u32) {
        let [x, y] = groups_2d(threads);
        let mut pass = recorder.compute(&self.label);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group.group, &[]);
        pass.dispatch_workgroups(x, y, 1);
    }
}

/// Workgroups of 64 threads over `items`, as a 2-D dispatch: one dimension holds at most 65,535 groups.
pub fn groups_2d(items: u32) -> [u32; 2] {
    let groups = items.div_ceil(64).max(1);
    let x = groups.min(32_768);
    [x, groups.div_ceil(x)]
}

/// A render pipeline that is not compiled yet, with the entry points `vertex_main` and `fragment_main`.
#[derive(Debug)]
#[allow(missing_docs, reason = "as those of wgpu's descriptor")]
pub struct RenderPipeline<'a> {
    pub label: &'a str,
    pub vertex: &'a Shader,
    pub fragment: &'a Shader,
    /// Bind groups of the layouts that it takes.
    pub groups: &'a [Option<&'a Bound>],
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub targets: &'a [Option<wgpu::ColorTargetState>],
    pub depth: Option<wgpu::DepthStencilState>,
    /// Samples a pixel of the targets.
    pub samples: u32,
    /// Faces that are not drawn.
    pub culled: Option<wgpu::Face>,
}

impl Gpu {
    /// A render pipeline, made where there is none that equals it yet.
    pub fn render_pipeline(&self, made_of: &RenderPipeline<'_>) -> wgpu::RenderPipeline {
        let layouts = made_of.groups.iter();
        let buffers = made_of.buffers.iter().map(|b| {
            let b = b.as_ref()?;
            Some((b.array_stride, b.step_mode, b.attributes.to_vec()))
        });
        let key = RenderKey {
            shaders: [made_of.vertex.id, made_of.fragment.id],
            layouts: layouts.map(|g| g.map(|g| g.entries.clone())).collect(),
            buffers: buffers.collect(),
            targets: made_of.targets.to_vec(),
            depth: made_of.depth.clone(),
            samples: made_of.samples,
            culled: made_of.culled,
        };
        // Compiling takes long: the lock is not held meanwhile, and the first of two equal pipelines stays.
        if let Some(known) = locked(&self.shared.pipelines.render).get(&key) {
            return known.clone();
        }
        let [vertex, fragment] = [made_of.vertex, made_of.fragment].map(|s| self.shader(s));
        let groups = made_of.groups.iter();
        let layouts: Vec<_> = groups.map(|g| g.map(|g| &g.layout)).collect();
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
        let mut all = locked(&self.shared.pipelines.render);
        all.entry(key).or_insert(made).clone()
    }

    /// Number of pipelines compiled so far.
    pub fn compiled_pipelines(&self) -> usize {
        locked(&self.shared.pipelines.render).len() + locked(&self.shared.pipelines.compute).len()
    }
}
