//! What the panels hold.

/// Which panels are open, what is typed into them, and what moves.
#[derive(Default)]
pub(crate) struct State {
    pub bare: bool,
    pub left: bool,
    pub right: bool,
    /// Whether errors are measured when the view rests.
    pub measures: bool,
    pub help: bool,
    pub plays: bool,
    /// Whether the eye goes round.
    pub turns: bool,
    pub path: String,
    pub model: String,
    pub object: usize,
    pub listed: bool,
    pub frames: u32,
}

impl State {
    pub fn new(bare: bool) -> Self {
        Self {
            bare,
            left: true,
            right: true,
            measures: true,
            frames: 48,
            ..Self::default()
        }
    }
}
