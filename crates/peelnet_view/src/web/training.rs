//! Training in a page: there is none.

use crate::app::App;
use egui::{Context, Ui};
use peelnet_model::Recipe;

#[derive(Default)]
pub(crate) struct Training {
    pub failure: Option<String>,
}

impl Training {
    pub const fn abandon(&mut self) {}

    pub const fn text(&self) -> Option<String> {
        None
    }
}

impl App {
    pub(crate) const fn begin_training(&mut self, _: &Context, _: Option<Recipe>) {}

    pub(crate) const fn poll_training(&mut self, _: &Context) {}

    pub(crate) const fn awaits_training(&self) -> bool {
        false
    }
}

pub(crate) fn show(_: &mut App, ui: &mut Ui) {
    ui.weak(
        "Only the window trains (peelnet view): training needs threads and files, and a page has none.",
    );
}
