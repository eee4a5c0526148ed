//! A scene on the GPU, and everything that finds its fragments: below both rendering and peeling.
//!
//! [`SceneBuffers::new`] uploads a scene's triangles once, in world space and in one buffer. A [`GeometryPass`] becomes one
//! pipeline for each [`MaterialFlags`](peelnet_scene::MaterialFlags) of material, specialised to what the pass reads. [`FrameTargets`] are
//! the targets of one frame size. On top of these stand the passes that more than one method, or the extraction, is built of:
//! [`count`] (fragments per pixel and their prefix sum), [`sbuffer`] (every fragment stored and sorted), [`single`] and
//! [`dual`] (depth peeling), [`fullscreen`].
//!
//! Transparent passes have no fixed-function depth test. One shader function compares with the opaque depth, because
//! storage writes of a fragment shader happen before that test; it exists only in frames that have opaque depth.

// What users of the facade see of this crate is documented; the rest where there is more to say than its name.
#![allow(missing_docs)]

mod blend;
mod boxes;
pub mod count;
pub mod dual;
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
pub mod single;
pub mod sort;
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
