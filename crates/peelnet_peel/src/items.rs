//! Work items: which views of which scenes are peeled, and in which order they are numbered.

use crate::PeelError;
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
/// A scene without views, or with fewer than asked for; two scenes of one name.
pub fn items(scenes: &[Scene], views: Views, augment: u32) -> Result<Vec<Item>, PeelError> {
    let mut all = Vec::new();
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
