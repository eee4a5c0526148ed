//! The only module that chooses an adapter, opens a device and moves data to and from it. Everything else is plain wgpu.

pub mod adapter;
pub mod bind;
pub mod cache;
mod device;
mod error;
mod pipelines;
pub mod readback;
pub mod record;

pub use adapter::{AdapterRequest, OptionalFeature};
pub use device::Gpu;
pub(crate) use device::locked;
pub use error::GpuError;
pub use pipelines::{Kernel, RenderPipeline, groups_2d};
pub use wgpu;
