//! Work items: which views of which scenes are peeled, and in which order they are numbered.

use crate::PeelError;
use peelnet_dataset::{DatasetError, MAX_WORK_ITEMS};
use peelnet_scene::Scene;

/// How many views of each scene are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Views {
    /// The first n; asking for more than a scene has is an error.
    First(u32),
    /// All of them.
    #[default]
    All,
}

/// One view of one scene or varied copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// Number in the whole dataset, whatever the shard: the `view` column.
    pub index: u32,
    /// Index of the scene.
    pub scene: u32,
    /// 0 for the scene itself.
    pub copy: u32,
    /// View of the scene.
    pub view: u32,
}

/// All items of a dataset: scene by scene, copy by copy, view by view.
///
/// # Errors
/// A scene without views, or with fewer than asked for; two scenes of one name; more items than a dataset can have.
pub fn items(scenes: &[Scene], views: Views, augment: u32) -> Result<Vec<Item>, PeelError> {
    let mut all = Vec::new();
    let mut count = 0;
    for (i, scene) in scenes.iter().enumerate() {
        if let Some(other) = scenes[..i].iter().find(|s| s.name == scene.name) {
            return Err(PeelError::SameName {
                name: scene.name.clone(),
                first: other.source.clone(),
                second: scene.source.clone(),
            });
        }
        let there = scene.views.len() as u32;
        let taken = match views {
            Views::All => there,
            Views::First(n) if n <= there => n,
            Views::First(n) => {
                return Err(PeelError::TooFewViews {
                    scene: scene.source.clone(),
                    views: there,
                    asked: n,
                });
            }
        };
        // Before memory is taken for them.
        count += (u64::from(augment) + 1) * u64::from(taken);
        if count > u64::from(MAX_WORK_ITEMS) {
            return Err(DatasetError::TooManyItems { items: count }.into());
        }
        for copy in 0..=augment {
            for view in 0..taken {
                all.push(Item {
                    index: all.len() as u32,
                    scene: i as u32,
                    copy,
                    view,
                });
            }
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The old code took memory for 4,294,967,296 items, or wrapped their number around.
    #[test]
    fn more_items_than_a_dataset_can_have_are_refused_with_the_limit() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/scenes/cups.toml");
        let scene = Scene::load(file).unwrap();
        let all = items(std::slice::from_ref(&scene), Views::All, 9).unwrap();
        assert_eq!(all.len(), 10 * scene.views.len());
        let error = items(&[scene], Views::All, u32::MAX)
            .unwrap_err()
            .to_string();
        assert!(error.contains("at most 65536"), "{error}");
    }
}
