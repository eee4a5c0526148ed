//! The scenes that ship. They are embedded, so an installed program needs no folder beside it.

use crate::{error::SceneError, scene::Scene};
use peelnet_core::files::known_names;
use std::path::{Path, PathBuf};

pub use peelnet_shipped_scenes::{EFFECTS, SCENES, SceneFile, find};

/// Loads a shipped scene by its name.
///
/// ```
/// let cups = peelnet_scene::suite::load("cups")?;
/// assert_eq!(cups.views.len(), 3);
/// # Ok::<(), peelnet_scene::SceneError>(())
/// ```
///
/// # Errors
/// An unknown name; see also [`Scene::load`].
pub fn load(name: &str) -> Result<Scene, SceneError> {
    match find(name) {
        Some(file) => load_file(file, None),
        None => {
            let all: Vec<&str> = SCENES.iter().chain(EFFECTS).map(|s| s.name).collect();
            let known = known_names(name, &all);
            let message = format!("is no file and no shipped scene; {known}");
            Err(SceneError::file(Path::new(name), None, message))
        }
    }
}

/// Loads a scene file or, where there is no such file, the shipped scene of that name (`cups`) or of that path in the
/// repository (`data/scenes/cups.toml`), at a time of its timeline.
///
/// # Errors
/// See [`Scene::load_at`].
pub fn open(path: &Path, time: Option<f32>) -> Result<Scene, SceneError> {
    open_with(path, time, &[])
}

/// The same, see [`Scene::load_with`].
///
/// # Errors
/// See [`Scene::load_at`].
pub fn open_with(path: &Path, time: Option<f32>, folders: &[PathBuf]) -> Result<Scene, SceneError> {
    let shipped = path.to_str().and_then(find);
    // A folder that happens to have a scene's name, such as its dataset, is none.
    if path.exists() && !(path.is_dir() && shipped.is_some()) {
        return Scene::load_with(path, time, folders);
    }
    match shipped {
        Some(file) => load_file(file, time),
        // A single word without an ending was meant as a name.
        None if path.extension().is_none() && path.components().count() == 1 => {
            load(&path.to_string_lossy())
        }
        None => Scene::load_with(path, time, folders),
    }
}

/// Loads a shipped scene at a time of its timeline.
///
/// # Errors
/// See [`Scene::load_at`].
pub fn load_file(file: &SceneFile, time: Option<f32>) -> Result<Scene, SceneError> {
    // A shipped scene names no other file.
    Scene::from_bytes_at(file.path, time, |_| Ok(file.text.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the suite promises: every scene loads without a warning, shows something transparent in three views, and at least
    /// four of different kinds are held out.
    #[test]
    fn the_suite_is_what_it_promises() {
        let load = |file| load_file(file, None).expect("loads");
        let scenes: Vec<Scene> = SCENES.iter().map(load).collect();
        let mut names: Vec<_> = scenes.iter().map(|s| s.name.clone()).collect();
        names.dedup();
        assert_eq!(names.len(), scenes.len());
        for s in &scenes {
            assert_eq!(s.views.len(), 3, "{}", s.name);
            assert!(s.transparent_bounds().is_some(), "{}", s.name);
            assert!(s.warnings.is_empty(), "{}: {:?}", s.name, s.warnings);
            let file = s.source.file_stem().and_then(|n| n.to_str());
            assert_eq!(file, Some(&*s.name), "a scene is named after its file");
            if s.name.starts_with("sixteen") {
                assert_eq!(s.objects.len(), 16);
                for o in &s.objects {
                    let off = o.mesh.triangles.len() as f64 / 11_100.0 - 1.0;
                    assert!(off.abs() < 0.03, "{}: {}", s.name, o.mesh.triangles.len());
                }
            }
        }
        assert!(scenes.iter().filter(|s| s.held_out).count() >= 4);
        let shown = scenes.iter().filter(|s| !s.held_out);
        assert!(shown.filter(|s| s.name.starts_with("sixteen")).count() >= 6);
    }

    #[test]
    fn a_shipped_scene_has_a_name_and_a_path() {
        let named = load("cups").expect("ships");
        let by_path = open("data/scenes/cups.toml".as_ref(), None).expect("ships");
        assert_eq!(named.hash, by_path.hash);
        assert_eq!(named.source, Path::new("data/scenes/cups.toml"));
        for error in [load("nowhere"), open("nowhere".as_ref(), None)] {
            let error = error.expect_err("is not there");
            assert!(error.to_string().contains("nowhere"), "{error}");
        }
    }

    /// A file is meant where there is one, whatever ships under its name.
    #[test]
    fn files_win_over_names() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("cups");
        let text = find("boxes").expect("ships").text;
        std::fs::write(&file, text).expect("writes");
        assert_eq!(open(&file, None).expect("loads").name, "boxes");
    }

    #[test]
    fn variations_repeat_and_differ() {
        let s = &load("boxes").expect("ships");
        let same = |a: &Scene, b: &Scene| {
            a.views == b.views
                && a.objects.iter().zip(&b.objects).all(|(a, b)| {
                    a.materials == b.materials && a.world_from_object == b.world_from_object
                })
        };
        assert!(same(&s.varied(7, 0), s));
        assert!(same(&s.varied(7, 3), &s.varied(7, 3)));
        assert!(!same(&s.varied(7, 3), &s.varied(7, 4)));
        assert!(!same(&s.varied(7, 3), &s.varied(8, 3)));
        for copy in 1..20 {
            let v = s.varied(1, copy);
            for view in &v.views {
                assert!(view.near < view.far && view.view_from_world().is_finite());
            }
        }
    }
}
