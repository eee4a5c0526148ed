//! The texture that the window shows, made of the pictures of one or two methods.

use bytemuck::{Pod, Zeroable};
use eframe::egui_wgpu::RenderState;
use peelnet_gpu::{Gpu, GpuError, wgpu};

/// Format of what egui shows: encoded values, as egui expects of textures.
const SHOWN: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// What is shown; the numbers of `display.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Show {
    First = 0,
    Second = 1,
    Split = 2,
    Beside = 3,
    Error = 4,
    Layers = 5,
}

/// Layout of `View` in `display.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
pub(crate) struct View {
    pub show: u32,
    pub divider: u32,
    pub scale: f32,
    pub pad: u32,
}

/// The last pass of the viewer, and its target.
pub(crate) struct Display {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    view: wgpu::Buffer,
    target: Option<(wgpu::TextureView, egui::TextureId)>,
}

impl std::fmt::Debug for Display {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Display")
    }
}

impl Display {
    pub fn new(gpu: &Gpu) -> Self {
        let texture = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let uniform = wgpu::BindGroupLayoutEntry {
            binding: 2,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("display"),
                entries: &[texture(0), texture(1), uniform],
            });
        let shader = gpu.shader("display", include_str!("display.wgsl"));
        let pipeline = gpu
            .device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("display"),
                layout: Some(&gpu.layout(&[Some(&layout)])),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some("vertex_main"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: None,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some("fragment_main"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(SHOWN.into())],
                }),
                multiview_mask: None,
                cache: None,
            });
        Self {
            pipeline,
            layout,
            view: gpu.upload("display", &[View::zeroed()], wgpu::BufferUsages::UNIFORM),
            target: None,
        }
    }

    /// The texture, once something was drawn.
    pub fn texture(&self) -> Option<egui::TextureId> {
        self.target.as_ref().map(|(_, id)| *id)
    }

    /// The texture's texels, four bytes each.
    #[cfg(test)]
    pub fn texels(&self, gpu: &Gpu) -> Vec<[u8; 4]> {
        let (view, _) = self.target.as_ref().expect("something was drawn");
        gpu.read_texture(view).expect("reads back")
    }

    /// Records the pass. A second picture that is not read may be the first.
    ///
    /// # Errors
    /// A picture beyond the adapter's limits.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        egui: &RenderState,
        encoder: &mut wgpu::CommandEncoder,
        size: [u32; 2],
        pictures: [&wgpu::TextureView; 2],
        view: View,
    ) -> Result<(), GpuError> {
        let target = self.sized(gpu, egui, size)?;
        gpu.queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("display"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(pictures[0]),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(pictures[1]),
                },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: self.view.as_entire_binding(),
                },
            ],
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("display"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: None,
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
        Ok(())
    }

    /// The target in this size, known to egui.
    fn sized(
        &mut self,
        gpu: &Gpu,
        egui: &RenderState,
        size: [u32; 2],
    ) -> Result<wgpu::TextureView, GpuError> {
        let of = |view: &wgpu::TextureView| [view.texture().width(), view.texture().height()];
        if let Some((view, _)) = self.target.as_ref().filter(|(view, _)| of(view) == size) {
            return Ok(view.clone());
        }
        let usage = wgpu::TextureUsages::COPY_SRC;
        let view = gpu.texture("display", SHOWN, size, 1, usage)?;
        let mut renderer = egui.renderer.write();
        let nearest = wgpu::FilterMode::Nearest;
        let id = match self.target.take() {
            Some((_, id)) => {
                renderer.update_egui_texture_from_wgpu_texture(&gpu.device, &view, nearest, id);
                id
            }
            None => renderer.register_native_texture(&gpu.device, &view, nearest),
        };
        self.target = Some((view.clone(), id));
        Ok(view)
    }
}
