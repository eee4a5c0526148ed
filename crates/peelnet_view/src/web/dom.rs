//! Elements of the page around the canvas.

pub(super) fn element(id: &str) -> Option<web_sys::Element> {
    web_sys::window()?.document()?.get_element_by_id(id)
}

/// Shows a sentence over the page, or nothing.
pub(super) fn show_message(text: &str) {
    if let Some(element) = element("say") {
        element.set_text_content(Some(text));
    }
}
