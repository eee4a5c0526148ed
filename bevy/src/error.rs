//! What can be wrong, and how it is said: once, and the scene is still drawn.

use bevy::{
    log::{error, info, warn},
    prelude::*,
};
use std::sync::{Arc, Mutex, PoisonError};

/// A network that cannot be used, and why: a file that cannot be read, a description that is not one or is of another version, or a recipe with passes
/// that this plugin does not draw.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct PeelnetError(pub(crate) String);

/// How grave a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gravity {
    /// Nothing is wrong.
    Info,
    /// Some surfaces are drawn by Bevy, sorted.
    Warning,
    /// All transparent surfaces are drawn by Bevy, sorted.
    Error,
}

/// What the plugin reported, also to the log. Every message appears once.
#[derive(Clone, Debug, Default, Resource)]
pub struct PeelnetMessages(Arc<Mutex<Vec<(Gravity, String)>>>);

impl PeelnetMessages {
    /// All messages so far.
    #[must_use]
    pub fn all(&self) -> Vec<(Gravity, String)> {
        let messages = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        messages.clone()
    }

    pub(crate) fn report(&self, gravity: Gravity, text: String) {
        let mut messages = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if messages.iter().any(|(_, known)| *known == text) {
            return;
        }
        match gravity {
            Gravity::Info => info!("{text}"),
            Gravity::Warning => warn!("{text}"),
            Gravity::Error => error!("{text}"),
        }
        messages.push((gravity, text));
    }
}
