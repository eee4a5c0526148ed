//! The scenes that ship, in `data/scenes`.

use crate::{Scene, SceneError};
use std::path::{Path, PathBuf};

/// The folder `data/scenes`, here or in a folder above, or in the sources this was built from.
///
/// # Errors
/// [`SceneError::NoSuite`] where there is none.
pub fn directory() -> Result<PathBuf, SceneError> {
    let start = std::env::current_dir().unwrap_or_default();
    start
        .ancestors()
        .chain(Path::new(env!("CARGO_MANIFEST_DIR")).ancestors())
        .map(|f| f.join("data").join("scenes"))
        .find(|f| f.is_dir())
        .ok_or(SceneError::NoSuite { start })
}

/// All scene files of a folder, by name.
///
/// # Errors
/// A folder that cannot be read.
pub fn scenes(folder: &Path) -> Result<Vec<PathBuf>, SceneError> {
    let failed = |source| SceneError::Read {
        path: folder.to_owned(),
        source,
    };
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|e| e == "toml") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// Loads the whole suite.
///
/// # Errors
/// The first scene that does not load.
pub fn load_all() -> Result<Vec<Scene>, SceneError> {
    scenes(&directory()?)?
        .iter()
        .map(|p| Scene::load(p))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the suite promises: every scene loads without a warning, shows something transparent in three views, and at least
    /// four of different kinds are held out.
    #[test]
    fn the_suite_is_what_it_promises() {
        let scenes = load_all().expect("loads");
        let mut names: Vec<_> = scenes.iter().map(|s| s.name.clone()).collect();
        names.dedup();
        assert_eq!(names.len(), scenes.len());
        for s in &scenes {
            assert_eq!(s.views.len(), 3, "{}", s.name);
            assert!(s.transparent_bounds().is_some(), "{}", s.name);
            assert!(s.warnings.is_empty(), "{}: {:?}", s.name, s.warnings);
            assert_eq!(
                s.source.file_stem().and_then(|n| n.to_str()),
                Some(s.name.as_str()),
                "a scene is named after its file"
            );
            if s.name.starts_with("sixteen") {
                assert_eq!(s.objects.len(), 16);
                for o in &s.objects {
                    let off = o.mesh.triangles.len() as f64 / 11_100.0 - 1.0;
                    assert!(off.abs() < 0.03, "{}: {}", s.name, o.mesh.triangles.len());
                }
            }
        }
        assert!(scenes.iter().filter(|s| s.held_out).count() >= 4);
        assert!(
            scenes
                .iter()
                .filter(|s| s.name.starts_with("sixteen") && !s.held_out)
                .count()
                >= 6
        );
    }

    #[test]
    fn variations_repeat_and_differ() {
        let scenes = load_all().expect("loads");
        let s = &scenes[0];
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
