//! A pass over the boxes around transparent parts instead of their surfaces: what lies where is known less well, by far fewer triangles.

use crate::geometry::{FrameTargets, GeometryPass, RenderError, SceneBuffers};
use crate::gpu::{RenderPipeline, bind::Bound, record::Recorder, wgpu};

/// Two triangles for each face.
const VERTICES: u32 = 36;

#[derive(Debug)]
pub struct BoxPass {
    pipeline: wgpu::RenderPipeline,
    group: Option<Bound>,
    /// Of each box the number of its object, and from the unit cube to the object's space.
    parts: Vec<(usize, glam::Mat4)>,
    boxes: wgpu::Buffer,
}

impl BoxPass {
    /// Builds the pass. Its fragment shader runs where the far side of a box is, also where the eye is inside; what it is given is
    /// `scene::box_vertex`.
    pub fn new(
        scene: &SceneBuffers,
        frame: &FrameTargets,
        pass: &GeometryPass<'_>,
    ) -> Result<Self, RenderError> {
        let gpu = &scene.gpu;
        let fragment = crate::shaders::link(pass.shader, pass.features, pass.extra)?;
        let group = pass.bind(gpu, &fragment)?;
        let groups = [Some(&frame.scene_group), group.as_ref()];
        let groups = &groups[..1 + usize::from(group.is_some())];
        let vertex = crate::shaders::link("scene::box_vertex", &[], &[])?;
        let attributes = wgpu::vertex_attr_array![
            0 => Float32x4, 1 => Float32x4, 2 => Float32x4, 3 => Float32x4, 4 => Float32x4, 5 => Float32x4
        ];
        let pipeline = gpu.render_pipeline(&RenderPipeline {
            label: pass.label,
            vertex: &vertex,
            fragment: &fragment,
            groups,
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<BoxData>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &attributes,
            })],
            targets: pass.targets,
            depth: None,
            samples: 1,
            culled: Some(wgpu::Face::Front),
        });
        let parts: Vec<_> = scene
            .transparent_parts()
            .filter_map(|part| {
                let (object, number) = part.place;
                let found = scene.scene.objects[object].mesh.box_of(number)?;
                Some((object, found))
            })
            .collect();
        // At least one: buffers are never empty.
        let mut data = placed(&parts, scene);
        data.resize(data.len().max(1), [[0.0; 4]; 6]);
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        Ok(Self {
            pipeline,
            group,
            parts,
            boxes: gpu.upload("boxes of parts", &data, usage),
        })
    }

    /// Takes over where the objects are now. A part more or less needs another pass ([`SceneBuffers::generation`]).
    pub fn update(&self, recorder: &mut Recorder<'_>, scene: &SceneBuffers) {
        let data = placed(&self.parts, scene);
        if !data.is_empty() {
            recorder.write(&self.boxes, &data);
        }
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, frame: &FrameTargets) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &frame.scene_group.group, &[]);
        pass.set_bind_group(1, self.group.as_ref().map(|g| &g.group), &[]);
        pass.set_vertex_buffer(0, self.boxes.slice(..));
        pass.draw(0..VERTICES, 0..self.parts.len() as u32);
    }
}

/// A box as the shader reads it: three rows from the unit cube to world space, and three back.
type BoxData = [[f32; 4]; 6];

fn placed(parts: &[(usize, glam::Mat4)], scene: &SceneBuffers) -> Vec<BoxData> {
    let of_part = |&(object, object_from_unit): &(usize, glam::Mat4)| {
        let mut world_from_unit = scene.scene.objects[object].world_from_object * object_from_unit;
        if world_from_unit.determinant() < 0.0 {
            // A mirror would turn the faces around.
            let turned = glam::Vec3::new(-1.0, 1.0, 1.0);
            world_from_unit *=
                glam::Mat4::from_translation(glam::Vec3::X) * glam::Mat4::from_scale(turned);
        }
        let unit_from_world = world_from_unit.inverse();
        let rows =
            [world_from_unit, unit_from_world].map(|m| [0, 1, 2].map(|k| m.row(k).to_array()));
        let [[a, b, c], [d, e, f]] = rows;
        [a, b, c, d, e, f]
    };
    parts.iter().map(of_part).collect()
}
