pub(crate) use crate::rows::tests::row;

use crate::Machine;
use crate::report::{Measurement, Results};
use serde::de::DeserializeOwned;
use serde_json::json;
use std::path::Path;

pub(crate) fn machine() -> Machine {
    Machine {
        cpu: "a <fast> one".into(),
        ..Machine::default()
    }
}

/// Writes results into a folder, which then holds these files and maybe folders, reads them again, and returns the page, or where there is
/// none the table.
pub(crate) fn written<T: Measurement + DeserializeOwned>(
    folder: &Path,
    results: &Results<T>,
) -> String {
    results.write(folder).expect("writes");
    let files = Results::<T>::files();
    let find = |ending: &str| files.iter().find(|name| name.ends_with(ending));
    let json = folder.join(find(".json").expect("results"));
    let read = Results::<T>::read(&json).expect("reads");
    assert_eq!(json!(read), json!(results));
    let page = find(".html").or_else(|| find(".md"));
    let page = folder.join(page.expect("a page or a table"));
    let text = std::fs::read_to_string(page).expect("reads");
    for entry in std::fs::read_dir(folder).expect("lists") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            continue;
        }
        let name = path.file_name().and_then(|n| n.to_str()).expect("a name");
        assert!(files.contains(&name), "{name}");
        let kind = crate::report::kind_of(name);
        assert!(!kind.is_foreign(&path).expect("reads"), "{name}");
        if name.ends_with(".md") {
            // However long the table is.
            let text = std::fs::read(&path).expect("reads");
            assert!((kind.is)(&text[..text.len().min(64)]), "{name}");
        }
        std::fs::write(&path, "a user's own").expect("writes");
        assert!(kind.is_foreign(&path).expect("reads"), "{name}");
    }
    text
}
