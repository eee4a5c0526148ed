//! Scenes: read from TOML files or mesh files, or built in code.
//!
//! [`Scene::load`] reads a scene file ([`mod@file`]): cameras, lights, and objects, which are meshes of files (OBJ, glTF,
//! PLY, STL) or of Gaussian splats (PLY, SPLAT, SPZ, glTF), generated shapes, or many of either scattered from a seed.
//! [`Scene::from_bytes`] reads the same through a function, so that an archive, a web page or a test can be the file system.
//! Everything is resolved and checked here: a renderer meets no missing normal, no index out of range and no NaN.
//!
//! All types are `Clone` and `Send`. A renderer, or a program that moves things, addresses `scene.objects[i]`: its
//! `world_from_object`, its `materials` (one for each part of its mesh), and `scene.lights`. Meshes and textures are shared by `Arc`, so
//! clones of a scene are cheap.
//!
//! ```
//! use peelnet_scene::{Scene, suite};
//!
//! let mut scene: Scene = suite::load("cups")?;
//! scene.objects[0].world_from_object *= glam::Mat4::from_rotation_y(0.5);
//! scene.objects[0].materials[0].alpha = 0.25;
//! # Ok::<(), peelnet_scene::SceneError>(())
//! ```
//!
//! [`Scene::varied`] draws variations for training; [`suite`] finds the scenes that ship.

mod budget;
mod camera;
mod displacement;
mod effects;
mod error;
mod features;
pub mod file;
mod files;
mod import;
mod material;
mod mesh;
mod parameters;
mod pattern;
mod scatter;
mod scene;
mod shapes;
mod specular_glossiness;
mod splats;
pub mod suite;
mod texture;
mod vary;
mod warnings;

pub use budget::MAX_LIGHTS;
pub use camera::Camera;
pub use effects::{EFFECTS, Effect, MaterialFlags};
pub use error::SceneError;
pub use features::{SceneFeature, SceneFeatures};
pub use material::{Control, Lighting, Material, NUMBERS, Number, SHADER_NUMBERS};
pub use mesh::{BOX_MARGIN, Mesh, Part};
pub use scene::{Blending, Light, Object, Scene, Source, State};
pub use splats::{CONSTANT_HARMONIC, FAINTEST, Splats, harmonics_of};
pub use texture::{Displacement, Maps, Texture, Wrap};
