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

/// The box of a mesh and where it stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedBox {
    pub bounds: Aabb,
    pub world_from_local: Affine3A,
}

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
    if cameras.is_empty() {
        return;
    }
    for (entity, bounds, transform, visibility) in &meshes {
        if visibility.get() {
            let world_from_local = transform.affine();
            boxes.0.insert(
                entity.into(),
                PlacedBox {
                    bounds: *bounds,
                    world_from_local,
                },
            );
        }
    }
}

/// Near and far, and what both are counted from: what shaders get.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Depths {
    pub near: f32,
    pub far: f32,
    pub origin: f32,
}

impl Depths {
    /// For a camera and the boxes in its view. A mesh without a box may be anywhere: then the range is the camera's.
    pub fn of(
        view_from_world: Affine3A,
        clip_from_view: Mat4,
        boxes: impl Iterator<Item = Option<PlacedBox>>,
    ) -> Self {
        let [camera_near, camera_far] = ends_of(clip_from_view);
        let (mut near, mut far) = (f32::INFINITY, f32::NEG_INFINITY);
        for placed in boxes {
            let [lowest, highest] = match placed {
                Some(placed) => extent_of(view_from_world * placed.world_from_local, placed.bounds),
                None => [camera_near, camera_far],
            };
            near = near.min(lowest);
            far = far.max(highest);
        }
        Self::clipped(near, far, clip_from_view)
    }

    /// A range that somebody set, or that boxes span, clipped to the camera's.
    pub fn clipped(near: f32, far: f32, clip_from_view: Mat4) -> Self {
        let [camera_near, camera_far] = ends_of(clip_from_view);
        let near = near.clamp(camera_near, camera_far);
        let far = far.clamp(near, camera_far);
        // Distances along the axis of an orthographic camera are no distances to a point: the scale is linear, and counts from near.
        if is_orthographic(clip_from_view) {
            Self {
                near: 0.0,
                far: far - near,
                origin: near,
            }
        } else {
            Self {
                near,
                far,
                origin: 0.0,
            }
        }
    }

    /// As `draw.wesl` reads it.
    pub fn uniform(self) -> Vec4 {
        Vec4::new(self.near, self.far, self.origin, 0.0)
    }
}

fn is_orthographic(clip_from_view: Mat4) -> bool {
    clip_from_view.w_axis.w == 1.0
}

/// The distances of the camera's near and far plane. Bevy's perspective cameras have no far plane: they get one far away.
fn ends_of(clip_from_view: Mat4) -> [f32; 2] {
    let view_from_clip = clip_from_view.inverse();
    // Bevy's depth is 1 at the near plane and 0 at the far one.
    let at = |depth: f32| {
        let point = view_from_clip * Vec4::new(0.0, 0.0, depth, 1.0);
        -point.z / point.w
    };
    let near = at(1.0);
    let far = at(0.0);
    let without_end = near.abs().max(f32::MIN_POSITIVE) * 1e5;
    [
        near,
        if far.is_finite() && far > near {
            far
        } else {
            near + without_end
        },
    ]
}

/// The nearest and the farthest distance of a box along the view's axis.
fn extent_of(view_from_local: Affine3A, bounds: Aabb) -> [f32; 2] {
    let center = -view_from_local.transform_point3a(bounds.center).z;
    let axes = view_from_local.matrix3;
    let along = Vec3A::new(axes.x_axis.z, axes.y_axis.z, axes.z_axis.z).abs();
    let reach = along.dot(bounds.half_extents);
    [center - reach, center + reach]
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::proj;

    fn placed(center: [f32; 3], half: [f32; 3], z: f32) -> Option<PlacedBox> {
        Some(PlacedBox {
            bounds: Aabb {
                center: center.into(),
                half_extents: half.into(),
            },
            world_from_local: Affine3A::from_translation(Vec3::new(0.0, 0.0, z)),
        })
    }

    fn perspective() -> Mat4 {
        proj::perspective_infinite_reverse(1.0, 1.0, 0.1)
    }

    #[test]
    fn the_range_spans_all_boxes() {
        let boxes = [
            placed([0.0; 3], [1.0; 3], -5.0),
            placed([0.0, 0.0, 1.0], [2.0; 3], -20.0),
        ];
        let depths = Depths::of(Affine3A::IDENTITY, perspective(), boxes.into_iter());
        assert_eq!((depths.near, depths.far, depths.origin), (4.0, 21.0, 0.0));
    }

    #[test]
    fn a_turned_box_reaches_as_far_as_its_corners() {
        let turned = PlacedBox {
            world_from_local: Affine3A::from_rotation_translation(
                Quat::from_rotation_y(std::f32::consts::FRAC_PI_4),
                Vec3::new(0.0, 0.0, -10.0),
            ),
            bounds: Aabb {
                center: Vec3A::ZERO,
                half_extents: Vec3A::ONE,
            },
        };
        let depths = Depths::of(
            Affine3A::IDENTITY,
            perspective(),
            std::iter::once(Some(turned)),
        );
        let root = 2.0f32.sqrt();
        assert!((depths.near - (10.0 - root)).abs() < 1e-5, "{depths:?}");
        assert!((depths.far - (10.0 + root)).abs() < 1e-5, "{depths:?}");
    }

    #[test]
    fn the_camera_clips_the_range() {
        // The camera stands in the box.
        let boxes = [placed([0.0; 3], [3.0; 3], 0.0)];
        let depths = Depths::of(Affine3A::IDENTITY, perspective(), boxes.into_iter());
        assert!(
            (depths.near - 0.1).abs() < 1e-6 && depths.far == 3.0,
            "{depths:?}"
        );
    }

    #[test]
    fn orthographic_distances_count_from_the_nearest() {
        // Bevy's orthographic cameras swap the planes: depth is 1 at near.
        let camera = proj::orthographic(-1.0, 1.0, -1.0, 1.0, 100.0, -10.0);
        let boxes = [placed([0.0; 3], [1.0; 3], 5.0)];
        let depths = Depths::of(Affine3A::IDENTITY, camera, boxes.into_iter());
        // Behind the camera's position, but in front of its near plane.
        assert!((depths.origin + 6.0).abs() < 1e-4, "{depths:?}");
        assert!(
            depths.near == 0.0 && (depths.far - 2.0).abs() < 1e-4,
            "{depths:?}"
        );
    }

    #[test]
    fn a_mesh_without_a_box_may_be_anywhere() {
        let depths = Depths::of(Affine3A::IDENTITY, perspective(), std::iter::once(None));
        assert!(
            (depths.near - 0.1).abs() < 1e-6 && depths.far > 1000.0,
            "{depths:?}"
        );
    }
}
