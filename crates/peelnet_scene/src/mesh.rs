use crate::{material::Material, splats::Splats, texture::Maps, warnings::Warnings};
use bevy_mikktspace::TangentSpace;
use glam::{Mat4, Vec2, Vec3};
use peelnet_core::files::printable;
use std::{collections::HashMap, ops::Range};

/// By how much [`Mesh::box_of`] is larger than what it holds on either side, of its longest side: rounding must not miss a flat part.
pub const BOX_MARGIN: f32 = 1e-3;

/// Triangles with a normal at every vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, object space.
    pub positions: Vec<Vec3>,
    /// Unit normals, one for each position.
    pub normals: Vec<Vec3>,
    /// Linear RGB and alpha that multiply the material's, one for each position; empty where there are none.
    pub colors: Vec<[f32; 4]>,
    /// UVs, stored per triangle vertex, so that a UV seam does not split smooth normals: u to the right, v down, 0 … 1 over the texture.
    /// Empty where there are none.
    pub uvs: Vec<[Vec2; 3]>,
    /// Indices of three vertices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Runs of triangles that share a material; together they cover all triangles in order.
    pub parts: Vec<Part>,
    /// Splats instead of a surface: triangle i is `[i, i, i]`, around which splat i is drawn.
    pub splats: Option<Splats>,
}

/// A run of triangles of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Name of the group or object in the mesh file.
    pub name: String,
    /// Indices into [`Mesh::triangles`].
    pub triangles: Range<usize>,
    /// The material of the mesh file. Objects have their own, see [`crate::Object::materials`].
    pub material: Material,
}

impl Mesh {
    /// The same triangles as one part.
    pub(crate) fn into_part(self, name: impl Into<String>, material: Material) -> Self {
        Self {
            parts: vec![Part {
                name: name.into(),
                triangles: 0..self.triangles.len(),
                material,
            }],
            ..self
        }
    }

    /// Appends a mesh of one part. Where that has maps and no UVs, its maps are dropped, with a warning behind the name of the file. A mesh is of
    /// triangles or of splats: one of the other kind is left out, with a warning.
    pub(crate) fn append(&mut self, mut other: Self, file: &str, warnings: &mut Warnings) {
        if !self.parts.is_empty() && self.splats.is_some() != other.splats.is_some() {
            let [what, beside] = match other.splats {
                Some(_) => ["splats", "triangles"],
                None => ["triangles", "splats"],
            };
            let before = format!("{file}{what} beside {beside} (");
            for part in &other.parts {
                let name = format!("'{}'", printable(&part.name));
                warnings.about(&before, &name, "); give them a file of their own");
            }
            return;
        }
        for part in &mut other.parts {
            if other.uvs.is_empty() && part.material.maps.has_any() {
                part.material.maps = Maps::NONE;
                let name = format!("'{}'", printable(&part.name));
                let after = " with textures and no texture coordinates: plain values are drawn";
                warnings.about(file, &name, after);
            }
        }
        if self.parts.is_empty() {
            // Not copied: most large files are one part.
            *self = other;
            return;
        }
        let (base, first) = (self.positions.len(), self.triangles.len());
        let (vertices, triangles) = (other.positions.len(), other.triangles.len());
        let moved = |t: [u32; 3]| t.map(|i| i + base as u32);
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        if let Some((own, other)) = self.splats.as_mut().zip(other.splats) {
            own.append(other);
        }
        self.triangles
            .extend(other.triangles.into_iter().map(moved));
        append_some(&mut self.colors, other.colors, [base, vertices], [1.0; 4]);
        append_some(
            &mut self.uvs,
            other.uvs,
            [first, triangles],
            [Vec2::ZERO; 3],
        );
        self.parts.extend(other.parts.into_iter().map(|part| Part {
            triangles: first + part.triangles.start..first + part.triangles.end,
            ..part
        }));
    }

    /// The same triangles, each with vertices and a normal of its own. Splats stay as they are.
    pub(crate) fn flat(self) -> Self {
        if self.splats.is_some() {
            return self;
        }
        let corners = || self.triangles.as_flattened().iter().map(|&i| i as usize);
        let normal = |t: &[u32; 3]| area_of(&self.positions, *t).normalize_or(Vec3::Z);
        let numbers = 0..self.triangles.len() as u32;
        Self {
            positions: corners().map(|i| self.positions[i]).collect(),
            normals: self.triangles.iter().flat_map(|t| [normal(t); 3]).collect(),
            colors: corners()
                .filter_map(|i| self.colors.get(i).copied())
                .collect(),
            triangles: numbers.map(|i| [0, 1, 2].map(|k| 3 * i + k)).collect(),
            ..self
        }
    }

    /// Drops the vertices that no triangle uses.
    pub(crate) fn keep_used(&mut self) {
        let mut numbers = vec![None; self.positions.len()];
        let mut used = Vec::new();
        for i in self.triangles.as_flattened_mut() {
            let old = *i;
            *i = *numbers[old as usize].get_or_insert_with(|| {
                used.push(old as usize);
                used.len() as u32 - 1
            });
        }
        self.positions = used.iter().map(|&i| self.positions[i]).collect();
        self.normals = used.iter().map(|&i| self.normals[i]).collect();
        if !self.colors.is_empty() {
            self.colors = used.iter().map(|&i| self.colors[i]).collect();
        }
        if let Some(splats) = &mut self.splats {
            splats.keep(&used);
        }
    }

    /// Tangents of a run of triangles, for normal maps: direction of u, and 1 or −1 where v runs against or along normal × tangent,
    /// by MikkTSpace (Mikkelsen 2008), which bakers of normal maps use. `None` without UVs.
    pub fn tangents(&self, triangles: Range<usize>) -> Option<Vec<[[f32; 4]; 3]>> {
        if self.uvs.is_empty() {
            return None;
        }
        let mut geometry = Tangents {
            mesh: self,
            first: triangles.start,
            found: vec![[[1.0, 0.0, 0.0, 1.0]; 3]; triangles.len()],
        };
        // It fails on meshes without triangles only.
        let _ = bevy_mikktspace::generate_tangents(&mut geometry);
        Some(geometry.found)
    }

    /// The same mesh with vertex colours by height, from the lowest vertex to the highest. Splats, which have colours, stay as they are.
    pub(crate) fn colored_by_height(&self, [low, high]: [[f32; 4]; 2]) -> Self {
        if self.splats.is_some() {
            return self.clone();
        }
        let (bottom, top) = self.bounds().unwrap_or_default();
        let of = |p: &Vec3| {
            let t = ((p.y - bottom.y) / (top.y - bottom.y).max(1e-12)).clamp(0.0, 1.0);
            [0, 1, 2, 3].map(|k| low[k] + t * (high[k] - low[k]))
        };
        Self {
            colors: self.positions.iter().map(of).collect(),
            ..self.clone()
        }
    }

    /// The same surface with every triangle cut into four at the middles of its edges. Normals are interpolated, so shading stays as it was.
    /// Splats, which have no edges, stay as they are.
    pub fn subdivided(&self) -> Self {
        let mut mesh = self.clone();
        if mesh.splats.is_some() {
            return mesh;
        }
        mesh.triangles = Vec::with_capacity(4 * self.triangles.len());
        mesh.uvs.clear();
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        for (i, t) in self.triangles.iter().enumerate() {
            let edges = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
            let m = edges.map(|[a, b]| {
                *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    let [a, b] = [a as usize, b as usize];
                    mesh.positions
                        .push((mesh.positions[a] + mesh.positions[b]) / 2.0);
                    let normal = mesh.normals[a] + mesh.normals[b];
                    mesh.normals.push(normal.normalize_or(mesh.normals[a]));
                    if !mesh.colors.is_empty() {
                        let mixed = |k: usize| (mesh.colors[a][k] + mesh.colors[b][k]) / 2.0;
                        let mixed = [0, 1, 2, 3].map(mixed);
                        mesh.colors.push(mixed);
                    }
                    mesh.positions.len() as u32 - 1
                })
            });
            mesh.triangles.extend([
                [t[0], m[0], m[2]],
                [m[0], t[1], m[1]],
                [m[2], m[1], t[2]],
                [m[0], m[1], m[2]],
            ]);
            if let Some([a, b, c]) = self.uvs.get(i).copied() {
                let [ab, bc, ca] = [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0];
                mesh.uvs
                    .extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
        }
        for part in &mut mesh.parts {
            part.triangles = 4 * part.triangles.start..4 * part.triangles.end;
        }
        mesh
    }

    /// The box around all vertices that triangles use, or around all splats as far as they reach; `None` without any.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.bounds_of(0..self.triangles.len())
    }

    fn bounds_of(&self, triangles: Range<usize>) -> Option<(Vec3, Vec3)> {
        let triangles = &self.triangles[triangles];
        let around = |(lo, hi): (Vec3, Vec3), (a, b): (Vec3, Vec3)| (lo.min(a), hi.max(b));
        if let Some(splats) = &self.splats {
            let boxes = triangles.iter().map(|&[i, ..]| {
                let reach = Vec3::splat(splats.reach(i as usize));
                let center = self.positions[i as usize];
                (center - reach, center + reach)
            });
            return boxes.reduce(around);
        }
        let vertices = triangles.iter().flatten();
        let mut vertices = vertices.map(|&i| self.positions[i as usize]);
        let first = vertices.next()?;
        Some(vertices.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p))))
    }

    /// The box that shows what a mesh is: of splats, which files have far away too, that between the 2nd and 98th percentile of their centres.
    pub(crate) fn main_bounds(&self) -> Option<(Vec3, Vec3)> {
        if self.splats.is_none() || self.positions.is_empty() {
            return self.bounds();
        }
        let last = self.positions.len() - 1;
        let mut ends = [Vec3::ZERO; 2];
        for axis in 0..3 {
            let mut all: Vec<f32> = self.positions.iter().map(|p| p[axis]).collect();
            for (end, place) in ends.iter_mut().zip([last / 50, last - last / 50]) {
                end[axis] = *all.select_nth_unstable_by(place, f32::total_cmp).1;
            }
        }
        Some((ends[0], ends[1]))
    }

    /// From the unit cube, 0 … 1, to the box around a part, which is larger by [`BOX_MARGIN`]; `None` of a part that covers nothing.
    pub fn box_of(&self, part: usize) -> Option<Mat4> {
        let (low, high) = self.bounds_of(self.parts[part].triangles.clone())?;
        let margin = Vec3::splat(BOX_MARGIN * (high - low).max_element());
        let sides = high - low + 2.0 * margin;
        let some = sides.min_element() > 0.0;
        some.then(|| Mat4::from_translation(low - margin) * Mat4::from_scale(sides))
    }
}

/// Appends a list to another, either of which may be empty where it should have `counts` values: it has `default` ones then.
fn append_some<T: Copy>(all: &mut Vec<T>, more: Vec<T>, [before, count]: [usize; 2], default: T) {
    if !all.is_empty() || !more.is_empty() {
        all.resize(before, default);
        all.extend(more);
        all.resize(before + count, default);
    }
}

/// A run of triangles as MikkTSpace reads it, and the tangents that it writes.
struct Tangents<'a> {
    mesh: &'a Mesh,
    first: usize,
    found: Vec<[[f32; 4]; 3]>,
}

impl bevy_mikktspace::Geometry for Tangents<'_> {
    fn num_faces(&self) -> usize {
        self.found.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, vertex: usize) -> [f32; 3] {
        let i = self.mesh.triangles[self.first + face][vertex];
        self.mesh.positions[i as usize].to_array()
    }

    fn normal(&self, face: usize, vertex: usize) -> [f32; 3] {
        let i = self.mesh.triangles[self.first + face][vertex];
        self.mesh.normals[i as usize].to_array()
    }

    fn tex_coord(&self, face: usize, vertex: usize) -> [f32; 2] {
        // The second tangent points up the texture, against v.
        let uv = self.mesh.uvs[self.first + face][vertex];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, vertex: usize) {
        // UVs that hardly differ, or whose area underflows, have no direction.
        let tangent = tangent.map(|t| t.tangent_encoded());
        if let Some(tangent) = tangent.filter(|t| t.iter().all(|x| x.is_finite())) {
            self.found[face][vertex] = tangent;
        }
    }
}

/// A triangle's normal, twice as long as its area.
pub(crate) fn area_of(positions: &[Vec3], triangle: [u32; 3]) -> Vec3 {
    let [a, b, c] = triangle.map(|i| positions[i as usize]);
    (b - a).cross(c - a)
}

/// Smooth normals: the sum of the adjacent triangles' area vectors, so that large triangles count more. A vertex whose
/// triangles have no area gets +z, never NaN.
pub(crate) fn smooth_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; positions.len()];
    for t in triangles {
        let area = area_of(positions, *t);
        for &i in t {
            sums[i as usize] += area;
        }
    }
    sums.into_iter().map(|n| n.normalize_or(Vec3::Z)).collect()
}

/// A position as a key; −0 and 0 are one.
pub(crate) fn key_of(p: Vec3) -> [u32; 3] {
    p.to_array().map(|x| (x + 0.0).to_bits())
}

/// How often each edge, by the positions of its ends, is one of a triangle.
#[cfg(test)]
pub(crate) fn edges_of(mesh: &Mesh) -> HashMap<[[u32; 3]; 2], usize> {
    let mut edges = HashMap::new();
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| key_of(mesh.positions[i as usize]));
        for edge in [[a, b], [b, c], [c, a]] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges
}

/// Whether each edge has exactly one triangle on either side.
#[cfg(test)]
pub(crate) fn is_closed(mesh: &Mesh) -> bool {
    let edges = edges_of(mesh);
    let mut all = edges.iter();
    all.all(|([a, b], n)| *n == 1 && edges.contains_key(&[*b, *a]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::tests::build;

    /// An edge and a difference of UVs near the smallest number: MikkTSpace's own squares vanish. Found by fuzzing.
    #[test]
    fn tangents_are_finite() {
        let mesh = Mesh {
            positions: vec![
                Vec3::ZERO,
                Vec3::new(0.0, 4.481_572e-38, 0.0),
                Vec3::new(0.0, 0.125, 0.0),
            ],
            normals: vec![Vec3::Z; 3],
            triangles: vec![[0, 1, 2]],
            uvs: vec![[
                Vec2::ZERO,
                Vec2::new(1.682_942, 1.080_605),
                Vec2::new(2.421_404e-38, -3.771_113e-38),
            ]],
            ..Mesh::default()
        };
        let tangents = mesh.tangents(0..1).expect("there are UVs");
        let mut all = tangents.iter().flatten().flatten();
        assert!(all.all(|x| x.is_finite()), "{tangents:?}");
    }

    /// Cut triangles cover the same area, keep parts, UVs and orientation, and share their middles.
    #[test]
    fn a_cut_surface_is_the_same() {
        let mesh = build("shape = 'torus'\ntube = 0.3\ntriangles = 200");
        let cut = mesh.colored_by_height([[0.0; 4], [1.0; 4]]).subdivided();
        assert_eq!(cut.triangles.len(), 4 * mesh.triangles.len());
        assert_eq!(cut.parts[0].triangles, 0..cut.triangles.len());
        assert_eq!(cut.uvs.len(), cut.triangles.len());
        assert_eq!(cut.colors.len(), cut.positions.len());
        // A torus has three edges for two triangles: as many middles.
        let edges = mesh.triangles.len() * 3 / 2;
        assert_eq!(cut.positions.len(), mesh.positions.len() + edges);
        let area = |mesh: &Mesh, t: usize| area_of(&mesh.positions, mesh.triangles[t]);
        for t in 0..mesh.triangles.len() {
            let whole = area(&mesh, t);
            for k in 0..4 {
                assert!((area(&cut, 4 * t + k) * 4.0 - whole).length() < 1e-5);
            }
        }
    }

    /// On a rectangle the tangent points to the right of the texture and normal × tangent, times the sign, up; mirrored, the sign turns.
    #[test]
    fn tangents_of_a_rectangle() {
        for mirrored in [false, true] {
            let mut mesh = build("shape = 'quad'");
            for uv in mesh.uvs.iter_mut().flatten().filter(|_| mirrored) {
                uv.x = 1.0 - uv.x;
            }
            let tangents = mesh.tangents(0..2).expect("has UVs");
            for [x, y, z, sign] in tangents.into_iter().flatten() {
                let tangent = Vec3::new(x, y, z);
                let right = if mirrored { -Vec3::X } else { Vec3::X };
                assert!((tangent - right).length() < 1e-6, "{tangent}");
                let up = Vec3::Z.cross(tangent) * sign;
                assert!((up - Vec3::Y).length() < 1e-6, "{up}");
            }
        }
    }
}
