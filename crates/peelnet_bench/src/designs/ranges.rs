//! Where a pixel's scale of depth may come from, beside its own surfaces and the frame.

use super::views::View;
use glam::{Mat4, Vec3};
use peelnet_core::{
    absorbance::absorbance,
    methods::slabs::{Extent, ends_of},
};
use peelnet_scene::{Camera, Scene};
use rayon::prelude::*;
use serde::Deserialize;

/// What is cut into slabs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// What bins of the frame's depth let through in the pixel: a geometry pass more.
    #[default]
    Pixel,
    /// From the pixel's nearest fragment to its farthest: a geometry pass more.
    Ends,
    /// That of the frame's transparent objects.
    Frame,
    /// From where the pixel's ray enters the first of the boxes around transparent parts to where it leaves the last: a pass over boxes.
    Boxes,
    /// From the nearest to the farthest of all fragments that the frame before had within [`REACH`] pixels; the frame's where it had none.
    Last,
    /// The frame's, on a scale half way between that of depth and the distribution of the frame's absorbance over it.
    Quantiles,
}

impl Source {
    pub const fn name(self) -> &'static str {
        ["pixel", "ends", "frame", "boxes", "last", "quantiles"][self as usize]
    }
}

/// How far the last frame's range is spread, pixels along a row or a column.
pub const REACH: usize = 2;

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
            Extent::Frame
        } else {
            Extent::Given(ends_of(zetas))
        }
    };
    let stacks = view.stacks.par_iter();
    stacks.map(|stack| of_place(stack.place)).collect()
}

/// The extent of the frame before at each pixel of a view that has fragments.
pub(super) fn of_last(view: &View, before: &View, width: usize, height: usize) -> Vec<Extent> {
    // The nearest and the farthest depth, spread along rows, then along columns.
    let mut ends = vec![[f32::INFINITY, f32::NEG_INFINITY]; width * height];
    for stack in &before.stacks {
        let [first, last] = [stack.fragments.first(), stack.fragments.last()];
        if let (Some(first), Some(last)) = (first, last) {
            ends[stack.place] = [first.depth, last.depth];
        }
    }
    let spread =
        |from: &[[f32; 2]], count: usize, step: usize, of_pixel: &dyn Fn(usize) -> usize| {
            let pixels = (0..from.len()).map(|i| {
                let at = of_pixel(i);
                let near = at.saturating_sub(REACH)..(at + REACH + 1).min(count);
                near.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], k| {
                    let [l, h] = from[i + k * step - at * step];
                    [low.min(l), high.max(h)]
                })
            });
            pixels.collect::<Vec<_>>()
        };
    let ends = spread(&ends, width, 1, &|i| i % width);
    let ends = spread(&ends, height, width, &|i| i / width);
    let of_place = |place: usize| match ends[place] {
        ends @ [low, high] if low <= high => {
            Extent::Given(ends_of(ends.map(|z| view.warp.cut(z.into()))))
        }
        _ => Extent::Frame,
    };
    let stacks = view.stacks.iter();
    stacks.map(|stack| of_place(stack.place)).collect()
}

/// Bins of the distribution of a frame's absorbance over depth.
const BINS: usize = 256;

/// A scale of depth half way to the distribution of the frame's absorbance.
pub(super) struct Quantiles {
    /// The share of the absorbance in front of each bin, and 1.
    before: Vec<f64>,
}

impl Quantiles {
    pub fn from_view(view: &View) -> Self {
        let mut bins = vec![0.0; BINS];
        for f in view.stacks.iter().flat_map(|stack| &stack.fragments) {
            let t = 0.5 + 0.5 * view.warp.cut(f.depth.into());
            bins[((t * BINS as f64) as usize).min(BINS - 1)] += absorbance(f.alpha);
        }
        let total: f64 = bins.iter().sum();
        let mut before = vec![0.0];
        for bin in bins {
            before.push(before[before.len() - 1] + bin / total.max(f64::MIN_POSITIVE));
        }
        Self { before }
    }

    /// Where a warped depth lies on it, −1 … 1.
    pub fn apply(&self, zeta: f64) -> f64 {
        let t = 0.5 + 0.5 * zeta;
        let bin = ((t * BINS as f64) as usize).min(BINS - 1);
        let [from, to] = [self.before[bin], self.before[bin + 1]];
        let share = from + (to - from) * (t * BINS as f64 - bin as f64);
        t + share - 1.0
    }
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
        assert_eq!(found, [Extent::Given(ends_of(ends)), Extent::Frame]);
    }

    /// A fragment of the frame before is seen two pixels further, and not three.
    #[test]
    fn the_last_frame_is_spread() {
        let warp = DepthWarp::new(1.0, 8.0);
        let before = View::new("s", warp, 64, [(0, one(3.0)), (8 + 1, one(5.0))]);
        let lists = [2, 3, 4, 16].map(|place| (place, one(3.0)));
        let view = View::new("s", warp, 64, lists);
        let of = |ends: [f64; 2]| Extent::Given(ends_of(ends.map(|z| warp.apply(z))));
        let found = of_last(&view, &before, 8, 8);
        let both = of([3.0, 5.0]);
        assert_eq!(found, [both, of([5.0; 2]), Extent::Frame, both]);
    }

    /// Where all absorbance lies at one depth, that depth is the middle of half of the scale.
    #[test]
    fn quantiles_follow_absorbance() {
        let warp = DepthWarp::new(1.0, 4.0);
        let view = View::new("s", warp, 1, [(0, one(2.0))]);
        let quantiles = Quantiles::from_view(&view);
        // ζ of 2 is 0, at the beginning of bin 128.
        for (zeta, expected) in [
            (-1.0, -1.0),
            (-0.5, -0.75),
            (0.0, -0.5),
            (1.0 / 128.0, 0.5 + 1.0 / 256.0),
            (1.0, 1.0),
        ] {
            let off = quantiles.apply(zeta) - expected;
            assert!(off.abs() < 1e-9, "{zeta} is off by {off}");
        }
    }
}
