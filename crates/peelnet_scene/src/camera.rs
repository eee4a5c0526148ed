use crate::error::{Fault, require, within};
use glam::{Mat4, Quat, Vec3};
use serde::{Deserialize, Deserializer};

/// Vertical fields of view that files may ask for, degrees: of smaller or larger ones, 32-bit positions on the screen keep too few bits.
const FOV_Y: std::ops::RangeInclusive<f32> = 0.01..=179.0;

/// A perspective camera, with the keys of a scene file.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Eye, scene units.
    #[serde(deserialize_with = "vector")]
    pub position: Vec3,
    /// Point looked at, scene units.
    #[serde(deserialize_with = "vector")]
    pub target: Vec3,
    /// Up direction, any length.
    #[serde(default = "up", deserialize_with = "vector")]
    pub up: Vec3,
    /// Vertical field of view, degrees.
    #[serde(default = "fov_y", rename = "fov_y")]
    pub fov_y_degrees: f32,
    /// Near clip distance, scene units.
    pub near: f32,
    /// Far clip distance, scene units.
    pub far: f32,
}

const fn up() -> Vec3 {
    Vec3::Y
}

const fn fov_y() -> f32 {
    45.0
}

fn vector<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec3, D::Error> {
    <[f32; 3]>::deserialize(deserializer).map(Vec3::from)
}

impl Camera {
    /// Checks the values; an error holds the key and what is wrong.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        for (key, v) in [
            ("position", self.position),
            ("target", self.target),
            ("up", self.up),
        ] {
            require(v.is_finite(), key, "must be finite")?;
        }
        let (near, far) = (self.near, self.far);
        let is_order = near > 0.0 && near < far && far.is_finite();
        let message = format!("near {near} must be positive and below far {far}");
        require(is_order, "near", &message)?;
        within("fov_y", self.fov_y_degrees, *FOV_Y.start(), *FOV_Y.end())?;
        let forward = self.target - self.position;
        let is_apart = forward.length() != 0.0;
        require(is_apart, "target", "must differ from position")?;
        let across = forward.normalize().cross(self.up.normalize_or_zero());
        let message = "must not be zero or along the line of sight";
        require(across.length() >= 1e-4, "up", message)
    }

    /// World to view space: right-handed, looking along −z.
    pub fn view_from_world(&self) -> Mat4 {
        glam::camera::rh::view::look_at_mat4(self.position, self.target, self.up)
    }

    /// View to clip space: x right, y up, depth 0 at near to 1 at far. `aspect` is width over height.
    pub fn clip_from_view(&self, aspect: f32) -> Mat4 {
        glam::camera::rh::proj::directx::perspective(
            self.fov_y_degrees.to_radians(),
            aspect,
            self.near,
            self.far,
        )
    }

    /// Whether so much moved on the screen since another camera that a frame of its says nothing of this one's: a thirty-second of the frame's
    /// width, or a quarter of a depth.
    pub fn is_cut_from(&self, last: &Self) -> bool {
        if self == last {
            return false;
        }
        // From where the last one stood: far from the origin 32 bits know too little of both.
        let [own, last] = [self, last].map(|camera| Self {
            position: camera.position - last.position,
            target: camera.target - last.position,
            ..*camera
        });
        let clip_from_last =
            own.clip_from_view(1.0) * own.view_from_world() * last.view_from_world().inverse();
        let middle = last.near.sqrt() * last.far.sqrt();
        let tangent = (0.5 * last.fov_y_degrees).to_radians().tan();
        let has_moved = |[x, y, depth]: [f32; 3]| {
            let place = Vec3::new(x * tangent * depth, y * tangent * depth, -depth);
            let place = clip_from_last * place.extend(1.0);
            let moved = glam::Vec2::new(place.x / place.w - x, place.y / place.w - y);
            !(moved.length() < 0.0625 && (0.8..1.25).contains(&(place.w / depth)))
        };
        let corners = [-1.0, 1.0].into_iter().flat_map(|x| [[x, -1.0], [x, 1.0]]);
        let mut places = corners.flat_map(|[x, y]| [middle, last.far].map(|depth| [x, y, depth]));
        let ranges = [own.near / last.near, own.far / last.far];
        !ranges.iter().all(|ratio| (0.8..1.25).contains(ratio)) || places.any(has_moved)
    }

    /// The camera at so many places around its target.
    pub(crate) fn orbit(&self, views: u32) -> Vec<Self> {
        let degrees = |i: u32| 360.0 * i as f32 / views as f32;
        (0..views).map(|i| self.orbited(degrees(i))).collect()
    }

    /// The camera turned about `up` through the target.
    pub fn orbited(&self, degrees: f32) -> Self {
        if degrees == 0.0 {
            return *self;
        }
        let turn = Quat::from_axis_angle(self.up.normalize_or(Vec3::Y), degrees.to_radians());
        Self {
            position: self.target + turn * (self.position - self.target),
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    #[test]
    fn depth_runs_from_zero_to_one_and_w_is_linear_depth() {
        let camera = Camera {
            position: Vec3::new(0.0, 0.0, 6.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_y_degrees: 90.0,
            near: 1.0,
            far: 9.0,
        };
        let clip = camera.clip_from_view(2.0) * camera.view_from_world();
        for (z, depth) in [(5.0, 0.0), (-3.0, 1.0)] {
            let p = clip * Vec4::new(0.0, 0.0, z, 1.0);
            assert!((p.z / p.w - depth).abs() < 1e-6);
            assert!((p.w - (6.0 - z)).abs() < 1e-5);
        }
        // 90° at depth 6: y = 6 is the upper edge, x = 12 the right one for aspect 2.
        let p = clip * Vec4::new(12.0, 6.0, 0.0, 1.0);
        assert!((p.x / p.w - 1.0).abs() < 1e-6 && (p.y / p.w - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_camera_that_moves_a_little_is_no_cut() {
        let camera = Camera {
            position: Vec3::new(0.0, 0.0, 6.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_y_degrees: 45.0,
            near: 1.0,
            far: 36.0,
        };
        assert!(!camera.is_cut_from(&camera));
        // A degree is a fortieth of the frame's height of 45 degrees, but the turn about the target moves the eye along.
        assert!(!camera.orbited(0.3).is_cut_from(&camera));
        let ahead = |z| Camera {
            position: Vec3::new(0.0, 0.0, z),
            target: Vec3::new(0.0, 0.0, z - 1.0),
            ..camera
        };
        let far_away = |camera: Camera| Camera {
            position: camera.position + Vec3::new(5e5, 4e6, 0.0),
            target: camera.target + Vec3::new(5e5, 4e6, 0.0),
            ..camera
        };
        let there = Camera {
            far: 1000.0,
            ..far_away(camera)
        };
        let beside = Camera {
            position: there.position + Vec3::new(0.0, 0.0, 0.0625),
            ..there
        };
        assert!(!beside.is_cut_from(&there));
        // At the corners of the middle depth 6, the picture grows by 6 / (6 - d).
        assert!(!camera.is_cut_from(&ahead(6.2)));
        for other in [
            camera.orbited(20.0),
            camera.orbited(180.0),
            ahead(4.0),
            Camera {
                fov_y_degrees: 60.0,
                ..camera
            },
            Camera {
                up: Vec3::X,
                ..camera
            },
            Camera {
                far: 100.0,
                ..camera
            },
        ] {
            assert!(other.is_cut_from(&camera), "{other:?}");
            assert!(camera.is_cut_from(&other), "{other:?}");
        }
    }
}
