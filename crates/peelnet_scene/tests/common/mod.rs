//! Scenes of files in memory.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_scene::{Scene, SceneError};
use std::{io, path::Path};

/// A PNG image of one colour, a texel high.
pub fn image(width: u32, texel: [u8; 4]) -> Vec<u8> {
    let mut bytes = io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_pixel(width, 1, image::Rgba(texel));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A scene of files in memory, of which the first is loaded.
pub fn load_at(files: &[(&str, &[u8])], time: Option<f32>) -> Result<Scene, SceneError> {
    Scene::from_bytes_at(files[0].0, time, |path| {
        let found = files.iter().find(|(name, _)| Path::new(name) == path);
        let found = found.ok_or_else(|| io::Error::from(io::ErrorKind::NotFound));
        found.map(|(_, bytes)| bytes.to_vec())
    })
}

pub fn load_files(files: &[(&str, &[u8])]) -> Result<Scene, String> {
    load_at(files, None).map_err(|e| e.to_string())
}

/// `words`, between ` & `, are in the error.
pub fn assert_refused(loaded: Result<Scene, String>, what: &str, words: &str) {
    let e = loaded.map(|_| ()).expect_err(what);
    for word in words.split(" & ") {
        assert!(e.contains(word), "{what}\ngives: {e}\nwithout: {word}");
    }
    assert!(!e.contains(char::is_control), "{e:?}");
}
