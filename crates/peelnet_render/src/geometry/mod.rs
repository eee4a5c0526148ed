//! A scene on the GPU, and everything that finds its fragments: below both rendering and peeling.
//!
//! [`SceneBuffers::new`] uploads a scene's triangles once. A [`GeometryPass`] becomes one pipeline for each
//! [`MaterialFlags`](peelnet_scene::MaterialFlags) of material. On these stand the passes that more than one method, or the extraction, is
//! built of: [`count`], [`sbuffer`], [`depth_peel`], [`fullscreen`].

// What users of the facade see of this crate is documented; the rest where there is more to say than its name.
#![allow(missing_docs)]

mod blend;
mod boxes;
pub mod count;
pub mod depth_peel;
mod edit;
mod error;
pub mod fragments;
pub mod frame;
pub mod fullscreen;
pub mod long_runs;
mod maps;
mod mip_levels;
pub mod needs;
pub mod pipelines;
mod sample_point;
pub mod sbuffer;
mod scene;
pub mod sort;
mod splats;
mod uniforms;
mod upload;

pub use blend::Blend;
pub use boxes::BoxPass;
pub use error::RenderError;
pub use frame::{FrameTargets, OpaqueDepth};
pub use needs::Needs;
pub use pipelines::{GeometryPass, GeometryPipelines};
pub use sample_point::SamplePoint;
pub use scene::{BACKGROUND_PASS, SceneBuffers, Submission, shader_bytes};
pub use sort::{Order, Sorted};
pub use uniforms::PixelSample;
