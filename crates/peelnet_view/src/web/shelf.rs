//! The scene that was dropped last. The page's script keeps it in the browser, so that a reload shows it again.

use crate::stage::{Files, Source};
use peelnet_scene::suite;
use std::{
    cell::RefCell,
    path::{Path, PathBuf},
    sync::Arc,
};
use wasm_bindgen::JsValue;

/// The scene that the browser keeps, and how it is replaced.
pub(super) struct Shelf {
    kept: RefCell<Option<(PathBuf, Arc<Files>)>>,
    /// Called with the scene's name, and the names and bytes of its files.
    keep: js_sys::Function,
}

impl Shelf {
    /// `scene` is the name of the kept scene, empty if there is none.
    pub fn new(scene: String, files: Files, keep: js_sys::Function) -> Self {
        let kept = (!scene.is_empty()).then(|| (scene.into(), files.into()));
        Self {
            kept: RefCell::new(kept),
            keep,
        }
    }

    /// Whether a name can be opened: that of a shipped scene, or of the kept one.
    pub fn has(&self, path: &Path) -> bool {
        let is_kept = || matches!(&*self.kept.borrow(), Some((name, _)) if name == path);
        path.to_str().and_then(suite::find).is_some() || is_kept()
    }

    pub fn source(&self, path: PathBuf) -> Source {
        let kept = self.kept.borrow();
        let kept = kept.as_ref().filter(|(name, _)| *name == path);
        Source {
            dropped: kept.map(|(_, files)| Arc::clone(files)),
            ..Source::named(path)
        }
    }

    /// Keeps a dropped scene in place of the last one; whether it was another one.
    pub fn put(&self, source: &Source) -> bool {
        let Source { path, dropped, .. } = source;
        let Some(files) = dropped else {
            return false;
        };
        let same = |(name, old): &(PathBuf, Arc<Files>)| name == path && Arc::ptr_eq(old, files);
        if self.kept.borrow().as_ref().is_some_and(same) {
            return false;
        }
        *self.kept.borrow_mut() = Some((path.clone(), Arc::clone(files)));
        let (names, contents) = (js_sys::Array::new(), js_sys::Array::new());
        for (name, bytes) in files.iter() {
            names.push(&name.to_string_lossy().as_ref().into());
            contents.push(&js_sys::Uint8Array::from(bytes.as_slice()));
        }
        let scene = path.to_string_lossy().as_ref().into();
        // It says itself what goes wrong.
        let _ = self.keep.call3(&JsValue::NULL, &scene, &names, &contents);
        true
    }
}
