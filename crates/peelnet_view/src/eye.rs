//! How the camera moves: around its target, along the picture, toward it, and so that all is seen.

use glam::{Mat3, Quat, Vec3};
use peelnet_scene::{Camera, Scene};

/// How close the eye may look along its up direction, radians.
const POLE: f32 = 0.02;
/// Near planes are at least this share of the far plane: 32-bit depths stay distinct.
const NEAREST: f32 = 1e-4;
/// Smallest distance of eye and target as a share of the scene's radius.
const CLOSEST: f32 = 1e-3;
/// Largest distance of eye and target in radii of the scene.
const FARTHEST: f32 = 1e3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sphere {
    pub middle: Vec3,
    /// Above 0.
    pub radius: f32,
}

impl Sphere {
    /// Around the box of all vertices; of radius 1 about the origin where there are none.
    pub fn around(scene: &Scene) -> Self {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for object in &scene.objects {
            for &position in &object.mesh.positions {
                let at = object.world_from_object.transform_point3(position);
                (low, high) = (low.min(at), high.max(at));
            }
        }
        if low.x > high.x {
            (low, high) = (Vec3::ZERO, Vec3::ZERO);
        }
        let (middle, radius) = (0.5 * (low + high), 0.5 * (high - low).length());
        let radius = if radius > 0.0 { radius } else { 1.0 };
        Self { middle, radius }
    }
}

/// The camera's axes: right, up and backward, unit vectors.
fn axes(camera: &Camera) -> Mat3 {
    let back = (camera.position - camera.target).normalize_or(Vec3::Z);
    let right = camera.up.cross(back);
    // Looking along the up direction, any right will do.
    let right = right.normalize_or(back.any_orthonormal_vector());
    Mat3::from_cols(right, back.cross(right), back)
}

/// Turns the eye about its target: `yaw` about the up direction, `pitch` over it; radians.
pub(crate) fn orbit(camera: &mut Camera, yaw: f32, pitch: f32) {
    let up = camera.up.normalize_or(Vec3::Y);
    let away = camera.position - camera.target;
    let away = Quat::from_axis_angle(up, yaw) * away;
    let right = up.cross(away).normalize_or(axes(camera).x_axis);
    // Not over the pole: the picture would turn upside down.
    let height = away.angle_between(up);
    let lowest = (height - (std::f32::consts::PI - POLE)).min(0.0);
    let pitch = pitch.clamp(lowest, (height - POLE).max(0.0));
    camera.position = camera.target + Quat::from_axis_angle(right, -pitch) * away;
}

/// Moves eye and target along the picture: by shares of its height, right and down.
pub(crate) fn pan(camera: &mut Camera, right: f32, down: f32) {
    let distance = (camera.position - camera.target).length();
    let height = 2.0 * distance * (0.5 * camera.fov_y_degrees.to_radians()).tan();
    fly(camera, height * Vec3::new(-right, down, 0.0));
}

pub(crate) fn zoom(camera: &mut Camera, factor: f32, all: Sphere) {
    let away = camera.position - camera.target;
    let distance = (away.length() * factor).clamp(CLOSEST * all.radius, FARTHEST * all.radius);
    camera.position = camera.target + distance * away.normalize_or(Vec3::Z);
}

/// Moves eye and target by a vector of right, up and forward, scene units.
pub(crate) fn fly(camera: &mut Camera, step: Vec3) {
    let step = axes(camera) * Vec3::new(step.x, step.y, -step.z);
    camera.position += step;
    camera.target += step;
}

/// Looks at all objects from the direction that the eye has.
pub(crate) fn fit(camera: &mut Camera, all: Sphere, aspect: f32) {
    let half = 0.5 * camera.fov_y_degrees.to_radians();
    // The narrower side of the picture decides.
    let half = half.min((half.tan() * aspect).atan());
    let back = axes(camera).z_axis;
    camera.target = all.middle;
    camera.position = all.middle + back * (all.radius / half.sin());
}

pub(crate) fn set_planes(camera: &mut Camera, all: Sphere) {
    let forward = -axes(camera).z_axis;
    let middle = (all.middle - camera.position).dot(forward);
    // A little room for rounding; an eye that looks away from everything still has a range.
    let far = 1.01 * (middle + all.radius).max(all.radius);
    camera.far = far;
    camera.near = (0.99 * (middle - all.radius)).max(NEAREST * far);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::{FRAC_PI_2, PI};

    fn camera() -> Camera {
        Camera {
            position: Vec3::new(0.0, 0.0, 4.0),
            target: Vec3::ZERO,
            up: Vec3::new(0.0, 3.0, 0.0),
            fov_y_degrees: 60.0,
            near: 1.0,
            far: 9.0,
        }
    }

    const fn sphere(middle: Vec3, radius: f32) -> Sphere {
        Sphere { middle, radius }
    }

    /// Equal but for the rounding of a few 32-bit operations on numbers of this size.
    fn assert_near(a: Vec3, b: [f32; 3]) {
        let b = Vec3::from(b);
        assert!((a - b).length() < 1e-5 * b.length().max(1.0), "{a} {b}");
    }

    /// The eye stays on its sphere and this side of the pole, however far it is dragged.
    #[test]
    fn orbits_end_before_the_pole() {
        let mut c = camera();
        orbit(&mut c, FRAC_PI_2, 0.0);
        assert_near(c.position, [4.0, 0.0, 0.0]);
        orbit(&mut c, 0.0, 0.5);
        assert_near(c.position, [4.0 * 0.5f32.cos(), 4.0 * 0.5f32.sin(), 0.0]);
        for (pitch, pole) in [(9.0, 0.0), (-9.0, PI)] {
            let mut c = camera();
            for _ in 0..3 {
                orbit(&mut c, 0.3, pitch);
            }
            let angle = (c.position.angle_between(c.up) - pole).abs();
            assert!((angle - POLE).abs() < 1e-3, "{angle}");
            assert!((c.position.length() - 4.0).abs() < 1e-4);
            assert!(c.view_from_world().is_finite());
        }
    }

    /// What is dragged by the height of the picture moves by the height of the picture at the target.
    #[test]
    fn panning_follows_the_pointer() {
        let mut c = camera();
        pan(&mut c, 0.25, 0.125);
        let clip = c.clip_from_view(1.0) * c.view_from_world() * Vec3::ZERO.extend(1.0);
        // A picture is 2 high in these coordinates, y up.
        assert_near(Vec3::new(clip.x, clip.y, 0.0) / clip.w, [0.5, -0.25, 0.0]);
    }

    /// The sphere touches the narrower sides of the picture and lies between the planes.
    #[test]
    fn everything_is_seen_after_a_fit() {
        let all = sphere(Vec3::new(5.0, -2.0, 1.0), 3.0);
        for aspect in [0.5, 1.0, 2.0] {
            let mut c = camera();
            fit(&mut c, all, aspect);
            set_planes(&mut c, all);
            let distance = (c.position - all.middle).length();
            let half = (c.fov_y_degrees.to_radians() / 2.0).tan() * aspect.min(1.0);
            let tangent = all.radius / (distance * distance - all.radius * all.radius).sqrt();
            assert!((tangent / half - 1.0).abs() < 1e-4, "{aspect}");
            assert!(c.near < distance - all.radius && distance + all.radius < c.far);
            assert!(c.near > 0.97 * (distance - all.radius));
        }
    }

    #[test]
    fn flying_and_zooming() {
        let all = sphere(Vec3::ZERO, 1.0);
        let mut c = camera();
        fly(&mut c, Vec3::new(1.0, 2.0, 3.0));
        assert_near(c.position, [1.0, 2.0, 1.0]);
        assert_near(c.target, [1.0, 2.0, -3.0]);
        zoom(&mut c, 0.5, all);
        assert_near(c.position, [1.0, 2.0, -1.0]);
        for _ in 0..99 {
            zoom(&mut c, 0.5, all);
        }
        assert!((c.position - c.target).length() > 0.5 * CLOSEST);
    }

    /// Inside of the objects, or looking away, the planes still are planes.
    #[test]
    fn planes_are_in_order_from_everywhere() {
        for z in [-100.0, -5.0, 0.5, 5.0, 100.0] {
            let mut c = camera();
            (c.position.z, c.target.z) = (z, z - 1.0);
            set_planes(&mut c, sphere(Vec3::ZERO, 10.0));
            assert!(0.0 < c.near && c.near < c.far, "{z}: {} {}", c.near, c.far);
        }
    }
}
