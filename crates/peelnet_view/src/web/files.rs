//! Files that come into a page and leave it.

use crate::{stage::Files, task::Fallible};
use egui::{DroppedFileHandle, Ui};
use peelnet_core::files::shown;
use std::path::Path;
use wasm_bindgen::{JsCast as _, JsValue};

/// Bytes that are read at once: a page has 4 GiB of memory, and a scene needs several times the size of its file.
const MOST: f64 = 512.0 * 1024.0 * 1024.0;

pub(super) async fn read(dropped: Vec<DroppedFileHandle>) -> Fallible<Files> {
    let sizes = dropped.iter().filter_map(|file| file.web_file());
    let bytes: f64 = sizes.map(|file| file.size()).sum();
    if bytes > MOST {
        let [found, most] = [bytes, MOST].map(|bytes| bytes / (1 << 20) as f64);
        return Err(format!(
            "{found:.0} MiB were dropped: a page opens at most {most:.0} MiB; the window of peelnet view opens more"
        )
        .into());
    }
    let mut files = Files::new();
    for file in dropped {
        let read = file.bytes_async().await.map_err(|e| {
            let name = shown(file.path());
            format!("{name}: the browser cannot read it: {e}")
        })?;
        files.insert(file.path().to_owned(), read);
    }
    Ok(files)
}

/// A button that has the browser ask for files; the page hands them to [`super::Page::give`].
pub(crate) fn choose_files(ui: &mut Ui) {
    ui.label("Drop files onto the page, or");
    if ui.button("Choose files").clicked() {
        let input = super::dom::element("files");
        if let Some(input) = input.and_then(|i| i.dyn_into::<web_sys::HtmlElement>().ok()) {
            input.click();
        }
        ui.close();
    }
    ui.separator();
}

/// Hands a file to the browser, which puts it among the downloads.
pub(crate) fn download(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let name = path.to_string_lossy().replace('/', "-");
    let handed = handed(&name, bytes);
    handed.map_err(|e| format!("{}: the browser does not take it: {e:?}", shown(path)))
}

fn handed(name: &str, bytes: &[u8]) -> Result<(), JsValue> {
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
    let blob = web_sys::Blob::new_with_u8_array_sequence(&parts)?;
    let url = web_sys::Url::create_object_url_with_blob(&blob)?;
    let document = web_sys::window().and_then(|w| w.document());
    let link = document.ok_or("no document")?.create_element("a")?;
    let link: web_sys::HtmlAnchorElement = link.dyn_into().map_err(|_| "no link")?;
    link.set_href(&url);
    link.set_download(name);
    link.click();
    web_sys::Url::revoke_object_url(&url)
}
