//! The range of depths that transparent surfaces span in a view.
//!
//! A tight range matters more than any setting of the network. It comes from the boxes of the transparent meshes in view, so nothing needs to
//! be set by hand.

use bevy::{
    camera::primitives::Aabb,
    math::{Affine3A, Mat4, Vec3A, Vec4},
    prelude::*,
    render::{Extract, sync_world::MainEntityHashMap},
};

/// The box of a mesh, and `world_from_local`.
type PlacedBox = (Aabb, Affine3A);

/// The boxes of all visible meshes.
#[derive(Default, Resource)]
pub(crate) struct Boxes(pub MainEntityHashMap<PlacedBox>);

/// Copies boxes to the render world. Which meshes are transparent is known only there.
pub(crate) fn extract_boxes(
    cameras: Extract<Query<(), With<crate::LearnedTransparency>>>,
    meshes: Extract<Query<(Entity, &Aabb, &GlobalTransform, &ViewVisibility), With<Mesh3d>>>,
    mut boxes: ResMut<Boxes>,
) {
    boxes.0.clear();
    if !cameras.is_empty() {
        let visible = meshes.iter().filter(|(.., visibility)| visibility.get());
        boxes
            .0
            .extend(visible.map(|(entity, bounds, transform, _)| {
                let placed = (*bounds, transform.affine());
                (entity.into(), placed)
            }));
    }
}

/// Near, far, and what both are counted from, for a camera and the boxes in its view. A mesh without a box may be anywhere: then the range
/// is the camera's.
pub(crate) fn depths_of_boxes(
    view_from_world: Affine3A,
    clip_from_view: Mat4,
    boxes: impl Iterator<Item = Option<PlacedBox>>,
) -> Vec4 {
    let (mut near, mut far) = (f32::INFINITY, f32::NEG_INFINITY);
    for placed in boxes {
        let [lowest, highest] = match placed {
            Some((bounds, world_from_local)) => {
                let view_from_local = view_from_world * world_from_local;
                let center = -view_from_local.transform_point3a(bounds.center).z;
                let reach = bounds.relative_radius(&Vec3A::Z, &view_from_local.matrix3);
                [center - reach, center + reach]
            }
            None => ends_of(clip_from_view),
        };
        near = near.min(lowest);
        far = far.max(highest);
    }
    clipped(near, far, clip_from_view)
}

/// A range that somebody set, or that boxes span, clipped to the camera's; and what it is counted from.
pub(crate) fn clipped(near: f32, far: f32, clip_from_view: Mat4) -> Vec4 {
    let [camera_near, camera_far] = ends_of(clip_from_view);
    let near = near.clamp(camera_near, camera_far);
    let far = far.clamp(near, camera_far);
    // Distances along the axis of an orthographic camera are no distances to a point: the scale is linear, and counts from near.
    let is_orthographic = clip_from_view.w_axis.w == 1.0;
    let origin = if is_orthographic { near } else { 0.0 };
    Vec4::new(near - origin, far - origin, origin, 0.0)
}

/// The distances of the camera's near and far plane. Bevy's perspective cameras have no far plane: they get one far away.
fn ends_of(clip_from_view: Mat4) -> [f32; 2] {
    let view_from_clip = clip_from_view.inverse();
    // Bevy's depth is 1 at the near plane and 0 at the far one.
    let at = |depth: f32| {
        let point = view_from_clip * Vec4::new(0.0, 0.0, depth, 1.0);
        -point.z / point.w
    };
    let (near, far) = (at(1.0), at(0.0));
    if far.is_finite() && far > near {
        [near, far]
    } else {
        [near, near + near.abs().max(f32::MIN_POSITIVE) * 1e5]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::proj;
    use std::f32::consts::{FRAC_PI_4, SQRT_2};

    /// The box of this half side around a point, turned about the y axis.
    fn placed(half: f32, angle: f32, z: f32) -> Option<PlacedBox> {
        let (turn, to) = (Quat::from_rotation_y(angle), Vec3::new(0.0, 0.0, z));
        let bounds = Aabb::from_min_max(Vec3::splat(-half), Vec3::splat(half));
        Some((bounds, Affine3A::from_rotation_translation(turn, to)))
    }

    #[test]
    fn the_range_spans_all_boxes_within_the_camera() {
        let perspective = proj::perspective_infinite_reverse(1.0, 1.0, 0.1);
        // Bevy's orthographic cameras swap the planes: depth is 1 at near.
        let orthographic = proj::orthographic(-1.0, 1.0, -1.0, 1.0, 100.0, -10.0);
        let cases = [
            (
                perspective,
                vec![placed(1.0, 0.0, -5.0), placed(2.0, 0.0, -19.0)],
                [4.0, 21.0, 0.0],
            ),
            // A turned box reaches as far as its corners.
            (
                perspective,
                vec![placed(1.0, FRAC_PI_4, -10.0)],
                [10.0 - SQRT_2, 10.0 + SQRT_2, 0.0],
            ),
            // The camera stands in the box.
            (perspective, vec![placed(3.0, 0.0, 0.0)], [0.1, 3.0, 0.0]),
            // Behind the camera's position, but in front of its near plane: distances count from the nearest.
            (orthographic, vec![placed(1.0, 0.0, 5.0)], [0.0, 2.0, -6.0]),
            // A mesh without a box may be anywhere.
            (perspective, vec![None], [0.1, 0.1 + 0.1 * 1e5, 0.0]),
        ];
        for (camera, boxes, want) in cases {
            let depths = depths_of_boxes(Affine3A::IDENTITY, camera, boxes.into_iter());
            let is_near = |(a, b): (f32, f32)| (a - b).abs() < 1e-4 * b.abs().max(1.0);
            let mut pairs = depths.to_array().into_iter().zip(want);
            assert!(pairs.all(is_near), "{depths}");
        }
    }
}
