//! Files that never end, or that nobody writes into: each is refused with its name, before it is read.

#![cfg(unix)]
use crate::scene_files::{room, write_room};
use peelnet_scene::Scene;
use std::{fs, os::unix::fs::symlink, path::Path, process::Command};

/// Puts something that is no file to read at a path.
type Put = fn(&Path);

const ENDLESS: [Put; 2] = [
    |path| symlink("/dev/zero", path).unwrap(),
    |path| assert!(Command::new("mkfifo").arg(path).status().unwrap().success()),
];

/// Whichever file of a scene it is, an error says so or, where loading goes on without the file, a warning.
#[test]
fn files_that_never_end_are_refused_by_name() {
    for (name, _) in room() {
        for put in ENDLESS {
            let folder = write_room();
            let path = folder.path().join(name);
            fs::remove_file(&path).unwrap();
            put(&path);
            let said = match Scene::load(folder.path().join("room/scene.toml")) {
                Ok(scene) => scene.warnings.join("\n"),
                Err(e) => e.to_string(),
            };
            // A glTF file's names are percent-encoded.
            let said = said.replace("%20", " ");
            let file = path.file_name().unwrap().to_str().unwrap();
            let is_named = said.contains(file) && said.contains("not a regular file");
            assert!(is_named, "{name}: {said}");
        }
    }
}
