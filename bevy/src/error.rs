//! What can be wrong, and how it is said: once, and the scene is still drawn.

use bevy::{
    log::{error, info, warn},
    prelude::*,
};
use std::{
    io,
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};

/// A network that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PeelnetError {
    /// A file of the network cannot be read.
    #[error("{}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// `model.json` is not a description of an exported network.
    #[error("the network's description is not readable: {0}")]
    Description(serde_json::Error),
    /// The description has another version.
    #[error(
        "the network's description is {found:?} (written by peelnet {tool}), this plugin reads {known:?}; export the network again"
    )]
    Version {
        /// Format and version in the file.
        found: String,
        /// Format and version that this crate reads.
        known: String,
        /// The version of peelnet that wrote the file.
        tool: String,
    },
    /// The recipe needs passes that this plugin does not draw.
    #[error(
        "this plugin cannot draw with a network of recipe {recipe:?}: {reason}; take small, medium, large or an anchored one"
    )]
    Recipe {
        /// Of the network.
        recipe: String,
        /// What is missing.
        reason: String,
    },
}

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
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
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
