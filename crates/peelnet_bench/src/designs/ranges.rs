//! Where a pixel's scale of depth may come from, beside its own surfaces and the frame.

use super::views::View;
use glam::{Mat4, Vec3};
use peelnet_core::{
    fragment,
    methods::{
        quantiles::{Quantiles, TILE, Tiles, ends_of, seen_behind_nearest},
        slabs::{self, Extent},
    },
};
use peelnet_scene::{Camera, Scene};
use rayon::prelude::*;
use serde::Deserialize;

/// What is cut into slabs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// What is seen around the pixel: a pass over one pixel in 64 more.
    #[default]
    Tiles,
    /// What bins of the frame's depth let through in the pixel: a geometry pass more.
    Pixel,
    /// From the pixel's nearest fragment to its farthest: a geometry pass more.
    Ends,
    /// That of the frame's transparent objects.
    Frame,
    /// From where the pixel's ray enters the first of the boxes around transparent parts to where it leaves the last: a pass over boxes.
    Boxes,
}

impl Source {
    pub const fn name(self) -> &'static str {
        ["tiles", "pixel", "ends", "frame", "boxes"][self as usize]
    }
}

/// From world space to where the box around a transparent part is the unit cube.
fn boxes(scene: &Scene) -> Vec<Mat4> {
    let objects = scene.objects.iter().flat_map(|object| {
        let transparent = (object.materials.iter().enumerate()).filter(|(_, m)| !m.is_opaque());
        let found = transparent.filter_map(|(part, _)| object.mesh.box_of(part));
        found.map(|object_from_unit| (object.world_from_object * object_from_unit).inverse())
    });
    objects.collect()
}

/// Where a ray from `origin` enters and leaves a box, in lengths of `direction`.
fn crossed(unit_from_world: &Mat4, origin: Vec3, direction: Vec3) -> Option<[f32; 2]> {
    let origin = unit_from_world.transform_point3(origin);
    let inverse = unit_from_world.transform_vector3(direction).recip();
    let (a, b) = (-origin * inverse, (1.0 - origin) * inverse);
    let enters = a.min(b).max_element().max(0.0);
    let leaves = a.max(b).min_element();
    (leaves >= enters).then_some([enters, leaves])
}

/// The extent of boxes at each pixel of a view that has fragments.
pub(super) fn of_boxes(view: &View, scene: &Scene, camera: &Camera, size: [u32; 2]) -> Vec<Extent> {
    let boxes = boxes(scene);
    let world_from_view = camera.view_from_world().inverse();
    let up = (camera.fov_y_degrees.to_radians() / 2.0).tan();
    let [width, height] = size.map(|s| s as f32);
    let of_place = |place: usize| {
        let [x, y] = [place % size[0] as usize, place / size[0] as usize];
        let across = 2.0 * (x as f32 + 0.5) / width - 1.0;
        let upward = 1.0 - 2.0 * (y as f32 + 0.5) / height;
        // Of length 1 along the view axis: lengths are linear depths.
        let direction = Vec3::new(across * up * width / height, upward * up, -1.0);
        let direction = world_from_view.transform_vector3(direction);
        let boxes = boxes.iter();
        let crossed = boxes.filter_map(|b| crossed(b, camera.position, direction));
        let zeta = |z: f32| view.warp.cut(z.clamp(camera.near, camera.far).into());
        let zetas: Vec<f64> = crossed.flatten().map(zeta).collect();
        if zetas.is_empty() {
            Extent::Among(Quantiles::EVEN)
        } else {
            Extent::Among(Quantiles::between(ends_of(zetas)))
        }
    };
    let stacks = view.stacks.par_iter();
    stacks.map(|stack| of_place(stack.place)).collect()
}

/// Quantiles of what is seen around each pixel of a view that has fragments.
pub(super) fn of_tiles(view: &View, size: [u32; 2]) -> Vec<Extent> {
    let pixel = |place: usize| [place as u32 % size[0], place as u32 / size[0]];
    let is_middle = |n: u32| n % TILE == TILE / 2;
    let stacks = view.stacks.iter();
    let stacks = stacks.filter(|s| pixel(s.place).into_iter().all(is_middle));
    let seen = stacks.map(|stack| {
        let points = slabs::points(&fragment::points(&stack.fragments), &view.warp);
        let tile = pixel(stack.place).map(|n| n / TILE);
        (tile, seen_behind_nearest(&points))
    });
    let tiles = Tiles::new(size, &seen.collect());
    let stacks = view.stacks.iter();
    let extents = stacks.map(|stack| Extent::Among(tiles.at(pixel(stack.place))));
    extents.collect()
}

/// The camera moved to its right, so that what it looks at moves by so many pixels of an image.
pub(super) fn moved(camera: &Camera, size: [u32; 2], pixels: f32) -> Camera {
    let toward = camera.target - camera.position;
    let right = toward.cross(camera.up).normalize_or(Vec3::X);
    let up = (camera.fov_y_degrees.to_radians() / 2.0).tan();
    let pixel = 2.0 * up * toward.length() / size[1] as f32;
    let by = right * (pixels * pixel);
    Camera {
        position: camera.position + by,
        target: camera.target + by,
        ..*camera
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_core::{absorbance::DepthWarp, fragment::Fragment};
    use peelnet_scene::Material;

    fn one(depth: f32) -> Vec<Fragment> {
        vec![Fragment::new(depth, 0.5, [1.0; 3])]
    }

    /// A box from 2 to 4 before the camera is crossed there, and nothing beside it.
    #[test]
    fn boxes_are_crossed_where_they_are() {
        let triangles = [-2.0, -4.0].map(|z| {
            let corners = [(-0.5, -0.5), (0.5, -0.5), (0.0, 0.5)];
            corners.map(|(x, y)| Vec3::new(x, y, z))
        });
        let material = Material::unlit([1.0; 3], 0.5);
        let object = peelnet_scene::Object::of_triangles("box", &triangles, material);
        let camera = crate::stage::camera([0.1, 100.0]);
        let scene = Scene::generated("s", "a test", [0.0; 3], camera, vec![object]);
        let warp = DepthWarp::new(1.0, 8.0);
        let view = View::new("s", warp, 9, [(4, one(3.0)), (0, one(3.0))]);
        let found = of_boxes(&view, &scene, &camera, [3, 3]);
        let margin = f64::from(2.0 * peelnet_scene::BOX_MARGIN);
        let ends = [2.0 - margin, 4.0 + margin].map(|z: f64| warp.apply(z));
        let expected = [Quantiles::between(ends_of(ends)), Quantiles::EVEN];
        assert_eq!(found, expected.map(Extent::Among));
    }
}
