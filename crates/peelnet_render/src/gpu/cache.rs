//! Compiled pipelines, kept by all that decides them: a resize, a second scene or a second method compiles none anew.

use std::{collections::HashMap, sync::Mutex};

/// Entries of a bind group's layout.
pub type Layout = Vec<wgpu::BindGroupLayoutEntry>;

#[derive(Debug, Default)]
pub(crate) struct PipelineCache {
    /// By the text of all that decides them, which takes no time beside compiling.
    pub render: Mutex<HashMap<String, wgpu::RenderPipeline>>,
    /// By the shader's number.
    pub compute: Mutex<HashMap<(u32, Layout), wgpu::ComputePipeline>>,
}
