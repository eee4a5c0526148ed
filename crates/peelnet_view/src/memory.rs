//! What the window remembers from one time to the next.

use std::path::PathBuf;

const RECENT: &str = "recent";

/// Scenes that were opened, the last one first.
pub(crate) fn load(storage: Option<&dyn eframe::Storage>) -> Vec<PathBuf> {
    let text = storage.and_then(|s| s.get_string(RECENT));
    let text = text.unwrap_or_default();
    let lines = text.lines().filter(|line| !line.is_empty());
    lines.map(PathBuf::from).collect()
}

pub(crate) fn save(storage: &mut dyn eframe::Storage, recent: &[PathBuf]) {
    storage.set_string(RECENT, text(recent));
}

/// A name with a line break is not remembered.
fn text(recent: &[PathBuf]) -> String {
    let names = recent.iter().filter_map(|p| p.to_str());
    let names: Vec<&str> = names.filter(|n| !n.contains('\n')).collect();
    names.join("\n")
}

/// At once: a page may be closed without a word.
#[cfg(target_arch = "wasm32")]
pub(crate) fn save_in_page(recent: &[PathBuf]) {
    let window = web_sys::window();
    if let Some(storage) = window.and_then(|w| w.local_storage().ok().flatten()) {
        // A browser that keeps nothing shows the first scene again.
        let _ = storage.set_item(RECENT, &text(recent));
    }
}
