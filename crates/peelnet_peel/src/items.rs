//! Work items: which views of which scenes are peeled, and in which order they are numbered.

use crate::{ExtractOptions, Peel, PeelError};
use peelnet_dataset::{CameraInfo, MAX_WORK_ITEMS, Part};
use peelnet_scene::{Camera, Scene};

/// The work items of the options' shard.
///
/// # Errors
/// As [`items`].
pub fn shard_items(scenes: &[Scene], options: &ExtractOptions) -> Result<Vec<Part>, PeelError> {
    let mut all = items(scenes, options)?;
    all.retain(|part| options.shard.is_none_or(|s| s.contains(part.index)));
    Ok(all)
}

/// All work items of a dataset, whatever the shard, as parts without rows: scene by scene, copy by copy, view by view. Cameras are the
/// scenes' own.
///
/// # Errors
/// A limit of passes where there are none; no view at all; a scene with fewer views than asked for; two scenes of one name; more items than a
/// dataset can have; a fraction of pixels outside 0 … 1.
pub fn items(scenes: &[Scene], options: &ExtractOptions) -> Result<Vec<Part>, PeelError> {
    let (pixels, [width, height]) = (options.pixels, options.size);
    if !(pixels > 0.0 && pixels <= 1.0) {
        let reason =
            format!("{pixels} is not a fraction of the pixels: it must be above 0 and at most 1");
        return Err(PeelError::setting("pixels", reason));
    }
    if options.max_passes.is_some() && options.peel == Peel::SBuffer {
        let reason =
            "peeling with an s-buffer stores all layers at once, so there are no passes to limit";
        return Err(PeelError::setting("max_passes", reason));
    }
    let mut all = Vec::new();
    let mut count = 0;
    for (i, scene) in scenes.iter().enumerate() {
        if let Some(other) = scenes[..i].iter().find(|s| s.name == scene.name) {
            let reason = format!(
                "two scenes are named '{}' ({} and {}): rename one, because rows name their scene",
                scene.name,
                other.source.display(),
                scene.source.display()
            );
            return Err(PeelError::setting("scenes", reason));
        }
        let views = scene.first_views(options.views.map(|n| n as usize));
        let views = views.map_err(|reason| PeelError::setting("views", reason))?;
        // Before memory is taken for them.
        count += (u64::from(options.augment) + 1) * views.len() as u64;
        if count > u64::from(MAX_WORK_ITEMS) {
            let reason = format!(
                "{count} work items (scenes × copies × views) are too many: at most {MAX_WORK_ITEMS}"
            );
            return Err(PeelError::setting("augment", reason));
        }
        for copy in 0..=options.augment {
            for (view, camera) in (0..).zip(views) {
                all.push(Part {
                    index: all.len() as u32,
                    scene: i as u32,
                    copy,
                    view,
                    camera: camera_info(camera),
                    width,
                    height,
                    ..Part::default()
                });
            }
        }
    }
    match all.is_empty() {
        true => Err(PeelError::setting("scenes", "no scene to extract")),
        false => Ok(all),
    }
}

pub(crate) fn camera_info(camera: &Camera) -> CameraInfo {
    CameraInfo {
        position: camera.position.to_array(),
        target: camera.target.to_array(),
        up: camera.up.to_array(),
        fov_y_degrees: camera.fov_y_degrees,
        near: camera.near,
        far: camera.far,
    }
}
