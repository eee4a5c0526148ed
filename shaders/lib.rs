//! The text of every shader of peelnet, embedded.
//!
//! Each file is a WESL module: it imports others by path and switches parts with `@if(feature)`. The module
//! `peelnet_render::shaders` links them to plain WGSL.
//!
//! ```
//! let (path, text) = peelnet_shaders::SOURCES[0];
//! assert!(path.contains("::") && !text.is_empty());
//! ```

/// Module path (such as `methods::wboit::gather`) and text of every shader, sorted by path.
pub const SOURCES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/sources.rs"));
