//! Draws a scene with every transparency method.
//!
//! How a frame is drawn: [`Renderer::new`] puts the scene's triangles on the GPU once, in world space and in one
//! buffer. [`Renderer::method`] makes a method ready: its pipelines, its targets. Then either
//!
//! - [`Renderer::draw`] encodes a frame onto a texture of the caller's, over what it holds: no submission, no wait, no read-back. Methods
//!   that must know how many fragments there are take the counts of an earlier frame; or
//! - [`Renderer::image`] draws a frame of its own, waits, repeats it where it was too small, and reads it back; or
//! - [`Renderer::profile`] draws it for its time alone, onto a target as an engine's.
//!
//! Each draws opaque objects over the background colour first, which gives `C_0` and a depth buffer, then lets the method composite all
//! transparent fragments over `C_0`: in one unordered pass ([`methods`] that commute), by peeling, or by storing and sorting. Everything is
//! linear light in 32-bit floats; [`Image`] encodes for display.
//!
//! ```no_run
//! use peelnet_render::gpu::{AdapterRequest, Gpu};
//! use peelnet_render::{MethodOptions, Renderer};
//! # fn draw(scene: &peelnet_scene::Scene) -> Result<(), Box<dyn std::error::Error>> {
//! let gpu = Gpu::open(&AdapterRequest::Auto)?;
//! let renderer = Renderer::new(&gpu, scene)?;
//! let mut method = renderer.method(&"mboit4".parse()?, MethodOptions::sized([640, 480]))?;
//! renderer.image(&mut method, &scene.views[0])?.image.save("image.png".as_ref())?;
//! # Ok(())
//! # }
//! ```

mod frame;
pub mod geometry;
pub mod gpu;
mod image;
pub mod methods;
pub mod passes;
mod pixel;
mod renderer;
pub mod shaders;
mod target;
mod whole;

pub use crate::geometry::{Order, PixelSample, RenderError, Submission, shader_bytes};
pub use frame::{Frame, Profile, milliseconds, of_method};
pub use image::{Image, ImageFormat};
pub use methods::{KnownFailure, METHODS, Method, MethodSpec, Property, role};
pub use passes::{
    compositor::FrameStats,
    views::{LayerFormula, LayerView},
};
pub use pixel::PixelFragment;
pub use renderer::{Prepared, Renderer};
pub use target::{FrameStatus, LearnedWeight, MethodOptions, Target};
