//! A pass over the boxes around transparent parts instead of their surfaces: what lies where is known less well, by far fewer triangles.

use crate::{FrameTargets, GeometryPass, RasterError, SceneBuffers};
use peelnet_gpu::{Gpu, bind::Bound, record::Recorder, wgpu};

/// Two triangles for each face.
const VERTICES: u32 = 36;

/// By how much boxes are larger than what they hold, of their longest side: rounding must not miss a flat part.
const GROWN: f32 = 1e-3;

/// The pipeline of such a pass, and the boxes.
#[derive(Debug)]
pub struct BoxPass {
    pipeline: wgpu::RenderPipeline,
    boxes: wgpu::Buffer,
    count: u32,
}

impl BoxPass {
    /// Builds the pass. Its fragment shader runs where the far side of a box is, also where the eye is inside; what it is given is
    /// `scene::box_vertex`.
    ///
    /// # Errors
    /// A shader that does not link.
    pub fn new(
        gpu: &Gpu,
        scene: &SceneBuffers,
        frame: &FrameTargets,
        pass: &GeometryPass<'_>,
    ) -> Result<Self, RasterError> {
        let groups: [Option<&Bound>; 2] = [Some(&frame.scene_group), pass.group];
        let groups = &groups[..1 + usize::from(pass.group.is_some())];
        let vertex = peelnet_shaders::link("scene::box_vertex", &[], &[])?;
        let fragment = peelnet_shaders::link(pass.shader, pass.features, pass.extra)?;
        let signatures: Vec<_> = groups.iter().map(|g| g.map(|g| &g.signature)).collect();
        let key = format!(
            "boxes\n{:?}\n{signatures:?}\n{vertex}\n{fragment}",
            pass.targets
        );
        let pipeline = gpu.render_pipeline(key, || {
            let vertex = gpu.shader("scene::box_vertex", &vertex);
            let fragment = gpu.shader(pass.shader, &fragment);
            let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
            let layouts: Vec<_> = groups.iter().map(|g| g.map(|g| &g.layout)).collect();
            gpu.device
                .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some(pass.label),
                    layout: Some(&gpu.layout(&layouts)),
                    vertex: wgpu::VertexState {
                        module: &vertex,
                        entry_point: Some("vertex_main"),
                        compilation_options: wgpu::PipelineCompilationOptions::default(),
                        buffers: &[Some(wgpu::VertexBufferLayout {
                            array_stride: size_of::<[f32; 6]>() as u64,
                            step_mode: wgpu::VertexStepMode::Instance,
                            attributes: &attributes,
                        })],
                    },
                    primitive: wgpu::PrimitiveState {
                        cull_mode: Some(wgpu::Face::Front),
                        ..Default::default()
                    },
                    depth_stencil: None,
                    multisample: wgpu::MultisampleState::default(),
                    fragment: Some(wgpu::FragmentState {
                        module: &fragment,
                        entry_point: Some("fragment_main"),
                        compilation_options: wgpu::PipelineCompilationOptions::default(),
                        targets: pass.targets,
                    }),
                    multiview_mask: None,
                    cache: None,
                })
        });
        // At least one: buffers are never empty.
        let mut corners = corners(scene);
        let count = corners.len() as u32;
        corners.resize(corners.len().max(1), [0.0; 6]);
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        Ok(Self {
            pipeline,
            boxes: gpu.upload("boxes of parts", &corners, usage),
            count,
        })
    }

    /// Takes over where the parts are now. A part more or less needs another pass ([`SceneBuffers::generation`]).
    pub fn update(&self, recorder: &mut Recorder<'_>, scene: &SceneBuffers) {
        let mut corners = corners(scene);
        corners.truncate(self.count as usize);
        if !corners.is_empty() {
            recorder.write(&self.boxes, &corners);
        }
    }

    /// Draws all boxes.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, frame: &FrameTargets) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &frame.scene_group.group, &[]);
        pass.set_vertex_buffer(0, self.boxes.slice(..));
        pass.draw(0..VERTICES, 0..self.count);
    }
}

/// The lower and the upper corner of each box, in world space.
fn corners(scene: &SceneBuffers) -> Vec<[f32; 6]> {
    let boxes = scene.transparent_parts().filter_map(|part| part.bounds);
    let grown = boxes.map(|[low, high]| {
        let by = glam::Vec3::splat(GROWN * (high - low).max_element());
        let ([a, b, c], [d, e, f]) = ((low - by).to_array(), (high + by).to_array());
        [a, b, c, d, e, f]
    });
    grown.collect()
}
