//! Passes that more than one method, or the extraction, is built of.

pub mod count;
pub mod dual;
pub mod fullscreen;
pub mod sbuffer;
pub mod single;
