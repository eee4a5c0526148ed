//! What is being saved, and what was.

use crate::task::{Fallible, Job, one_line};
use std::{cell::Cell, rc::Rc};

#[derive(Default)]
pub(crate) struct Output {
    pub job: Job<(), String>,
    /// Frames written, and all.
    pub progress: Rc<Cell<(u32, u32)>>,
}

impl Output {
    pub fn last(&self) -> Option<&Result<String, String>> {
        self.job.get(&())
    }

    /// Says what was done at once.
    pub fn show(&mut self, result: Fallible<String>) {
        self.job.last = Some(((), result.map_err(|e| one_line(&*e))));
    }
}
