//! glTF 2.0 and GLB files: nodes, instances, materials, point lights and cameras. What a file asks for and is not drawn is told in a
//! warning, never dropped silently.

use crate::{Light, Lighting, Material, Mesh, Part, SceneError, mesh::smooth_normals};
use glam::{Mat3, Mat4, Vec3};
use gltf::{camera::Projection, khr_lights_punctual::Kind, material::AlphaMode, mesh::Mode};
use serde_json::Value;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// What a glTF file holds.
#[derive(Debug)]
pub struct LoadedGltf {
    /// All nodes' triangles in the file's space, a part for each primitive.
    pub mesh: Mesh,
    /// Point lights.
    pub lights: Vec<Light>,
    /// Cameras with a perspective projection.
    pub cameras: Vec<GltfCamera>,
    /// What is not drawn.
    pub warnings: Vec<String>,
    /// Every file that was read, the named one first.
    pub files: Vec<PathBuf>,
}

/// A camera of a glTF file, in its space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GltfCamera {
    /// Camera to file space: it looks along −z.
    pub file_from_camera: Mat4,
    /// Vertical field of view, radians.
    pub fov_y: f32,
    /// Near plane.
    pub near: f32,
    /// Far plane, where the file gives one.
    pub far: Option<f32>,
}

/// Largest number of triangles of all instances together, so that a small file cannot ask for endless memory.
const MAX_TRIANGLES: usize = 50_000_000;

/// Positions beyond this overflow when they are squared.
const FARTHEST: f32 = 1e15;

/// Reads a glTF or GLB file and the buffers that it names.
///
/// # Errors
/// A file that cannot be read, is no glTF 2.0, needs an extension that is not known here, or holds numbers or indices that make no
/// sense.
pub fn load_gltf(path: &Path) -> Result<LoadedGltf, SceneError> {
    let fail = |message: String| SceneError::Mesh {
        path: path.to_owned(),
        line: None,
        message,
    };
    let bytes = std::fs::read(path).map_err(|source| SceneError::Read {
        path: path.to_owned(),
        source,
    })?;
    check_references(&bytes).map_err(&fail)?;
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes)
        .map_err(|e| fail(format!("is no glTF 2.0 file: {e}; export it again")))?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let buffers = gltf::import_buffers(&document, Some(folder), blob).map_err(|e| {
        fail(format!(
            "a buffer cannot be read: {e}; keep the .bin files beside it"
        ))
    })?;
    let mut reader = Reader {
        path,
        buffers,
        missing: BTreeSet::new(),
        loaded: LoadedGltf {
            mesh: Mesh {
                positions: Vec::new(),
                normals: Vec::new(),
                triangles: Vec::new(),
                parts: Vec::new(),
            },
            lights: Vec::new(),
            cameras: Vec::new(),
            warnings: Vec::new(),
            files: vec![path.to_owned()],
        },
    };
    for buffer in document.buffers() {
        if let gltf::buffer::Source::Uri(uri) = buffer.source()
            && !uri.starts_with("data:")
        {
            reader.loaded.files.push(folder.join(uri));
        }
    }
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next())
        .ok_or_else(|| fail("holds no scene; export one".into()))?;
    for node in scene.nodes() {
        reader.node(&node, Mat4::IDENTITY, 0)?;
    }
    if document.animations().len() > 0 {
        reader
            .missing
            .insert("animations (the first pose is drawn)".into());
    }
    if document.skins().len() > 0 {
        reader
            .missing
            .insert("skins (the bind pose is drawn)".into());
    }
    let known = [
        "KHR_lights_punctual",
        "KHR_materials_unlit",
        "KHR_materials_emissive_strength",
    ];
    for extension in document.extensions_used().filter(|e| !known.contains(e)) {
        reader.missing.insert(format!("extension {extension}"));
    }
    let Reader {
        mut loaded,
        missing,
        ..
    } = reader;
    let missing = missing.into_iter();
    let told = missing.map(|what| format!("{}: not drawn: {what}", path.display()));
    loaded.warnings.extend(told);
    if loaded.mesh.triangles.is_empty() {
        return Err(fail("holds no triangles; export a mesh".into()));
    }
    Ok(loaded)
}

/// Every reference from one thing of the file to another must be to one that is there: the parser takes that for granted.
fn check_references(bytes: &[u8]) -> Result<(), String> {
    // The first chunk of a GLB file is the JSON; what is no JSON is left for the parser to refuse.
    let text = match bytes.strip_prefix(b"glTF") {
        None => bytes,
        Some(rest) => {
            let length = rest.get(8..12).and_then(|b| b.try_into().ok());
            let length = length.map_or(0, u32::from_le_bytes) as usize;
            rest.get(16..16usize.saturating_add(length))
                .unwrap_or_default()
        }
    };
    let Ok(document) = serde_json::from_slice::<Value>(text) else {
        return Ok(());
    };
    check_value(&document, &document, "", "")
}

/// The list that a field's number points into.
fn list_of(field: &str, parent: &str) -> Option<&'static str> {
    Some(match field {
        "mesh" => "meshes",
        "camera" => "cameras",
        "skin" => "skins",
        "bufferView" => "bufferViews",
        "buffer" => "buffers",
        "material" => "materials",
        "source" => "images",
        "scene" => "scenes",
        "node" | "children" | "joints" | "skeleton" => "nodes",
        "nodes" if parent == "scenes" => "nodes",
        "indices" | "input" | "output" | "inverseBindMatrices" => "accessors",
        "index" => "textures",
        "sampler" if parent == "textures" => "samplers",
        _ if matches!(parent, "attributes" | "targets") => "accessors",
        _ => return None,
    })
}

/// Looks at a value in `field` of something in `parent`; the elements of a list are in its field.
fn check_value(document: &Value, value: &Value, field: &str, parent: &str) -> Result<(), String> {
    match value {
        Value::Object(fields) => {
            for (name, inner) in fields.iter().filter(|(name, _)| *name != "extras") {
                check_value(document, inner, name, field)?;
            }
            Ok(())
        }
        Value::Array(all) => all
            .iter()
            .try_for_each(|inner| check_value(document, inner, field, parent)),
        Value::Number(number) => {
            let Some(list) = list_of(field, parent) else {
                return Ok(());
            };
            let there = document[list].as_array().map_or(0, Vec::len) as u64;
            if number.as_u64().is_some_and(|n| n < there) {
                return Ok(());
            }
            Err(format!(
                "'{field}' is {number}, but there are {there} {list}; export the file again"
            ))
        }
        _ => Ok(()),
    }
}

struct Reader<'a> {
    path: &'a Path,
    buffers: Vec<gltf::buffer::Data>,
    /// What the file asks for and is not drawn, each once.
    missing: BTreeSet<String>,
    loaded: LoadedGltf,
}

impl Reader<'_> {
    fn fail(&self, message: String) -> SceneError {
        SceneError::Mesh {
            path: self.path.to_owned(),
            line: None,
            message,
        }
    }

    fn node(
        &mut self,
        node: &gltf::Node<'_>,
        parent: Mat4,
        depth: usize,
    ) -> Result<(), SceneError> {
        // A node that is its own descendant would never end.
        if depth > 256 {
            return Err(self.fail(format!(
                "node {} lies more than 256 levels deep; is it its own child?",
                node.index()
            )));
        }
        let world = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        if !world.is_finite() {
            return Err(self.fail(format!(
                "node {}: its transform is not finite; repair it",
                node.index()
            )));
        }
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                self.primitive(&mesh, &primitive, world)?;
            }
        }
        if let Some(light) = node.light() {
            self.light(&light, world);
        }
        if let Some(camera) = node.camera() {
            match camera.projection() {
                Projection::Perspective(p) => self.loaded.cameras.push(GltfCamera {
                    file_from_camera: world,
                    fov_y: p.yfov(),
                    near: p.znear(),
                    far: p.zfar(),
                }),
                Projection::Orthographic(_) => {
                    self.missing.insert("orthographic cameras".into());
                }
            }
        }
        for child in node.children() {
            self.node(&child, world, depth + 1)?;
        }
        Ok(())
    }

    fn light(&mut self, light: &gltf::khr_lights_punctual::Light<'_>, world: Mat4) {
        match light.kind() {
            Kind::Point => self.loaded.lights.push(Light {
                position: world.transform_point3(Vec3::ZERO),
                color: light.color(),
                intensity: light.intensity(),
            }),
            Kind::Directional => drop(self.missing.insert("directional lights".into())),
            Kind::Spot { .. } => drop(self.missing.insert("spot lights".into())),
        }
    }

    fn primitive(
        &mut self,
        mesh: &gltf::Mesh<'_>,
        primitive: &gltf::Primitive<'_>,
        world: Mat4,
    ) -> Result<(), SceneError> {
        let place = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
        let strip = match primitive.mode() {
            Mode::Triangles => None,
            Mode::TriangleStrip => Some(true),
            Mode::TriangleFan => Some(false),
            other => {
                self.missing.insert(format!("{other:?} ({place})"));
                return Ok(());
            }
        };
        let reader = primitive.reader(|b| self.buffers.get(b.index()).map(|d| d.0.as_slice()));
        let positions: Vec<Vec3> = reader
            .read_positions()
            .ok_or_else(|| self.fail(format!("{place} has no positions; export it again")))?
            .map(|p| world.transform_point3(p.into()))
            .collect();
        let is_far = |p: &Vec3| p.is_finite() && p.abs().max_element() > FARTHEST;
        if let Some(i) = positions.iter().position(|p| !p.is_finite() || is_far(p)) {
            let what = if is_far(&positions[i]) {
                format!("lies farther than {FARTHEST:e} from the origin")
            } else {
                "is not finite".to_owned()
            };
            return Err(self.fail(format!("{place}: position {i} {what}; repair the mesh")));
        }
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..positions.len() as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|i| **i as usize >= positions.len()) {
            return Err(self.fail(format!(
                "{place}: index {index} points at none of its {} vertices; export it again",
                positions.len()
            )));
        }
        // A mirrored node turns its triangles inside out: turn them back.
        let mirrored = Mat3::from_mat4(world).determinant() < 0.0;
        let corner = |a: u32, b: u32, c: u32| if mirrored { [a, c, b] } else { [a, b, c] };
        let triangles: Vec<[u32; 3]> = match strip {
            None => indices
                .chunks_exact(3)
                .map(|t| corner(t[0], t[1], t[2]))
                .collect(),
            // Every second triangle of a strip is wound the other way.
            Some(true) => indices
                .windows(3)
                .enumerate()
                .map(|(i, t)| {
                    if i % 2 == 0 {
                        corner(t[0], t[1], t[2])
                    } else {
                        corner(t[1], t[0], t[2])
                    }
                })
                .collect(),
            Some(false) => indices
                .get(1..)
                .unwrap_or_default()
                .windows(2)
                .map(|t| corner(indices[0], t[0], t[1]))
                .collect(),
        };
        let total = self.loaded.mesh.triangles.len() + triangles.len();
        if total > MAX_TRIANGLES {
            return Err(self.fail(format!(
                "its instances have more than {MAX_TRIANGLES} triangles; split the scene"
            )));
        }
        let smooth = smooth_normals(&positions, &triangles);
        let normal_matrix = Mat3::from_mat4(world).inverse().transpose();
        let normals: Vec<Vec3> = match reader.read_normals() {
            Some(given) if given.len() == positions.len() => given
                .zip(&smooth)
                .map(|(n, s)| {
                    (normal_matrix * Vec3::from(n))
                        .try_normalize()
                        .unwrap_or(*s)
                })
                .collect(),
            _ => smooth,
        };
        if primitive.get(&gltf::Semantic::Colors(0)).is_some() {
            self.missing.insert("vertex colours".into());
        }
        if primitive.morph_targets().len() > 0 {
            self.missing.insert("morph targets".into());
        }
        let material = self.material(&primitive.material());
        let target = &mut self.loaded.mesh;
        let (base, first) = (target.positions.len() as u32, target.triangles.len());
        target.positions.extend(positions);
        target.normals.extend(normals);
        target
            .triangles
            .extend(triangles.iter().map(|t| t.map(|i| i + base)));
        target.parts.push(Part {
            name: mesh.name().unwrap_or(&place).to_owned(),
            triangles: first..target.triangles.len(),
            material,
        });
        Ok(())
    }

    fn material(&mut self, m: &gltf::Material<'_>) -> Material {
        let pbr = m.pbr_metallic_roughness();
        let maps = [
            ("base-colour", pbr.base_color_texture().is_some()),
            (
                "metallic-roughness",
                pbr.metallic_roughness_texture().is_some(),
            ),
            ("normal", m.normal_texture().is_some()),
            ("occlusion", m.occlusion_texture().is_some()),
            ("emissive", m.emissive_texture().is_some()),
        ];
        for (name, _) in maps.into_iter().filter(|(_, there)| *there) {
            self.missing
                .insert(format!("{name} maps (factors alone are drawn)"));
        }
        let [r, g, b, a] = pbr.base_color_factor();
        let finite = |x: f32, low: f32, high: f32| {
            if x.is_finite() {
                x.clamp(low, high)
            } else {
                low
            }
        };
        let lighting = if m.unlit() {
            Lighting::Unlit
        } else {
            Lighting::Pbr
        };
        let strength = m.emissive_strength().unwrap_or(1.0);
        let (alpha, blend, alpha_cutoff) = match m.alpha_mode() {
            AlphaMode::Opaque => (1.0, false, None),
            AlphaMode::Mask => (a, false, Some(m.alpha_cutoff().unwrap_or(0.5))),
            AlphaMode::Blend => (a, true, None),
        };
        Material {
            name: m.name().unwrap_or("unnamed").to_owned(),
            color: [r, g, b].map(|c| finite(c, 0.0, 1.0)),
            alpha: finite(alpha, 0.0, 1.0),
            metallic: finite(pbr.metallic_factor(), 0.0, 1.0),
            roughness: finite(pbr.roughness_factor(), 0.0, 1.0),
            emission: m.emissive_factor().map(|c| finite(c * strength, 0.0, 1e6)),
            alpha_cutoff: alpha_cutoff.map(|c| finite(c, 0.0, 1.0)),
            double_sided: m.double_sided(),
            blend,
            ..Material::default_with(lighting)
        }
    }
}
