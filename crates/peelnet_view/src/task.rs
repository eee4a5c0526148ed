//! Work that goes on while frames are drawn: futures that are polled once a frame, and threads where there are any.

use egui::Context;
use std::{
    error::Error,
    future::Future,
    pin::Pin,
    sync::Arc,
    task::{Poll, Wake, Waker},
    time::Duration,
};

/// What may go wrong; [`one_line`] of it is for people.
pub(crate) type Fallible<T> = Result<T, Box<dyn Error>>;

/// An error with its causes, as one line that is safe to show, however long it is.
pub(crate) fn one_line(error: &dyn Error) -> String {
    peelnet_core::files::one_line(&peelnet_core::files::error_line(error)).into_owned()
}

/// A future that the window polls each frame. Dropping it cancels the work.
pub(crate) struct Task<T>(Pin<Box<dyn Future<Output = T>>>);

impl<T> Task<T> {
    pub fn new(future: impl Future<Output = T> + 'static) -> Self {
        Self(Box::pin(future))
    }

    /// Goes on with a task, if there is one; its result once it has one, and then it is gone. The window is drawn again when there is more to do.
    pub fn finish(task: &mut Option<Self>, ui: &Context) -> Option<T> {
        let waker = repaints(ui);
        let future = task.as_mut()?.0.as_mut();
        match future.poll(&mut std::task::Context::from_waker(&waker)) {
            Poll::Ready(result) => {
                *task = None;
                Some(result)
            }
            Poll::Pending => {
                // On native systems GPU callbacks run when the device is polled, which the next frame does.
                ui.request_repaint_after(Duration::from_millis(8));
                None
            }
        }
    }
}

/// Has the window drawn again when it is woken.
pub(crate) fn repaints(ui: &Context) -> Waker {
    struct Repaint(Context);

    impl Wake for Repaint {
        fn wake(self: Arc<Self>) {
            self.0.request_repaint();
        }
    }
    Waker::from(Arc::new(Repaint(ui.clone())))
}

/// The result of a computation, made on a thread of its own where there are threads, so that frames go on. It runs in a task, which asks for
/// frames until it has ended.
pub(crate) async fn computed<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Fallible<T> {
    #[cfg(target_arch = "wasm32")]
    return Ok(work());
    #[cfg(not(target_arch = "wasm32"))]
    {
        let thread = std::thread::spawn(work);
        let ended = |_: &mut std::task::Context<'_>| match thread.is_finished() {
            true => Poll::Ready(()),
            false => Poll::Pending,
        };
        std::future::poll_fn(ended).await;
        thread.join().map_err(|_| "the computation failed".into())
    }
}

/// Work on what a key identifies, one at a time, and its last result.
pub(crate) struct Job<K, T> {
    task: Option<Task<(K, Fallible<T>)>>,
    pub last: Option<(K, Result<T, String>)>,
}

impl<K, T> Default for Job<K, T> {
    fn default() -> Self {
        Self {
            task: None,
            last: None,
        }
    }
}

impl<K: PartialEq + 'static, T: 'static> Job<K, T> {
    pub const fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    /// Ends what goes on; the last result stays.
    pub fn cancel(&mut self) {
        self.task = None;
    }

    /// The last result, where it is of this.
    pub fn get(&self, key: &K) -> Option<&Result<T, String>> {
        let (of, result) = self.last.as_ref()?;
        (of == key).then_some(result)
    }

    /// Whether work on this is to begin: nothing goes on, and its result is not known.
    pub fn wants(&self, key: &K) -> bool {
        self.task.is_none() && self.get(key).is_none()
    }

    /// Begins, in place of what goes on.
    pub fn begin(&mut self, key: K, work: impl Future<Output = Fallible<T>> + 'static) {
        self.task = Some(Task::new(async move { (key, work.await) }));
    }

    pub fn poll(&mut self, ui: &Context) {
        if let Some((key, result)) = Task::finish(&mut self.task, ui) {
            self.last = Some((key, result.map_err(|e| one_line(&*e))));
        }
    }
}
