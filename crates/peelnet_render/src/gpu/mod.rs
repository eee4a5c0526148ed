//! The only module that chooses an adapter, opens a device and moves data to and from it.
//!
//! [`adapter`] lists what there is and picks one by a rule that `peelnet doctor` can explain; [`Gpu`] is an open
//! device with the optional features that we use where they exist; [`bind`] builds a bind group and its layout from
//! one list; [`record`] records passes with a timestamp at both ends of each; [`readback`] brings bytes home in
//! chunks of bounded size. Everything else is plain wgpu.

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
pub use error::GpuError;
pub use pipelines::{Kernel, RenderPipeline, groups_2d};
pub use wgpu;
