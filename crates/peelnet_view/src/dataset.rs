//! The dataset that is looked into beside the picture.

use crate::{
    app::App,
    task::{Fallible, Job, computed},
};
use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use peelnet_bench::report::dataset::Grid;
use peelnet_dataset::Dataset;
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// An open dataset, and one of its views.
pub(crate) struct Looked {
    pub path: PathBuf,
    pub dataset: Arc<Dataset>,
    /// The view that is shown, as the number of its part.
    pub part: u32,
    pub view: Job<u32, View>,
    /// The cell that was clicked.
    pub cell: Option<[u32; 2]>,
}

/// A view made of its rows.
pub(crate) struct View {
    pub grid: Grid,
    pub picture: TextureHandle,
}

impl Looked {
    fn open(path: &Path) -> Fallible<Self> {
        let dataset = Dataset::open(path)?;
        let first = dataset.manifest().parts.iter().find(|part| part.rows > 0);
        Ok(Self {
            path: path.to_owned(),
            part: first.map_or(0, |part| part.index),
            dataset: Arc::new(dataset),
            view: Job::default(),
            cell: None,
        })
    }

    /// Begins to read the view that is shown, and takes one that was read.
    fn poll(&mut self, ui: &Context) {
        if self.view.wants(&self.part) {
            let (dataset, part, ui) = (Arc::clone(&self.dataset), self.part, ui.clone());
            self.cell = None;
            self.view.begin(part, async move {
                let read = move || Grid::read(&dataset, &dataset.manifest().parts[part as usize]);
                let grid = computed(read).await??;
                let image = grid.image();
                let size = [image.width(), image.height()].map(|side| side as usize);
                let image = ColorImage::from_rgb(size, image.as_raw());
                let picture = ui.load_texture("dataset", image, TextureOptions::NEAREST);
                Ok(View { grid, picture })
            });
        }
        self.view.poll(ui);
    }
}

impl App {
    /// Looks into a dataset; the one that is open stays where this one does not open.
    pub(crate) fn open_dataset(&mut self, path: &Path) {
        if let Some(looked) = self.messages.unless_error(Looked::open(path)) {
            self.dataset = Some(looked);
        }
    }

    pub(crate) fn poll_dataset(&mut self, ui: &Context) {
        self.dataset.iter_mut().for_each(|looked| looked.poll(ui));
    }

    /// Whether its view is being read.
    pub(crate) fn awaits_dataset(&self) -> bool {
        self.dataset
            .as_ref()
            .is_some_and(|looked| looked.view.get(&looked.part).is_none())
    }
}
