//! Rows as they are peeled, for programs that keep them in memory: the files of [`extract`](crate::extract()) hold the same rows.

use crate::{
    ExtractOptions, PeelError,
    extract::{Outbox, peel, stream},
    items::shard_items,
};
use peelnet_dataset::{FragmentBatch, Part};
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
        let peeled = peel_rows(&gpu, &scenes, &options, mine, |_, rows| {
            let sent = send.send(Ok(rows.clone()));
            sent.map_err(|_| PeelError::Interrupted)
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

/// Peels these parts, hands their rows to `each` piece by piece, and returns the parts with what [`extract`](crate::extract()) would record of
/// them but files. Pieces hold whole pixels. Nothing is written.
///
/// # Errors
/// As [`batches`], and those of `each`, which end it.
pub fn peel_rows(
    gpu: &Gpu,
    scenes: &[Scene],
    options: &ExtractOptions,
    parts: Vec<Part>,
    mut each: impl FnMut(&Part, &FragmentBatch) -> Result<(), PeelError>,
) -> Result<Vec<Part>, PeelError> {
    let make = |outbox: &Outbox| peel(gpu, scenes, options, parts, outbox);
    let mut peeled = Vec::new();
    stream(make, |mut feed| {
        while let Some(mut part) = feed.part() {
            let mut pixels = 0;
            let (_, counts) = feed.rows(&part, |rows| {
                pixels += rows.pixels().count() as u64;
                each(&part, rows)
            })?;
            (part.rows, part.pixels) = (counts.rows, pixels);
            (part.lost_fragments, part.coplanar_ties) = (counts.lost, counts.coplanar);
            peeled.push(part);
        }
        Ok(())
    })?;
    Ok(peeled)
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
