use glam::{Mat4, Quat, Vec3};
use peelnet_scene::{Camera, Object, Scene};
use std::f32::consts::TAU;

/// The camera turns so far about its up direction through its target, degrees.
const ORBIT_DEGREES: f32 = 60.0;

/// In the middle of the path the camera is nearer to its target by this share of its distance.
const DOLLY: f32 = 0.2;

/// Objects swing about their middle by this angle to both sides, degrees, and begin anywhere in it.
const TURN_DEGREES: f32 = 8.0;

/// Objects swing by this share of the diagonal of their box to both sides.
const SHIFT: f32 = 0.04;

/// 360° (1 − 1/φ), radians: multiples of it are never near each other, so that neighbours in the list move differently.
const GOLDEN_ANGLE: f32 = 2.399_963;

pub(super) struct Moment {
    pub camera: Camera,
    /// Object to world space, of every object.
    pub objects: Vec<Mat4>,
}

/// Camera and objects at a share `t` of a scene's path, 0 … 1: the camera of its first view on an arc with a dolly, and every object on a
/// small swing of its own; at 0 as the scene has them. Nothing is random.
pub(super) fn moment(scene: &Scene, t: f32) -> Moment {
    let mut camera = scene.views[0].orbited(ORBIT_DEGREES * t);
    // From 1 to 1 − DOLLY and back.
    let nearer = 1.0 - DOLLY * (1.0 - (TAU * t).cos()) / 2.0;
    camera.position = camera.target + (camera.position - camera.target) * nearer;
    let up = scene.views[0].up.normalize_or(Vec3::Y);
    let objects = scene.objects.iter().enumerate();
    let objects = objects.map(|(k, object)| swing(object, up, k as f32 * GOLDEN_ANGLE, t));
    Moment {
        camera,
        objects: objects.collect(),
    }
}

/// An object's place: turned about `up` through its middle, and shifted across it in a direction of its own.
fn swing(object: &Object, up: Vec3, phase: f32, t: f32) -> Mat4 {
    let world = object.world_from_object;
    let Some((low, high)) = object.mesh.bounds() else {
        return world;
    };
    let amount = (TAU * t + phase).sin() - phase.sin();
    if amount == 0.0 {
        return world;
    }
    let middle = world.transform_point3((low + high) / 2.0);
    let diagonal = world.transform_vector3(high - low).length();
    let direction = Quat::from_axis_angle(up, phase) * up.any_orthonormal_vector();
    let turn = Quat::from_axis_angle(up, TURN_DEGREES.to_radians() * amount);
    Mat4::from_translation(middle + direction * (SHIFT * diagonal * amount))
        * Mat4::from_quat(turn)
        * Mat4::from_translation(-middle)
        * world
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The path begins with the scene as it is, the camera stays at its height and comes as near as is said, and every object moves, by no
    /// more than is said.
    #[test]
    fn a_path_is_what_it_says() {
        let scene = peelnet_scene::suite::load("cups").unwrap();
        let at = |t| moment(&scene, t);
        let first = at(0.0);
        assert_eq!(first.camera, scene.views[0]);
        for (o, place) in scene.objects.iter().zip(&first.objects) {
            assert_eq!(o.world_from_object, *place);
        }
        let distance = |m: &Moment| (m.camera.position - m.camera.target).length();
        let middle = at(0.5);
        let ratio = distance(&middle) / distance(&first);
        assert!((ratio - (1.0 - DOLLY)).abs() < 1e-4, "{ratio}");
        for k in 1..10 {
            let moment = at(k as f32 / 10.0);
            for (o, place) in scene.objects.iter().zip(&moment.objects) {
                let (low, high) = o.mesh.bounds().unwrap();
                let before = o.world_from_object.transform_point3((low + high) / 2.0);
                let after = place.transform_point3((low + high) / 2.0);
                let diagonal = o.world_from_object.transform_vector3(high - low).length();
                let moved = (after - before).length() / diagonal;
                assert!(moved <= 2.0 * SHIFT + 1e-4, "{moved}");
                assert!(*place != o.world_from_object);
            }
        }
    }
}
