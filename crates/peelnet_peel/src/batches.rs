//! Rows as they are peeled, for programs that keep them in memory: the files of [`extract`](crate::extract()) hold the same rows.

use crate::{
    ExtractOptions, PeelError,
    extract::{Effort, Message, ROWS_AT_A_TIME, peel, work},
    rows::{ViewConstants, append_rows},
};
use peelnet_dataset::FragmentBatch;
use peelnet_gpu::Gpu;
use peelnet_scene::Scene;
use std::{
    collections::VecDeque,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender, channel, sync_channel},
    },
    thread::JoinHandle,
};

/// The rows of some scenes, batch by batch, while another thread peels. Dropping it ends the peeling.
#[derive(Debug)]
pub struct Batches {
    receive: Receiver<Message>,
    give_back: Sender<crate::rows::RawTile>,
    view: Option<ViewConstants>,
    ready: VecDeque<FragmentBatch>,
    peeling: Option<JoinHandle<Result<(), PeelError>>>,
    stop: Arc<AtomicBool>,
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
    let stop = Arc::new(AtomicBool::new(false));
    let (send, receive) = sync_channel(1);
    let (give_back, take) = channel();
    let stopped = Arc::clone(&stop);
    let peeling = std::thread::spawn(move || {
        let mut effort = Effort::default();
        peel(
            &gpu,
            &scenes,
            &options,
            &mine,
            &stopped,
            &mut |_| (),
            &send,
            &take,
            &mut effort,
        )
    });
    Ok(Batches {
        receive,
        give_back,
        view: None,
        ready: VecDeque::new(),
        peeling: Some(peeling),
        stop,
    })
}

impl Iterator for Batches {
    type Item = Result<FragmentBatch, PeelError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(batch) = self.ready.pop_front() {
                return Some(Ok(batch));
            }
            match self.receive.recv() {
                Ok(Message::Begin(_, view)) => self.view = Some(view),
                Ok(Message::Tile(tile)) => {
                    // A tile comes behind the beginning of its view.
                    let view = self.view?;
                    let ready = &mut self.ready;
                    let mut rows = FragmentBatch::default();
                    let kept = append_rows(&tile, view, &mut rows, ROWS_AT_A_TIME, |rows| {
                        ready.push_back(rows.clone());
                        Ok::<_, PeelError>(())
                    });
                    // The other side may have ended; then the tile is freed.
                    let _ = self.give_back.send(tile);
                    match kept {
                        Ok(counts) if counts.unsorted > 0 => {
                            return Some(Err(PeelError::Unsorted(counts.unsorted)));
                        }
                        Ok(_) => {}
                        Err(e) => return Some(Err(e)),
                    }
                }
                Ok(Message::End) => {}
                // The thread has ended, well or not.
                Err(_) => {
                    let result = self.peeling.take()?.join();
                    return match result {
                        Ok(Ok(())) => None,
                        Ok(Err(e)) => Some(Err(e)),
                        Err(panic) => std::panic::resume_unwind(panic),
                    };
                }
            }
        }
    }
}

impl Drop for Batches {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        // The thread may wait for room in the channel.
        while self.receive.recv().is_ok() {}
        if let Some(peeling) = self.peeling.take() {
            // Whatever it came to, nobody asks any more.
            let _ = peeling.join();
        }
    }
}
