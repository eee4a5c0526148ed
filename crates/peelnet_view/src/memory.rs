//! What the window remembers from one time to the next.

use std::path::PathBuf;

pub(crate) const RECENT: &str = "recent";

/// Scenes that were opened, the last one first.
pub(crate) fn load(storage: Option<&dyn eframe::Storage>) -> Vec<PathBuf> {
    let text = storage.and_then(|s| s.get_string(RECENT));
    let text = text.unwrap_or_default();
    let lines = text.lines().filter(|line| !line.is_empty());
    lines.map(PathBuf::from).collect()
}

/// A name with a line break is not remembered.
pub(crate) fn text(recent: &[PathBuf]) -> String {
    let names = recent.iter().filter_map(|p| p.to_str());
    let names: Vec<&str> = names.filter(|n| !n.contains('\n')).collect();
    names.join("\n")
}
