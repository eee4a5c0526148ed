//! What any wgpu program has: a device, targets, pipelines and passes, and a picture read back.

use pollster::block_on;
use std::error::Error;
use wgpu::{BlendComponent, BlendFactor::One, BlendOperation, BlendState, TextureUsages};

/// Width and height of the picture.
pub const SIZE: u32 = 256;

/// A texture that passes draw into and read.
pub struct Target {
    view: wgpu::TextureView,
    clear: wgpu::Color,
    blend: Option<BlendState>,
}

impl Target {
    /// `blend` has the operations for colour and alpha; both factors are one.
    pub fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        clear: wgpu::Color,
        blend: Option<(BlendOperation, BlendOperation)>,
    ) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width: SIZE,
                height: SIZE,
                ..Default::default()
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT
                | TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let part = |operation| BlendComponent {
            src_factor: One,
            dst_factor: One,
            operation,
        };
        Self {
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            clear,
            blend: blend.map(|(color, alpha)| BlendState {
                color: part(color),
                alpha: part(alpha),
            }),
        }
    }
}

/// A device, a shader module, and the passes recorded so far.
pub struct Program {
    pub device: wgpu::Device,
    queue: wgpu::Queue,
    module: wgpu::ShaderModule,
    encoder: wgpu::CommandEncoder,
}

impl Program {
    pub fn new(wgsl: &str) -> Result<Self, Box<dyn Error>> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
        let (device, queue) = block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(wgsl.into()),
        });
        let encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        Ok(Self {
            device,
            queue,
            module,
            encoder,
        })
    }

    /// A pass over strips of four vertices, by a vertex and a fragment shader that read textures by their bindings.
    pub fn draw(
        &mut self,
        [vertex, fragment]: [&str; 2],
        strips: u32,
        reads: &[(u32, &Target)],
        targets: &[&Target],
    ) {
        let states = targets.iter().map(|target| {
            Some(wgpu::ColorTargetState {
                blend: target.blend,
                ..target.view.texture().format().into()
            })
        });
        let pipeline_descriptor = wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: None,
            vertex: wgpu::VertexState {
                module: &self.module,
                entry_point: Some(vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                ..Default::default()
            },
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &self.module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &states.collect::<Vec<_>>(),
            }),
            multiview_mask: None,
            cache: None,
        };
        let pipeline = self.device.create_render_pipeline(&pipeline_descriptor);
        let attachments = targets.iter().map(|target| {
            Some(wgpu::RenderPassColorAttachment {
                view: &target.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(target.clear),
                    store: wgpu::StoreOp::Store,
                },
            })
        });
        let mut recorded = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &attachments.collect::<Vec<_>>(),
            ..Default::default()
        });
        recorded.set_pipeline(&pipeline);
        if !reads.is_empty() {
            let entries = reads.iter().map(|(binding, target)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: wgpu::BindingResource::TextureView(&target.view),
            });
            let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries.collect::<Vec<_>>(),
            });
            recorded.set_bind_group(0, &group, &[]);
        }
        recorded.draw(0..4, 0..strips);
    }

    /// Submits everything and reads a target of four bytes a pixel.
    pub fn finish(mut self, picture: &Target) -> Result<Vec<u8>, Box<dyn Error>> {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(4 * SIZE * SIZE),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        self.encoder.copy_texture_to_buffer(
            picture.view.texture().as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    bytes_per_row: Some(4 * SIZE),
                    ..Default::default()
                },
            },
            picture.view.texture().size(),
        );
        self.queue.submit([self.encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |_| ());
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(buffer.get_mapped_range(..)?.to_vec())
    }
}
