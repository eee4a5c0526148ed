//! A bind group and its layout from one list, so that the two cannot disagree.

use crate::gpu::{Gpu, cache::Layout};
use crate::shaders::{Shader, ShaderError};

/// One resource; its place in the list is its binding number.
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
    /// Nothing: this shader has no such binding.
    None,
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

/// Named resources in the order of a linked shader's binding numbers in a group. Those that the shader does not read are left out.
///
/// # Errors
/// A variable of the shader for which nothing is given.
pub fn numbered<'a>(
    shader: &Shader,
    group: u32,
    named: &[(&str, Bind<'a>)],
) -> Result<Vec<Bind<'a>>, ShaderError> {
    let mut all = Vec::new();
    for (_, number, variable) in shader.bindings.iter().filter(|b| b.0 == group) {
        let Some((_, bind)) = named.iter().find(|(name, _)| name == variable) else {
            let names: Vec<_> = named.iter().map(|(name, _)| *name).collect();
            return Err(ShaderError::new(format!(
                "shader {} reads '{variable}', and its pass gives it [{}]",
                shader.name,
                names.join(", ")
            )));
        };
        let number = *number as usize;
        all.resize(all.len().max(number + 1), Bind::None);
        all[number] = *bind;
    }
    Ok(all)
}

impl Gpu {
    /// Builds a bind group whose entries are visible to the stages given.
    pub fn bind(&self, label: &str, stages: wgpu::ShaderStages, entries: &[Bind<'_>]) -> Bound {
        let layout_entries: Vec<_> = entries
            .iter()
            .zip(0..)
            .filter_map(|(bind, binding)| Some((bind, binding, bind.kind()?)))
            .map(|(bind, binding, ty)| wgpu::BindGroupLayoutEntry {
                binding,
                // Vertex shaders may not write storage in portable WebGPU.
                visibility: match bind {
                    Bind::Write(_) => stages & !wgpu::ShaderStages::VERTEX,
                    _ => stages,
                },
                ty,
                count: None,
            })
            .collect();
        let layout = self
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &layout_entries,
            });
        let group_entries: Vec<_> = entries
            .iter()
            .zip(0..)
            .filter_map(|(bind, binding)| {
                let resource = bind.resource()?;
                Some(wgpu::BindGroupEntry { binding, resource })
            })
            .collect();
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

impl Bind<'_> {
    fn kind(&self) -> Option<wgpu::BindingType> {
        let buffer = |ty| wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let texture = |view: &wgpu::TextureView, float| {
            let texture = view.texture();
            wgpu::BindingType::Texture {
                sample_type: match texture.format().sample_type(None, None) {
                    Some(wgpu::TextureSampleType::Float { .. }) | None => float,
                    Some(other) => other,
                },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: texture.sample_count() > 1,
            }
        };
        let float = |filterable| wgpu::TextureSampleType::Float { filterable };
        let kind = match self {
            Self::None => return None,
            Self::Uniform(_) => buffer(wgpu::BufferBindingType::Uniform),
            Self::Read(_) => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
            Self::Write(_) => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
            Self::Texture(view) => texture(view, float(false)),
            Self::Image(view) => texture(view, float(true)),
            Self::Sampler(_) => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        };
        Some(kind)
    }

    fn resource(&self) -> Option<wgpu::BindingResource<'_>> {
        let resource = match self {
            Self::None => return None,
            Self::Uniform(b) | Self::Read(b) | Self::Write(b) => b.as_entire_binding(),
            Self::Sampler(s) => wgpu::BindingResource::Sampler(s),
            Self::Texture(v) | Self::Image(v) => wgpu::BindingResource::TextureView(v),
        };
        Some(resource)
    }
}
