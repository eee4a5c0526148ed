//! The figures of table 4.1 of Papakostas' thesis (Ioannina 2022): mean squared error (0–255) against dual depth
//! peeling, with its 16 models of 11,102 polygons. Its meshes and camera are not known, so absolute values differ
//! from ours, and the ratio of its two columns is what compares.

use peelnet_render::Role;

/// One line of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The opacity of all models.
    pub alpha: f64,
    /// Weighted blending with the thesis's weight.
    pub weighted: f64,
    /// Weighted blending with the network's weight.
    pub deep: f64,
}

impl Measured {
    /// Error of the learned weight relative to the analytic one.
    pub fn ratio(self) -> f64 {
        self.deep / self.weighted
    }
}

/// Table 4.1.
pub const TABLE: [Measured; 3] = [
    Measured {
        alpha: 0.25,
        weighted: 15.96,
        deep: 11.79,
    },
    Measured {
        alpha: 0.5,
        weighted: 16.35,
        deep: 10.50,
    },
    Measured {
        alpha: 0.75,
        weighted: 13.62,
        deep: 11.27,
    },
];

/// The thesis's line for one of the shipped scenes, by the scene's name; `None` where it measured nothing.
///
/// ```
/// # use peelnet_eval::thesis;
/// assert_eq!(thesis::line("sixteen-050").map(|m| m.weighted), Some(16.35));
/// assert_eq!(thesis::line("sixteen-085"), None);
/// ```
pub fn line(scene: &str) -> Option<Measured> {
    let alpha = scene.strip_prefix("sixteen-")?;
    let index = ["025", "050", "075"].iter().position(|a| *a == alpha)?;
    Some(TABLE[index])
}

/// Method name of weighted blending with the thesis's own weight.
pub const WEIGHTED: &str = Role::ThesisWeight.method();

/// Method name of weighted blending with the thesis's network.
pub const DEEP: &str = Role::ThesisNetwork.method();
