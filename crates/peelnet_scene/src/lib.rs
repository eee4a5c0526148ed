//! What is drawn: scenes, read from TOML files or made by code.
//!
//! [`Scene::load`] reads a strict scene file ([`mod@file`]): cameras, lights, and objects that are OBJ meshes ([`obj`]),
//! generated shapes ([`shapes`]) or many of either scattered from a seed ([`scatter`]). Everything a scene is made of
//! is resolved and checked here, so that a renderer meets no missing normal, no index out of range and no NaN.
//! [`Scene::varied`] draws variations for training; [`suite`] finds the scenes that ship.

mod camera;
pub mod census;
mod error;
pub mod file;
pub mod files;
pub mod gltf;
mod material;
mod mesh;
pub mod obj;
pub mod pattern;
mod polygons;
pub mod scatter;
mod scene;
pub mod shapes;
pub mod suite;
mod texture;
mod vary;

pub use camera::Camera;
pub use census::{Census, Effect, Setting, Variant};
pub use error::SceneError;
pub use material::{Lighting, Material};
pub use mesh::{Mesh, Part};
pub use scene::{Light, Object, Scene, Source, State};
pub use texture::{Maps, Texture, Wrap};
