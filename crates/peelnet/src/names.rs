//! Names of settings, the same on the command line and in Python.

use peelnet_dataset::SplitBy;
use peelnet_export::{Language, Precision};
#[cfg(feature = "train")]
use peelnet_train::Schedule;

/// Languages of exported shaders.
pub const LANGUAGES: &[(&str, Language)] = &[
    ("wgsl", Language::Wgsl),
    ("glsl-es", Language::GlslEs),
    ("glsl", Language::Glsl),
    ("hlsl", Language::Hlsl),
    ("msl", Language::Msl),
];

/// Arithmetic of exported shaders.
pub const PRECISIONS: &[(&str, Precision)] = &[("f32", Precision::F32), ("f16", Precision::F16)];

/// What stays together when rows are set aside.
pub const SPLITS: &[(&str, SplitBy)] = &[("scene", SplitBy::Scene), ("pixel", SplitBy::Pixel)];

/// How a learning rate changes.
#[cfg(feature = "train")]
pub const SCHEDULES: &[(&str, Schedule)] = &[
    ("constant", Schedule::Constant),
    ("one-cycle", Schedule::OneCycle { warmup: 0.2 }),
];

/// What has a name.
///
/// # Errors
/// A text with the names that there are.
pub fn named<T: Copy>(setting: &str, names: &[(&str, T)], name: &str) -> Result<T, String> {
    let found = names.iter().find(|(n, _)| *n == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let all: Vec<&str> = names.iter().map(|(n, _)| *n).collect();
        format!("{setting} '{name}': there are {}", all.join(", "))
    })
}
