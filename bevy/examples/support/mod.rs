//! What the comparison and the tests share: cards of glass, their exact image, and an application without a window.

#![allow(dead_code, missing_docs, reason = "each user takes a part")]

pub mod cards;
pub mod exact;
pub mod headless;
