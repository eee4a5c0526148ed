//! Rows as they are peeled, for programs that keep them in memory: the files of [`extract`](crate::extract()) hold the same rows.

use crate::{
    ExtractOptions, PeelError,
    extract::{Outbox, peel, stream},
    items::shard_items,
};
use peelnet_dataset::FragmentBatch;
use peelnet_render::gpu::Gpu;
use peelnet_scene::Scene;
use std::{
    sync::mpsc::{Receiver, sync_channel},
    thread::JoinHandle,
};

/// The rows of some scenes, batch by batch, while other threads peel. Dropping it ends the peeling.
#[derive(Debug)]
pub struct Batches {
    /// `None` once this is dropped.
    rows: Option<Receiver<Result<FragmentBatch, PeelError>>>,
    peeling: Option<JoinHandle<()>>,
}

/// Peels scenes and returns their rows in the order of views, pixels and layers. Batches hold whole pixels: columns are slices, or
/// `ndarray` views by `ArrayView1::from(&batch.linear_depth)`. Folder, format and command of the options are not used.
///
/// # Errors
/// Scenes that lack views or share a name, or a fraction of pixels outside 0 … 1. What goes wrong later is the last item.
///
/// ```no_run
/// # fn rows(gpu: &peelnet_render::gpu::Gpu, scene: peelnet_scene::Scene) -> Result<(), peelnet_peel::PeelError> {
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
    let mine = shard_items(scenes, options)?;
    let (gpu, scenes, options) = (gpu.clone(), scenes.to_vec(), options.clone());
    let (send, rows) = sync_channel(1);
    let peeling = std::thread::spawn(move || {
        let make = |outbox: &Outbox| peel(&gpu, &scenes, &options, mine, outbox);
        let peeled = stream(make, |mut feed| {
            while let Some(part) = feed.part() {
                feed.rows(&part, |rows| {
                    let sent = send.send(Ok(rows.clone()));
                    sent.map_err(|_| PeelError::Interrupted)
                })?;
            }
            Ok(())
        });
        if let Err(error) = peeled {
            // Nobody may ask any more.
            let _ = send.send(Err(error));
        }
    });
    Ok(Batches {
        rows: Some(rows),
        peeling: Some(peeling),
    })
}

impl Iterator for Batches {
    type Item = Result<FragmentBatch, PeelError>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.rows.as_ref()?.recv().ok();
        if next.is_none()
            && let Some(Err(panic)) = self.peeling.take().map(JoinHandle::join)
        {
            std::panic::resume_unwind(panic);
        }
        next
    }
}

impl Drop for Batches {
    fn drop(&mut self) {
        // The peeling finds nobody to send to, and ends.
        self.rows = None;
        let _ = self.peeling.take().map(JoinHandle::join);
    }
}
