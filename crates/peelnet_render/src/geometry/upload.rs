//! Vertices and their attributes in world space, and runs of triangles that one pipeline draws.

use crate::gpu::wgpu::{self, vertex_attr_array};
use bytemuck::{Pod, Zeroable};
use peelnet_scene::{MaterialFlags, Object};
use std::ops::Range;

/// One vertex of a triangle. Every triangle has three of its own: `vertex_index / 3` is then the triangle's index in the scene's
/// list, which portable WebGPU has no other way to learn. Passes that do not ask for it draw by [`Placement::shared`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct Vertex {
    pub position: [f32; 3],
    pub material: u32,
}

/// What only some materials read of a vertex, each in a buffer of its own: name, place and format, the shader feature that reads it.
pub(crate) const ATTRIBUTES: &[(&str, [wgpu::VertexAttribute; 1], &str)] = &[
    ("uv", vertex_attr_array![2 => Float32x2], "mapped"),
    ("tangent", vertex_attr_array![3 => Float32x4], "normal_map"),
    ("color", vertex_attr_array![4 => Float32x4], "vertex_colors"),
    ("normal", vertex_attr_array![5 => Float32x3], "lit"),
    ("splat", vertex_attr_array![6 => Uint32], "splat"),
];

/// What a run of vertices has of each of [`ATTRIBUTES`].
pub(crate) type Attributes = [Vec<f32>; 5];

/// How many vertices that stand for one of the mesh are compared: of more, some are drawn as vertices of their own.
const MOST_COMPARED: usize = 8;

/// A run of triangles that one pipeline draws.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct DrawRun {
    pub vertices: Range<u32>,
    pub variant: MaterialFlags,
    /// Number of its textures' set.
    pub maps: Option<usize>,
}

/// Appends a run, joining it with the one before where the same pipeline draws both.
pub(crate) fn push_run(runs: &mut Vec<DrawRun>, run: DrawRun) {
    if run.vertices.is_empty() {
        return;
    }
    let same = |last: &DrawRun| (last.variant, last.maps) == (run.variant, run.maps);
    match runs.last_mut() {
        Some(last) if same(last) && last.vertices.end == run.vertices.start => {
            last.vertices.end = run.vertices.end;
        }
        _ => runs.push(run),
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Placement<'a> {
    object: &'a Object,
    normal_matrix: glam::Mat3,
    /// Whether it is turned inside out.
    pub mirrored: bool,
}

impl<'a> Placement<'a> {
    pub fn from_object(object: &'a Object) -> Self {
        let linear = glam::Mat3::from_mat4(object.world_from_object);
        Self {
            object,
            normal_matrix: linear.inverse().transpose(),
            mirrored: linear.determinant() < 0.0,
        }
    }

    /// The order of a triangle's vertices. A mirrored object turns its triangles inside out: turned back, culling stays right.
    const fn order(&self) -> [usize; 3] {
        if self.mirrored { [0, 2, 1] } else { [0, 1, 2] }
    }

    fn indices(&self, triangles: Range<usize>) -> impl Iterator<Item = usize> {
        let order = self.order();
        self.object.mesh.triangles[triangles]
            .iter()
            .flat_map(move |t| order.map(|k| t[k] as usize))
    }

    pub fn vertices(&self, triangles: Range<usize>, material: u32) -> impl Iterator<Item = Vertex> {
        let world = self.object.world_from_object;
        let positions = &self.object.mesh.positions;
        self.indices(triangles).map(move |i| Vertex {
            position: world.transform_point3(positions[i]).to_array(),
            material,
        })
    }

    /// What a variant reads of these vertices, in the order of [`ATTRIBUTES`]; empty where it reads nothing. `first_splat` is the number of the
    /// object's first splat in the scene.
    pub fn attributes(
        &self,
        triangles: &Range<usize>,
        variant: MaterialFlags,
        first_splat: u32,
    ) -> Attributes {
        let mesh = &self.object.mesh;
        let order = self.order();
        let mut all: Attributes = Default::default();
        let [uvs, tangents, colors, normals, splats] = &mut all;
        if variant.contains(MaterialFlags::MAPPED) && !mesh.uvs.is_empty() {
            let of = mesh.uvs[triangles.clone()].iter();
            uvs.extend(of.flat_map(|t| order.map(|k| t[k].to_array())).flatten());
        }
        if variant.contains(MaterialFlags::NORMAL_MAP) {
            // Tangents turn with the surface, and over with a mirror.
            let sign = if self.mirrored { -1.0 } else { 1.0 };
            let world = self.object.world_from_object;
            let turned = |[x, y, z, w]: [f32; 4]| {
                let tangent = world.transform_vector3(glam::Vec3::new(x, y, z));
                let [x, y, z] = tangent.normalize_or_zero().to_array();
                [x, y, z, w * sign]
            };
            if let Some(found) = mesh.tangents(triangles.clone()) {
                let of = found.iter().flat_map(|t| order.map(|k| turned(t[k])));
                tangents.extend(of.flatten());
            }
        }
        if variant.contains(MaterialFlags::VERTEX_COLORS) {
            colors.extend(self.indices(triangles.clone()).flat_map(|i| mesh.colors[i]));
        }
        if variant.contains(MaterialFlags::LIT) {
            let turned = |i: usize| (self.normal_matrix * mesh.normals[i]).normalize_or_zero();
            let of = self.indices(triangles.clone());
            normals.extend(of.flat_map(|i| turned(i).to_array()));
        }
        if variant.contains(MaterialFlags::SPLAT) {
            let numbers = self.indices(triangles.clone());
            // The bits of whole numbers, as all others are floats.
            splats.extend(numbers.map(|i| f32::from_bits(first_splat + i as u32)));
        }
        all
    }

    /// For every vertex of a run of triangles the number of the first one that is the same: one vertex of the mesh, with the same UVs
    /// and tangents where `attributes` has them. `begin` is the number of the run's first vertex.
    ///
    /// Drawn by these numbers a vertex is transformed about once, and not once for each of its triangles.
    pub fn shared(
        &self,
        triangles: &Range<usize>,
        attributes: &Attributes,
        begin: usize,
    ) -> Vec<u32> {
        if self.object.mesh.splats.is_some() {
            // Which of its triangle's corners it is follows from a vertex's number.
            return (begin as u32..).take(3 * triangles.len()).collect();
        }
        let same = |a: usize, b: usize| {
            attributes.iter().enumerate().take(2).all(|(k, all)| {
                let bits = |i: usize| {
                    let own = all.iter().skip(i * floats(k)).take(floats(k));
                    own.map(|x| x.to_bits())
                };
                bits(a).eq(bits(b))
            })
        };
        let of_mesh: Vec<usize> = self.indices(triangles.clone()).collect();
        // Of every vertex of the mesh the latest one found that stands for it, counted from 1; 0 for none: memory that is never touched
        // costs nothing.
        let mut latest = vec![0u32; self.object.mesh.positions.len()];
        // Of each that stands for a vertex of the mesh the one found before it, counted from 1.
        let mut before = vec![0u32; of_mesh.len()];
        let mut numbers = Vec::with_capacity(of_mesh.len());
        for (here, &i) in of_mesh.iter().enumerate() {
            let place = |counted: u32| (counted as usize).checked_sub(1);
            let mut known =
                std::iter::successors(place(latest[i]), |&k| place(before[k])).take(MOST_COMPARED);
            let found = known.find(|&k| same(k, here));
            if found.is_none() {
                before[here] = std::mem::replace(&mut latest[i], here as u32 + 1);
            }
            numbers.push((begin + found.unwrap_or(here)) as u32);
        }
        numbers
    }
}

/// Floats of one vertex's attribute.
pub(crate) fn floats(attribute: usize) -> usize {
    ATTRIBUTES[attribute].1[0].format.size() as usize / 4
}

/// Adds the attributes of a part whose first vertex is `first`, behind zeros where nothing reads a vertex's.
pub(crate) fn extend(all: &mut Attributes, first: usize, part: Attributes) {
    for (i, (all, part)) in all.iter_mut().zip(part).enumerate() {
        if !part.is_empty() {
            all.resize(first * floats(i), 0.0);
            all.extend(part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use peelnet_scene::Material;

    fn object(positions: Vec<glam::Vec3>, triangles: Vec<[u32; 3]>) -> Object {
        let mut object = Object::of_triangles("test", &[], Material::unlit([1.0; 3], 0.5));
        let mesh = std::sync::Arc::make_mut(&mut object.mesh);
        mesh.normals = vec![glam::Vec3::Z; positions.len()];
        (mesh.positions, mesh.triangles) = (positions, triangles);
        object
    }

    /// Two triangles of four vertices share two of them, unless an attribute differs there; mirrored ones turn round, and the numbers
    /// follow.
    #[test]
    fn the_same_vertices_are_shared() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let points = points.map(|[x, y]| glam::Vec3::new(x, y, 0.0));
        let mut object = object(points.to_vec(), vec![[0, 1, 2], [2, 1, 3]]);
        let shared = |object: &Object, attributes: &Attributes| {
            Placement::from_object(object).shared(&(0..2), attributes, 30)
        };
        let mut attributes: Attributes = Default::default();
        assert_eq!(shared(&object, &attributes), [30, 31, 32, 32, 31, 35]);
        // UVs of the corners in turn: at a seam vertex 2 has others in the second triangle.
        attributes[0] = [0.0, 1.0, 2.0, 2.5, 1.0, 3.0].map(|u| [u, 0.0]).concat();
        assert_eq!(shared(&object, &attributes), [30, 31, 32, 33, 31, 35]);
        attributes[0].clear();
        // Of tangents the last number may differ alone.
        attributes[1] = [1.0, 1.0, 1.0, 1.0, -1.0, 1.0]
            .map(|w| [1.0, 0.0, 0.0, w])
            .concat();
        assert_eq!(shared(&object, &attributes), [30, 31, 32, 32, 34, 35]);
        attributes[1].clear();
        // The second triangle is 2, 3, 1 then, and the first one 0, 2, 1.
        object.world_from_object = glam::Mat4::from_scale(glam::Vec3::new(-1.0, 1.0, 1.0));
        assert_eq!(shared(&object, &attributes), [30, 31, 32, 31, 34, 32]);
    }

    /// A fan whose middle has other UVs in every triangle, and twice: what stands for a vertex is the same, however many there are.
    #[test]
    fn vertices_of_many_seams_stay_themselves() {
        let object = object(vec![glam::Vec3::ZERO; 3], vec![[0, 1, 2]; 60]);
        let mut attributes: Attributes = Default::default();
        let uv = |corner: usize| {
            [
                (corner / 3 % 30 * usize::from(corner.is_multiple_of(3))) as f32,
                0.5,
            ]
        };
        attributes[0] = (0..180).flat_map(uv).collect();
        let numbers = Placement::from_object(&object).shared(&(0..60), &attributes, 0);
        for (corner, &number) in numbers.iter().enumerate() {
            let number = number as usize;
            assert_eq!((number % 3, uv(number)), (corner % 3, uv(corner)));
        }
        assert_eq!(numbers[1..3], [1, 2]);
        assert!(numbers.chunks(3).all(|t| t[1..] == [1, 2]));
    }

    #[test]
    fn runs_join_where_they_can() {
        let material = Material::unlit([1.0; 3], 0.5);
        let object = Object::of_triangles("none", &[], material.clone());
        let two_sided = MaterialFlags::new(&material, &object, MaterialFlags::empty());
        let culled = two_sided | MaterialFlags::CULLED;
        let mut runs = Vec::new();
        for (vertices, variant, maps) in [
            (0..3, two_sided, None),
            (3..9, two_sided, None),
            (9..12, culled, None),
            (12..12, culled, None),
            (15..18, culled, None),
            (18..21, culled, Some(0)),
            (21..24, culled, Some(0)),
        ] {
            let run = DrawRun {
                vertices,
                variant,
                maps,
            };
            push_run(&mut runs, run);
        }
        let vertices: Vec<_> = runs.iter().map(|r| r.vertices.clone()).collect();
        assert_eq!(vertices, [0..9, 9..12, 15..18, 18..24]);
    }
}
