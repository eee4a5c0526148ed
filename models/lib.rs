//! The networks that ship with peelnet, embedded.
//!
//! Their table, what each is good for and how they were made stand in the README of this folder. `peelnet_model` reads
//! the model files; the exported WGSL can be pasted into any shader.
//!
//! ```
//! let medium = peelnet_shipped_networks::find("medium").expect("ships");
//! assert!(medium.wgsl.contains("fn peelnet_weight"));
//! ```

/// A trained network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shipped {
    /// The recipe that made it, which is the name of its folder.
    pub name: &'static str,
    /// The bytes of `model.safetensors`.
    pub file: &'static [u8],
    /// The text of `model.wgsl`: the exported and verified shader functions.
    pub wgsl: &'static str,
    /// The text of `model.json`: what the header of `model.wgsl` says, for programs.
    pub json: &'static str,
}

/// Every shipped network, sorted by name.
pub const MODELS: &[Shipped] = include!(concat!(env!("OUT_DIR"), "/models.rs"));

/// The shipped network of a recipe.
pub fn find(name: &str) -> Option<&'static Shipped> {
    MODELS.iter().find(|m| m.name == name)
}
