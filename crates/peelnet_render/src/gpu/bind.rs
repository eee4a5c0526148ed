//! A bind group and its layout from one list, so that the two cannot disagree.

use crate::gpu::{Gpu, cache::Layout};
use crate::shaders::{Shader, ShaderError};

/// One resource.
#[derive(Clone, Copy, Debug)]
pub enum Bind<'a> {
    /// A uniform buffer.
    Uniform(&'a wgpu::Buffer),
    /// A storage buffer that shaders only read.
    Read(&'a wgpu::Buffer),
    /// A storage buffer that shaders write.
    Write(&'a wgpu::Buffer),
    /// A texture of floats, integers or depths read by `textureLoad`.
    Texture(&'a wgpu::TextureView),
    /// A colour texture read through a sampler.
    Image(&'a wgpu::TextureView),
    /// A sampler.
    Sampler(&'a wgpu::Sampler),
    /// A buffer that is bound as the shader declares it, see [`numbered`].
    Buffer(&'a wgpu::Buffer),
}

/// A layout with one group that fits it.
#[derive(Clone, Debug)]
pub struct Bound {
    /// For pipelines.
    pub layout: wgpu::BindGroupLayout,
    /// For passes.
    pub group: wgpu::BindGroup,
    /// What the layout was made of: equal for groups that fit the same pipelines.
    pub entries: Layout,
}

/// The resources of a group that a linked shader declares, with their numbers, of the named ones. Others are left out.
///
/// # Errors
/// A variable of the shader for which nothing is given.
pub fn numbered<'a>(
    shader: &Shader,
    group: u32,
    named: &[(&str, Bind<'a>)],
) -> Result<Vec<(u32, Bind<'a>)>, ShaderError> {
    let declared = shader.bindings.iter().filter(|b| b.group == group);
    let given = declared.map(|declared| {
        let found = named.iter().find(|(name, _)| *name == declared.name);
        let Some((_, bind)) = found else {
            let names: Vec<_> = named.iter().map(|(name, _)| *name).collect();
            return Err(ShaderError::new(format!(
                "shader {} reads '{}', and its pass gives it [{}]",
                shader.name,
                declared.name,
                names.join(", ")
            )));
        };
        let bind = match *bind {
            Bind::Buffer(buffer) if declared.space.contains("uniform") => Bind::Uniform(buffer),
            Bind::Buffer(buffer) if declared.space.contains("write") => Bind::Write(buffer),
            Bind::Buffer(buffer) => Bind::Read(buffer),
            bind => bind,
        };
        Ok((declared.number, bind))
    });
    given.collect()
}

impl Gpu {
    /// Builds a bind group whose entries, behind their numbers, are visible to the stages given.
    pub fn bind(
        &self,
        label: &str,
        stages: wgpu::ShaderStages,
        entries: &[(u32, Bind<'_>)],
    ) -> Bound {
        let entries = entries.iter().map(|&(binding, bind)| {
            let (ty, resource) = bind.described();
            let entry = wgpu::BindGroupLayoutEntry {
                binding,
                // Vertex shaders may not write storage in portable WebGPU.
                visibility: match bind {
                    Bind::Write(_) => stages & !wgpu::ShaderStages::VERTEX,
                    _ => stages,
                },
                ty,
                count: None,
            };
            (entry, wgpu::BindGroupEntry { binding, resource })
        });
        let (layout_entries, group_entries): (Layout, Vec<_>) = entries.unzip();
        let layout = self
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &layout_entries,
            });
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: &layout,
            entries: &group_entries,
        });
        Bound {
            layout,
            group,
            entries: layout_entries,
        }
    }
}

impl<'a> Bind<'a> {
    /// What it is in a layout and in a group.
    fn described(self) -> (wgpu::BindingType, wgpu::BindingResource<'a>) {
        let buffer = |buffer: &'a wgpu::Buffer, ty| {
            let ty = wgpu::BindingType::Buffer {
                ty,
                has_dynamic_offset: false,
                min_binding_size: None,
            };
            (ty, buffer.as_entire_binding())
        };
        let texture = |view: &'a wgpu::TextureView, filterable| {
            let texture = view.texture();
            let ty = wgpu::BindingType::Texture {
                sample_type: match texture.format().sample_type(None, None) {
                    Some(wgpu::TextureSampleType::Float { .. }) | None => {
                        wgpu::TextureSampleType::Float { filterable }
                    }
                    Some(other) => other,
                },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: texture.sample_count() > 1,
            };
            (ty, wgpu::BindingResource::TextureView(view))
        };
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        match self {
            Self::Uniform(b) => buffer(b, wgpu::BufferBindingType::Uniform),
            Self::Read(b) | Self::Buffer(b) => buffer(b, storage(true)),
            Self::Write(b) => buffer(b, storage(false)),
            Self::Texture(view) => texture(view, false),
            Self::Image(view) => texture(view, true),
            Self::Sampler(sampler) => (
                wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                wgpu::BindingResource::Sampler(sampler),
            ),
        }
    }
}
