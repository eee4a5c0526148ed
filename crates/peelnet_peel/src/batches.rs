//! Rows as they are peeled, for programs that keep them in memory: the files of [`extract`](crate::extract()) hold the same rows.

use crate::{
    ExtractOptions, PeelError,
    extract::{Inbox, Message, ROWS_AT_A_TIME, peel, work},
    rows::{ViewConstants, append_rows},
};
use peelnet_dataset::FragmentBatch;
use peelnet_gpu::Gpu;
use peelnet_scene::Scene;
use std::{collections::VecDeque, thread::JoinHandle};

/// The rows of some scenes, batch by batch, while another thread peels. Dropping it ends the peeling.
#[derive(Debug)]
pub struct Batches {
    /// `None` once there is nothing more to come.
    inbox: Option<Inbox>,
    view: Option<ViewConstants>,
    ready: VecDeque<FragmentBatch>,
    peeling: Option<JoinHandle<()>>,
}

/// Peels scenes and returns their rows in the order of views, pixels and layers. Batches hold whole pixels: columns are slices, or
/// `ndarray` views by `ArrayView1::from(&batch.linear_depth)`. Folder, format and command of the options are not used.
///
/// # Errors
/// Scenes that lack views or share a name, or a fraction of pixels outside 0 … 1. What goes wrong later is the last item.
///
/// ```no_run
/// # fn rows(gpu: &peelnet_gpu::Gpu, scene: peelnet_scene::Scene) -> Result<(), peelnet_peel::PeelError> {
/// let options = peelnet_peel::ExtractOptions::new("");
/// for batch in peelnet_peel::batches(gpu, &[scene], &options)? {
///     let batch = batch?;
///     println!("{} rows, the first at depth {}", batch.len(), batch.linear_depth[0]);
/// }
/// # Ok(())
/// # }
/// ```
pub fn batches(
    gpu: &Gpu,
    scenes: &[Scene],
    options: &ExtractOptions,
) -> Result<Batches, PeelError> {
    let (_, mine) = work(scenes, options)?;
    let (gpu, scenes, options) = (gpu.clone(), scenes.to_vec(), options.clone());
    let (outbox, inbox) = Inbox::new();
    let peeling = std::thread::spawn(move || peel(&gpu, &scenes, &options, &mine, &outbox));
    Ok(Batches {
        inbox: Some(inbox),
        view: None,
        ready: VecDeque::new(),
        peeling: Some(peeling),
    })
}

impl Batches {
    /// Takes messages until there are rows, or nothing more comes.
    fn fill(&mut self) -> Result<(), PeelError> {
        while self.ready.is_empty() {
            let Some(message) = self.inbox.as_ref().and_then(Inbox::next) else {
                return Ok(());
            };
            match message {
                Message::Begin(info) => self.view = Some(ViewConstants::from(&info)),
                Message::Tile(tile) => {
                    // A tile comes behind the beginning of its view.
                    let Some(view) = self.view else { continue };
                    let mut rows = FragmentBatch::default();
                    let ready = &mut self.ready;
                    let counts = append_rows(&tile, view, &mut rows, ROWS_AT_A_TIME, |rows| {
                        ready.push_back(rows.clone());
                        Ok::<_, PeelError>(())
                    })?;
                    if let Some(inbox) = &self.inbox {
                        inbox.give_back(tile);
                    }
                    counts.check()?;
                }
                Message::End(_) => {}
                Message::Failed(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Ends the peeling, which finds nobody to send to.
    fn end(&mut self) -> std::thread::Result<()> {
        self.inbox = None;
        self.peeling.take().map_or(Ok(()), JoinHandle::join)
    }
}

impl Iterator for Batches {
    type Item = Result<FragmentBatch, PeelError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Err(error) = self.fill() {
            self.ready.clear();
            self.inbox = None;
            return Some(Err(error));
        }
        let next = self.ready.pop_front();
        if next.is_none()
            && let Err(panic) = self.end()
        {
            std::panic::resume_unwind(panic);
        }
        next.map(Ok)
    }
}

impl Drop for Batches {
    fn drop(&mut self) {
        // Whatever it came to, nobody asks any more.
        let _ = self.end();
    }
}
