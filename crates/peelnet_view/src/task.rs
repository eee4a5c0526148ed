//! Work that goes on while frames are drawn: futures that are polled once a frame, and threads where there are any.

use std::{
    future::Future,
    pin::Pin,
    sync::{Arc, Mutex, PoisonError},
    task::{Context, Poll, Wake, Waker},
};

/// A future that the window polls each frame. Dropping it cancels the work.
pub(crate) struct Task<T>(Pin<Box<dyn Future<Output = T>>>);

impl<T> std::fmt::Debug for Task<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Task")
    }
}

impl<T> Task<T> {
    /// Begins at the first poll.
    pub fn new(future: impl Future<Output = T> + 'static) -> Self {
        Self(Box::pin(future))
    }

    /// Goes on; the result once there is one. The window is drawn again when there is more to do.
    pub fn poll(&mut self, ui: &egui::Context) -> Option<T> {
        let waker = repaints(ui);
        match self.0.as_mut().poll(&mut Context::from_waker(&waker)) {
            Poll::Ready(result) => Some(result),
            Poll::Pending => {
                // On native systems GPU callbacks run when the device is polled, which the next frame does.
                ui.request_repaint_after(std::time::Duration::from_millis(8));
                None
            }
        }
    }
}

/// Has the window drawn again when it is woken.
pub(crate) fn repaints(ui: &egui::Context) -> Waker {
    Waker::from(Arc::new(Repaint(ui.clone())))
}

struct Repaint(egui::Context);

impl Wake for Repaint {
    fn wake(self: Arc<Self>) {
        self.0.request_repaint();
    }
}

/// The result, once there is one, `None` in it where the work panicked; and who waits for it.
type Handed<T> = (Option<Option<T>>, Option<Waker>);

/// The result of a computation, made on a thread of its own where there are threads, so that frames go on.
pub(crate) async fn computed<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Option<T> {
    let slot: Arc<Mutex<Handed<T>>> = Arc::new(Mutex::new((None, None)));
    let sink = Arc::clone(&slot);
    let run = move || {
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).ok();
        let mut sink = sink.lock().unwrap_or_else(PoisonError::into_inner);
        sink.0 = Some(result);
        if let Some(waker) = sink.1.take() {
            waker.wake();
        }
    };
    #[cfg(target_arch = "wasm32")]
    run();
    #[cfg(not(target_arch = "wasm32"))]
    std::thread::spawn(run);
    std::future::poll_fn(move |cx| {
        let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(result) = slot.0.take() {
            return Poll::Ready(result);
        }
        slot.1 = Some(cx.waker().clone());
        Poll::Pending
    })
    .await
}
