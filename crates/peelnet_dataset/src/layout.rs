//! Names of a dataset's files.

/// The folder of everything that is not rows. Its name begins with `_`: readers of whole folders skip it.
pub(crate) const META: &str = "_peelnet";
/// What all writers agree on.
pub(crate) const PLAN: &str = "_peelnet/plan.json";
/// The manifest of a sealed dataset.
pub(crate) const MANIFEST: &str = "_peelnet/manifest.json";
/// The records of finished parts.
pub(crate) const PARTS: &str = "_peelnet/parts/";
/// The manifest of schema 1, at the top.
pub(crate) const OLD_MANIFEST: &str = "manifest.json";
/// Prefix of all parts' file names.
pub(crate) const FRAGMENTS: &str = "fragments-";

/// The name of a part's record.
pub(crate) fn record(index: u32) -> String {
    format!("{PARTS}{index:05}.json")
}

/// The part whose record has this name, without the folder.
pub(crate) fn record_index(name: &str) -> Option<u32> {
    let index: u32 = name.strip_suffix(".json")?.parse().ok()?;
    (record(index).strip_prefix(PARTS) == Some(name)).then_some(index)
}

/// The part that a file of rows belongs to, by its name.
pub(crate) fn part_index(name: &str) -> Option<u32> {
    let (digits, _) = name.strip_prefix(FRAGMENTS)?.split_once('-')?;
    let index: u32 = digits.parse().ok()?;
    (format!("{index:05}") == digits).then_some(index)
}

/// Whether a name is a file of rows. Names come from outside: they must not lead out of the folder on any system.
pub(crate) fn is_part_name(name: &str) -> bool {
    name.starts_with(FRAGMENTS)
        && !name.contains(|c: char| c.is_control() || matches!(c, '/' | '\\' | ':'))
}
