//! The viewer of peelnet: every transparency method live, in a window and in a web page.
//!
//! It is an application of [`eframe`]. A frame of it goes like this:
//!
//! 1. What was begun earlier goes on: errors, times, the fragments of a pixel, the front of all methods. All of it is futures that are polled,
//!    because nothing may wait in a browser.
//! 2. Panels read and change what is shown: the scene, the camera, one or two methods, and how their pictures are compared.
//! 3. Each method draws its picture, in linear light, where anything changed. One more pass encodes it for the window, or makes a map of it.
//! 4. Once the view rests, it is measured against the exact image.
//!
//! A training has a thread and a graphics device of its own; a frame takes the newest network from it.
//!
//! Controls of methods are made from the methods' declarations ([`peelnet_render::METHODS`]): a new method or parameter appears by itself.

#![allow(missing_docs)]

mod address;
mod app;
mod compare;
#[cfg(not(target_arch = "wasm32"))]
mod dataset;
mod display;
mod eye;
mod front;
mod input;
mod inspect;
mod memory;
mod messages;
mod numbers;
mod panels;
mod saving;
mod script;
mod slot;
mod stage;
mod task;
#[cfg(test)]
mod tests;
#[cfg(not(target_arch = "wasm32"))]
mod training;
mod viewport;
mod watch;
#[cfg(target_arch = "wasm32")]
mod web;
#[cfg(not(target_arch = "wasm32"))]
mod window;

pub use address::camera_numbers;
pub use app::Start;
pub use compare::Mode;
pub use script::Script;
#[cfg(target_arch = "wasm32")]
pub use web::Page;
#[cfg(not(target_arch = "wasm32"))]
pub use window::open;

#[cfg(target_arch = "wasm32")]
use web::training;
