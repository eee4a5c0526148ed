//! The scenes that ship with peelnet, embedded. None of them reads another file.
//!
//! ```
//! let cups = peelnet_shipped_scenes::find("cups").expect("ships");
//! assert_eq!(cups.path, "data/scenes/cups.toml");
//! ```

/// A scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneFile {
    /// Name of the file without its ending, which is the scene's name.
    pub name: &'static str,
    /// Its path in the repository.
    pub path: &'static str,
    /// Its text, TOML.
    pub text: &'static str,
}

/// The suite that networks are trained and compared on, sorted by name.
pub const SCENES: &[SceneFile] = include!(concat!(env!("OUT_DIR"), "/scenes.rs"));

/// Scenes that show materials and other effects, sorted by name.
pub const EFFECTS: &[SceneFile] = include!(concat!(env!("OUT_DIR"), "/effects.rs"));

/// The designs of slabs that `peelnet bench designs` compares, TOML.
pub const DESIGNS: &str = include_str!("designs.toml");

/// The shipped scene of this name (`cups`) or path in the repository (`data/scenes/cups.toml`).
pub fn find(name: &str) -> Option<&'static SceneFile> {
    let mut all = SCENES.iter().chain(EFFECTS);
    all.find(|s| s.name == name || s.path == name)
}
