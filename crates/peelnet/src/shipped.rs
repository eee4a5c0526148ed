//! Where the shipped scenes and models lie.

use crate::failure::Failure;
use std::path::{Path, PathBuf};

/// Folders that may hold `data/` and `models/`: the current one, those above the program, and the one it was built in.
fn roots() -> Vec<PathBuf> {
    let mut roots = vec![PathBuf::from(".")];
    if let Ok(program) = std::env::current_exe() {
        roots.extend(program.ancestors().skip(1).map(Path::to_owned));
    }
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2);
    roots.extend(workspace.map(Path::to_owned));
    roots
}

fn find(relative: &Path) -> Option<PathBuf> {
    roots()
        .into_iter()
        .map(|root| root.join(relative))
        .find(|path| path.exists())
        // `./models/…` reads better without its dot.
        .map(|path| path.strip_prefix(".").map(Path::to_owned).unwrap_or(path))
}

/// The folder of the shipped scenes.
///
/// # Errors
/// If there is none.
pub fn scenes() -> Result<PathBuf, Failure> {
    find(Path::new("data/scenes")).ok_or_else(|| {
        Failure::Failed(
            "the shipped scenes (data/scenes) were not found; run in the project's folder, or name scene files"
                .to_owned(),
        )
    })
}

/// The shipped model of a recipe.
///
/// # Errors
/// If there is none.
pub fn model(recipe: &str) -> Result<PathBuf, Failure> {
    let relative = Path::new("models").join(recipe).join("model.safetensors");
    find(&relative).ok_or_else(|| {
        Failure::Failed(format!(
            "the shipped model ({}) was not found; run in the project's folder, or name a model file with --model, \
             made with: peelnet train DATASET --recipe {recipe} --out model.safetensors",
            relative.display()
        ))
    })
}
