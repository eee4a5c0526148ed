//! Compiled pipelines, kept by all that decides them: a resize, a second scene or a second method compiles none anew.

use crate::shaders::ShaderId;
use std::{collections::HashMap, sync::Mutex};

/// Entries of a bind group's layout.
pub type Layout = Vec<wgpu::BindGroupLayoutEntry>;

#[derive(Debug, Default)]
pub(crate) struct PipelineCache {
    pub render: Mutex<HashMap<RenderKey, wgpu::RenderPipeline>>,
    pub compute: Mutex<HashMap<(ShaderId, Layout), wgpu::ComputePipeline>>,
}

/// All that decides a render pipeline.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct RenderKey {
    pub shaders: [ShaderId; 2],
    pub layouts: Vec<Option<Layout>>,
    pub buffers: Vec<Option<(u64, wgpu::VertexStepMode, Vec<wgpu::VertexAttribute>)>>,
    pub targets: Vec<Option<wgpu::ColorTargetState>>,
    pub depth: Option<wgpu::DepthStencilState>,
    pub samples: u32,
    pub culled: Option<wgpu::Face>,
}
