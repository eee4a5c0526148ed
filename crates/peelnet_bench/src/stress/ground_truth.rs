//! What a scene's pixels hold, found on the CPU in 64 bits: the scan-line reference of [`peelnet_core::scanline`] and the shading of
//! [`peelnet_core::shading`]. Nothing of it comes from the renderer that is judged.

use super::trial::{Content, Kind, Truth};
use glam::{DMat4, DVec2, DVec3, DVec4};
use peelnet_core::{
    fragment::Fragment,
    scanline::{self, Hit},
    shading,
};
use peelnet_scene::{Camera, EFFECTS, Effect, Light, Lighting, Material, Object, Scene, Source};
use std::collections::BTreeMap;

/// How far a vertex may be snapped, in pixels: WebGPU's adapters have a sub-pixel grid of at least 4 bits, and take the nearest of its
/// points. Pixels that hold other surfaces within this distance are not compared.
const SNAP: f64 = 1.0 / 32.0;

/// What 32-bit shading may be off from 64-bit shading, relative to 1 or to what is brighter: interpolated normals are off by some
/// roundings, and a power multiplies the relative error of its base by its exponent, up to a hundred.
const SHADING: f64 = 1e-4;

/// What snapping may change of a pixel's colour before the pixel counts as an edge: two steps of an 8-bit display.
const LARGEST_UNCERTAINTY: f64 = 2.0 / 255.0;

/// A scene's triangles in a view's clip space, in 64 bits, numbered as the renderer numbers them.
pub fn clip_triangles(scene: &Scene, camera: &Camera, size: [u32; 2]) -> Vec<scanline::Triangle> {
    let clip = clip_from_world(camera, size);
    let mut triangles = Vec::new();
    for object in &scene.objects {
        for &triangle in &object.mesh.triangles {
            let vertices = world(object, triangle).map(|v| (clip * v.extend(1.0)).to_array());
            triangles.push(scanline::Triangle {
                clip: vertices,
                id: triangles.len() as u32,
            });
        }
    }
    triangles
}

pub fn light(light: &Light) -> shading::Light {
    shading::Light {
        source: match light.source {
            Source::Point(p) => shading::Source::Point(p.as_dvec3()),
            Source::Toward(d) => shading::Source::Toward(d.as_dvec3()),
        },
        color: DVec3::from(light.color.map(f64::from)) * f64::from(light.intensity),
    }
}

fn clip_from_world(camera: &Camera, size: [u32; 2]) -> DMat4 {
    let aspect = size[0] as f32 / size[1] as f32;
    camera.clip_from_view(aspect).as_dmat4() * camera.view_from_world().as_dmat4()
}

/// A triangle's vertices in world space, as they are uploaded.
fn world(object: &Object, triangle: [u32; 3]) -> [DVec3; 3] {
    let positions = triangle.map(|i| object.mesh.positions[i as usize]);
    positions.map(|p| object.world_from_object.transform_point3(p).as_dvec3())
}

/// What a view's pixels hold. Those on edges are not compared, nor those with materials that need textures.
pub(super) fn truth(scene: &Scene, camera: &Camera, size: [u32; 2]) -> Truth {
    let [width, height] = size.map(|n| n as usize);
    let triangles = clip_triangles(scene, camera, size);
    let view = View::new(scene, camera, size);
    // The pixel's centre, and what lies as far from it as vertices may be moved.
    let offsets = [-1.0, 0.0, 1.0].map(|x| [-1.0, 0.0, 1.0].map(|y| [SNAP * x, SNAP * y]));
    let mut offsets = offsets.concat();
    offsets.swap(0, 4);
    let frame = |&offset: &[f64; 2]| scanline::rasterise(&triangles, width, height, offset);
    let frames: Vec<scanline::Frame> = offsets.iter().map(frame).collect();
    let outlines = outlines(scene, camera, size);
    let mut truth = Truth::default();
    for (i, &outlined) in outlines.iter().enumerate() {
        let at = [i % width, i / width];
        let hits = |frame: usize| frames[frame].pixels[i].as_slice();
        let surfaces = |frame: usize| hits(frame).iter().map(|h| view.triangles[h.id as usize].0);
        let is_edge = outlined || (1..frames.len()).any(|k| !surfaces(k).eq(surfaces(0)));
        let kind = || {
            let mut kind = view.kind(hits(0), at, offsets[0])?;
            for (k, &offset) in offsets.iter().enumerate().skip(1) {
                let moved = view.kind(hits(k), at, offset)?;
                for (a, b) in kind.exact.iter().zip(moved.exact) {
                    kind.uncertainty = kind.uncertainty.max((a - b).abs());
                }
            }
            (kind.uncertainty <= LARGEST_UNCERTAINTY).then(|| {
                if view.lit {
                    kind.uncertainty += SHADING * kind.scale();
                }
                kind
            })
        };
        let content = if is_edge {
            Content::Unjudged
        } else if hits(0).is_empty() {
            Content::Nothing
        } else if let Some(kind) = kind() {
            truth.kinds.push(kind);
            Content::Kind(truth.kinds.len() as u32 - 1)
        } else {
            Content::Unjudged
        };
        truth.pixels.push(content);
    }
    truth
}

/// Which pixels' centres lie within [`SNAP`] of an edge that only one triangle of a mesh has: slivers pass between the offsets at which
/// pixels are compared.
fn outlines(scene: &Scene, camera: &Camera, size: [u32; 2]) -> Vec<bool> {
    let [width, height] = size.map(|n| n as usize);
    let extent = DVec2::new(width as f64, height as f64);
    let clip = clip_from_world(camera, size);
    let mut near_an_edge = vec![false; width * height];
    for object in &scene.objects {
        let mut edges: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        for t in &object.mesh.triangles {
            for [a, b] in [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]] {
                *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        for ([a, b], _) in edges.into_iter().filter(|(_, uses)| *uses == 1) {
            let [a, b, _] = world(object, [a, b, b]).map(|v| clip * v.extend(1.0));
            let Some([a, b]) = before_the_camera(a, b) else {
                continue;
            };
            let [a, b] =
                [a, b].map(|p| (DVec2::new(p.x, -p.y) / p.w * 0.5 + DVec2::splat(0.5)) * extent);
            let (first, last) = (a.min(b) - 1.0, a.max(b).min(extent));
            for y in first.y.max(0.0) as usize..last.y.max(0.0).ceil() as usize {
                for x in first.x.max(0.0) as usize..last.x.max(0.0).ceil() as usize {
                    let centre = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                    near_an_edge[y * width + x] |= distance(centre, a, b) <= SNAP;
                }
            }
        }
    }
    near_an_edge
}

/// The part of an edge behind the near plane (z ≥ 0 in clip space).
fn before_the_camera(a: DVec4, b: DVec4) -> Option<[DVec4; 2]> {
    let at_plane = || a + (b - a) * (a.z / (a.z - b.z));
    match (a.z >= 0.0, b.z >= 0.0) {
        (true, true) => Some([a, b]),
        (true, false) => Some([a, at_plane()]),
        (false, true) => Some([at_plane(), b]),
        (false, false) => None,
    }
}

fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let t = (p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    (p - a - along * t.clamp(0.0, 1.0)).length()
}

struct View<'a> {
    scene: &'a Scene,
    /// Of every triangle its object's number, and its own in the object's mesh.
    triangles: Vec<(usize, usize)>,
    lights: Vec<shading::Light>,
    lit: bool,
    eye: DVec3,
    world_from_clip: DMat4,
    size: [u32; 2],
}

impl<'a> View<'a> {
    fn new(scene: &'a Scene, camera: &Camera, size: [u32; 2]) -> Self {
        let numbered = scene.objects.iter().enumerate();
        let all = numbered.flat_map(|(i, o)| (0..o.mesh.triangles.len()).map(move |t| (i, t)));
        let materials = || scene.objects.iter().flat_map(|o| &o.materials);
        Self {
            scene,
            triangles: all.collect(),
            lights: scene.lights.iter().map(light).collect(),
            lit: materials().any(|m| m.lighting != Lighting::Unlit),
            eye: camera.position.as_dvec3(),
            world_from_clip: clip_from_world(camera, size).inverse(),
            size,
        }
    }

    /// What a pixel with these hits shows; `None` if one of its surfaces cannot be shaded here.
    fn kind(&self, hits: &[Hit], at: [usize; 2], offset: [f64; 2]) -> Option<Kind> {
        let (mut fragments, mut background) = (Vec::new(), self.scene.background);
        for hit in hits {
            let (object, triangle) = self.triangles[hit.id as usize];
            let object = &self.scene.objects[object];
            let material = material(object, triangle)?;
            let color = self.shade(hit, object, triangle, material, at, offset)?;
            if material.is_opaque() {
                background = color;
                break;
            }
            fragments.push(Fragment {
                triangle: hit.id,
                ..Fragment::new(hit.depth as f32, material.alpha, color)
            });
        }
        let name = format!("{} at ({}, {})", self.scene.name, at[0], at[1]);
        Some(Kind::new(name, fragments, background))
    }

    /// The radiance of a surface at a hit; `None` of one with textures, or with an
    /// effect that a number switches on, as emission.
    fn shade(
        &self,
        hit: &Hit,
        object: &Object,
        triangle: usize,
        material: &Material,
        at: [usize; 2],
        offset: [f64; 2],
    ) -> Option<[f32; 3]> {
        let maps = &material.maps;
        let mapped = maps.color.is_some() || maps.normal.is_some();
        let mapped = mapped || !object.mesh.colors.is_empty();
        let mut numbers = EFFECTS.iter().filter_map(Effect::number);
        if mapped || numbers.any(|number| !number.is_zero(material)) {
            return None;
        }
        if material.lighting == Lighting::Unlit {
            return Some(material.color);
        }
        let ndc = |k: usize| (at[k] as f64 + 0.5 + offset[k]) / f64::from(self.size[k]) * 2.0 - 1.0;
        let w = hit.depth;
        let clip = DVec4::new(ndc(0) * w, -ndc(1) * w, hit.window_depth * w, w);
        let position = (self.world_from_clip * clip).truncate();
        let view = (self.eye - position).normalize();
        let normal = normal(object, object.mesh.triangles[triangle], position);
        // As in the shader: where vertices' normals cancel, the view direction stands in.
        let normal = normal.unwrap_or(view);
        let point = shading::Point {
            position,
            normal,
            eye: self.eye,
            ambient: 1.0,
        };
        let color = DVec3::from(material.color.map(f64::from));
        let radiance = match material.lighting {
            Lighting::Phong => {
                let (strength, exponent) = (material.specular.into(), material.shininess.into());
                shading::phong(&point, color, strength, exponent, &self.lights)
            }
            _ => {
                let (metallic, roughness) = (material.metallic.into(), material.roughness.into());
                shading::physically_based(&point, color, metallic, roughness, &self.lights)
            }
        };
        Some(radiance.to_array().map(|c| c as f32))
    }
}

fn material(object: &Object, triangle: usize) -> Option<&Material> {
    let mut parts = object.mesh.parts.iter();
    let part = parts.position(|p| p.triangles.contains(&triangle))?;
    object.materials.get(part)
}

/// The interpolated unit normal at a point of a triangle, world space; `None` where it vanishes.
fn normal(object: &Object, triangle: [u32; 3], at: DVec3) -> Option<DVec3> {
    let [a, b, c] = world(object, triangle);
    let turn = object.world_from_object.inverse().transpose();
    let normals = triangle.map(|i| {
        let n = turn.transform_vector3(object.mesh.normals[i as usize]);
        n.normalize_or_zero().as_dvec3()
    });
    let plane = (b - a).cross(c - a);
    let area = plane.length_squared();
    let weights = if area > 0.0 {
        let part = |from: DVec3, to: DVec3| (to - from).cross(at - from).dot(plane) / area;
        [part(b, c), part(c, a), part(a, b)]
    } else {
        [1.0 / 3.0; 3]
    };
    let sum: DVec3 = normals.iter().zip(weights).map(|(n, w)| *n * w).sum();
    (sum.length_squared() > 1e-20).then(|| sum.normalize())
}

#[cfg(test)]
mod tests {
    use super::{
        super::{CASES, Work},
        *,
    };

    /// Most pixels that hold fragments are judged, in every case whose pixels are not known beforehand; but not those of slivers, which
    /// are all edges.
    #[test]
    fn most_pixels_are_judged() {
        for case in CASES {
            let Work::Frames(make) = case.work else {
                continue;
            };
            for trial in make() {
                let truth = trial.truth();
                let count =
                    |is: fn(&Content) -> bool| truth.pixels.iter().filter(|c| is(c)).count();
                let kinds = count(|c| matches!(c, Content::Kind(_)));
                let unjudged = count(|c| *c == Content::Unjudged);
                let least = match case.id {
                    "grazing" => unjudged / 4,
                    _ => unjudged,
                };
                let all = kinds + unjudged;
                assert!(kinds >= least, "{}: {kinds} of {all}", case.id);
            }
        }
    }
}
