//! Learned order-independent transparency: draw scenes with every published method, peel them into datasets of
//! fragments, train small networks on those, export the networks as shader text, and measure what each method costs.
//!
//! This crate gathers the parts. Each is a crate of its own and can be used alone:
//!
//! | here | crate | for |
//! |---|---|---|
//! | [`Scene`], [`scene`] | `peelnet_scene` | TOML, glTF, OBJ, PLY, STL and Gaussian splat files, generated meshes, cameras, shipped scenes |
//! | [`Gpu`], [`Renderer`], [`render`] | `peelnet_render` | an adapter and a device, drawing a scene with any method |
//! | [`peel`] | `peelnet_peel` | every fragment of a scene as a row |
//! | [`dataset`] | `peelnet_dataset` | reading those rows: Parquet, CSV and NPY |
//! | [`Model`], [`model`] | `peelnet_model` | model files; [`Model::shipped`] has the shipped networks |
//! | [`train`] | `peelnet_train` | networks from datasets (feature `train`) |
//! | [`export`] | `peelnet_export` | a network as verified WGSL |
//! | [`mod@bench`] | `peelnet_bench` | errors against the exact image, times, stress cases; their pages, charts and tables |
//! | [`shipped_networks`] | `peelnet_shipped_networks` | model files and WGSL of the shipped networks, embedded |
//!
//! # Use
//!
//! A network as text for a shader of your own needs no GPU and no file:
//!
//! ```
//! use peelnet::{Model, Recipe, export};
//!
//! let model = Model::shipped(Recipe::MEDIUM)?;
//! let text = export::wgsl(&model)?;
//! assert!(text.contains("fn peelnet_fragment"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Rows of a shipped scene, on whatever adapter there is:
//!
//! ```no_run
//! use peelnet::{AdapterRequest, Gpu, dataset::Dataset, peel, scene::suite};
//! use std::sync::atomic::AtomicBool;
//!
//! let gpu = Gpu::open(&AdapterRequest::Auto)?;
//! let options = peel::ExtractOptions::new("rows");
//! let stop = AtomicBool::new(false);
//! peel::extract(&gpu, &[suite::load("cups")?], &options, &stop, &mut |_| ())?;
//! println!("{} rows", Dataset::open("rows")?.rows());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A frame onto a texture of one's own, encoded and not yet submitted:
//!
//! ```no_run
//! use peelnet::{AdapterRequest, Gpu, MethodOptions, Renderer, Target, scene::suite};
//! # fn view() -> peelnet::gpu::wgpu::TextureView { unimplemented!() }
//!
//! let gpu = Gpu::open(&AdapterRequest::Auto)?; // or Gpu::from_parts, with a device of one's own
//! let scene = suite::load("cups")?;
//! let renderer = Renderer::new(&gpu, &scene)?;
//! let mut method = renderer.method(&"mboit4".parse()?, MethodOptions::default())?;
//! let mut encoder = gpu.encoder();
//! let view = view();
//! renderer.draw(&mut encoder, &mut method, &scene.views[0], &Target::over(&view))?;
//! gpu.queue.submit([encoder.finish()]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The folder `examples/` holds whole programs: rows as `ndarray` arrays, training and export, drawing a glTF file, and
//! an exported network in a wgpu program that uses no renderer of this crate.
//!
//! # Features
//!
//! - `cli` (default): the program `peelnet` and what only it needs. Libraries turn default features off.
//! - `train`: [`train`], and with it burn, which takes the longest to compile. Part of `cli`.

mod failure;
#[cfg(feature = "train")]
pub mod fit;
#[cfg(feature = "train")]
pub mod loss_curve;
mod names;
mod networks;

use peelnet_core::files::{counted, printable};

pub use failure::Failure;
#[cfg(feature = "train")]
pub use names::SCHEDULES;
pub use names::{LANGUAGES, PRECISIONS, SPLITS, named};
pub use networks::{Compared, check_model_place, load_model, model_for, save_model, weight_of};

/// A view of a scene, from 0.
///
/// # Errors
/// A number that the scene does not have.
pub fn view_of(scene: &Scene, view: u32) -> Result<&Camera, Failure> {
    scene.views.get(view as usize).ok_or_else(|| {
        let views = counted(scene.views.len() as u64, "view");
        let name = printable(&scene.name);
        Failure::wrong(format!("view {view}: {name} has {views}, numbered from 0"))
    })
}

#[doc(inline)]
pub use peelnet_model::{Model, Recipe};
#[doc(inline)]
pub use peelnet_render::gpu::{AdapterRequest, Gpu};
#[doc(inline)]
pub use peelnet_render::{FrameStatus, LearnedWeight, MethodOptions, MethodSpec, Renderer, Target};
#[doc(inline)]
pub use peelnet_scene::{Camera, Scene};

pub use peelnet_bench as bench;
pub use peelnet_dataset as dataset;
pub use peelnet_export as export;
pub use peelnet_model as model;
pub use peelnet_peel as peel;
pub use peelnet_render as render;
pub use peelnet_render::gpu;
pub use peelnet_scene as scene;
pub use peelnet_shipped_networks as shipped_networks;
#[cfg(feature = "train")]
pub use peelnet_train as train;
