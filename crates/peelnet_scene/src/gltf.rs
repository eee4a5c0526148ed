//! glTF 2.0 and GLB files: nodes, instances, materials with their images, vertex colours, point and directional lights, and cameras. What a file asks for and is not drawn is told in a
//! warning, never dropped silently.

use crate::{
    Light, Lighting, Maps, Material, Mesh, Part, SceneError, Source, Texture, Wrap,
    files::{FileKind, Files, MAX_FILE_BYTES, read_file},
    mesh::{PartGeometry, smooth_normals},
};
use glam::{Mat2, Mat3, Mat4, Vec2, Vec3};
use gltf::{
    Semantic,
    accessor::{DataType, Dimensions},
    camera::Projection,
    khr_lights_punctual::Kind,
    material::AlphaMode,
    mesh::Mode,
    texture::{MagFilter, WrappingMode},
};
use serde_json::Value;
use std::{
    collections::{BTreeSet, HashMap},
    io,
    path::{Path, PathBuf},
    sync::Arc,
};

/// What a glTF file holds.
#[derive(Debug)]
pub struct LoadedGltf {
    /// All nodes' triangles in the file's space, a part for each primitive.
    pub mesh: Mesh,
    /// Point and directional lights.
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

/// Reads a glTF or GLB file and the buffers and images that it names.
///
/// # Errors
/// A file that cannot be read, is no glTF 2.0, needs an extension that is not known here, or holds numbers or indices that make no
/// sense.
pub fn load_gltf(path: &Path) -> Result<LoadedGltf, SceneError> {
    load_gltf_from(path, read_file)
}

/// The same with a function that reads files: from an archive, or from memory.
///
/// # Errors
/// See [`load_gltf`].
pub fn load_gltf_from(
    path: &Path,
    read: impl Fn(&Path) -> io::Result<Vec<u8>>,
) -> Result<LoadedGltf, SceneError> {
    load(path, &mut Files::new(&read))
}

/// Reads a glTF or GLB file.
pub(crate) fn load(path: &Path, files: &mut Files<'_>) -> Result<LoadedGltf, SceneError> {
    let fail = |message: String| SceneError::Mesh {
        path: path.to_owned(),
        line: None,
        message,
    };
    let first = files.used().len();
    let bytes = files.read(path, FileKind::Mesh)?;
    files.record(path, &bytes);
    check_references(&bytes).map_err(&fail)?;
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes)
        .map_err(|e| fail(format!("is no glTF 2.0 file: {e}; export it again")))?;
    drop(bytes);
    let folder = path.parent().unwrap_or(Path::new("."));
    let buffers = read_buffers(&document, folder, blob, files).map_err(|e| {
        fail(format!(
            "a buffer cannot be read: {e}; keep the .bin files beside it"
        ))
    })?;
    let mut reader = Reader {
        path,
        folder,
        files,
        buffers,
        images: HashMap::new(),
        missing: BTreeSet::new(),
        loaded: LoadedGltf {
            mesh: Mesh::empty(),
            lights: Vec::new(),
            cameras: Vec::new(),
            warnings: Vec::new(),
            files: Vec::new(),
        },
    };
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
    for extension in document.extensions_used().filter(|e| !KNOWN.contains(e)) {
        reader.missing.insert(format!("extension {extension}"));
    }
    let Reader {
        mut loaded,
        missing,
        files,
        ..
    } = reader;
    loaded.files = files.used()[first..].to_vec();
    let missing = missing.into_iter();
    let told = missing.map(|what| format!("{}: not drawn: {what}", path.display()));
    loaded.warnings.extend(told);
    if loaded.mesh.triangles.is_empty() {
        let instead: Vec<&str> = loaded.warnings.iter().map(String::as_str).collect();
        return Err(fail(format!(
            "holds no triangles; export a mesh{}{}",
            if instead.is_empty() { "" } else { ". " },
            instead.join("; ")
        )));
    }
    Ok(loaded)
}

/// Every reference from one thing of the file to another must be to one that is there: the parser takes that for granted.
fn check_references(bytes: &[u8]) -> Result<(), String> {
    // The first chunk of a GLB file is the JSON.
    let text = match bytes.strip_prefix(b"glTF") {
        None => bytes,
        Some(rest) => {
            let length = rest.get(8..12).and_then(|b| b.try_into().ok());
            let length = length.map_or(0, u32::from_le_bytes) as usize;
            rest.get(16..16usize.saturating_add(length))
                .unwrap_or_default()
        }
    };
    // The parser passes over names that it does not know without looking whether they are text.
    let document = serde_json::from_slice::<Value>(text)
        .map_err(|e| format!("is no glTF 2.0 file: {e}; export it again"))?;
    // The parser would look for what such an extension leaves out.
    let required = document["extensionsRequired"].as_array();
    let unknown = required.into_iter().flatten().filter_map(Value::as_str);
    if let Some(name) = unknown.into_iter().find(|name| !KNOWN.contains(name)) {
        return Err(format!(
            "needs the extension {name}, which is not read; export it without"
        ));
    }
    check_value(&document, &document, "", "")
}

/// Extensions that are drawn.
const KNOWN: [&str; 5] = [
    "KHR_lights_punctual",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_transmission",
    "KHR_texture_transform",
];

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

/// The file that a URI names. The `gltf` crate would read it itself, from the file system only.
fn uri_path(uri: &str, folder: &Path) -> Result<PathBuf, String> {
    let absolute = uri
        .strip_prefix("file://")
        .or_else(|| uri.strip_prefix("file:"));
    if let Some(path) = absolute {
        return Ok(path.into());
    }
    if uri.contains(':') {
        return Err(format!("'{uri}' has a scheme that is not read"));
    }
    let name = urlencoding::decode(uri);
    let name = name.map_err(|_| format!("'{uri}' is no name of a file; rename the file"))?;
    Ok(folder.join(&*name))
}

/// The bytes that a URI names or holds.
fn read_uri(
    uri: &str,
    folder: &Path,
    kind: FileKind,
    files: &mut Files<'_>,
) -> Result<Vec<u8>, String> {
    if uri.starts_with("data:") {
        let data = gltf::buffer::Data::from_source(gltf::buffer::Source::Uri(uri), None);
        return data.map(|data| data.0).map_err(|e| e.to_string());
    }
    let path = uri_path(uri, folder)?;
    let bytes = files.read(&path, kind).map_err(|e| match e {
        SceneError::Read { source, .. } => source.to_string(),
        e => e.to_string(),
    })?;
    files.record(&path, &bytes);
    Ok(bytes)
}

/// The buffers of a document; `blob` is the binary chunk of a GLB file.
fn read_buffers(
    document: &gltf::Document,
    folder: &Path,
    mut blob: Option<Vec<u8>>,
    files: &mut Files<'_>,
) -> Result<Vec<Vec<u8>>, String> {
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        let bytes = match buffer.source() {
            gltf::buffer::Source::Bin => blob.take().ok_or("there is no binary chunk")?,
            gltf::buffer::Source::Uri(uri) => read_uri(uri, folder, FileKind::Mesh, files)?,
        };
        if bytes.len() < buffer.length() {
            return Err(format!(
                "buffer {} has {} bytes instead of {}",
                buffer.index(),
                bytes.len(),
                buffer.length()
            ));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

/// Where a map lies on its texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Placing {
    set: u32,
    transform: (Mat2, Vec2),
}

impl Placing {
    const PLAIN: Self = Self {
        set: 0,
        transform: (Mat2::IDENTITY, Vec2::ZERO),
    };

    /// KHR_texture_transform: scaled, turned, moved.
    fn of(info: &gltf::texture::Info<'_>) -> Self {
        let Some(t) = info.texture_transform() else {
            return Self {
                set: info.tex_coord(),
                ..Self::PLAIN
            };
        };
        let (sin, cos) = t.rotation().sin_cos();
        let [x, y] = t.scale();
        let turned = Mat2::from_cols(Vec2::new(cos, -sin) * x, Vec2::new(sin, cos) * y);
        Self {
            set: t.tex_coord().unwrap_or(info.tex_coord()),
            transform: (turned, t.offset().into()),
        }
    }
}

/// Whether an accessor holds what the parser reads of it for a meaning, or as indices: the parser takes it for granted.
fn is_readable(accessor: &gltf::Accessor<'_>, semantic: Option<&Semantic>) -> bool {
    use DataType as T;
    use Dimensions as D;
    /// Beyond this, sums of offsets and lengths could overflow.
    const FARTHEST_BYTE: u64 = MAX_FILE_BYTES;
    let kind = (accessor.dimensions(), accessor.data_type());
    let fits = match semantic {
        None => matches!(kind, (D::Scalar, T::U8 | T::U16 | T::U32)),
        Some(Semantic::Positions | Semantic::Normals) => kind == (D::Vec3, T::F32),
        Some(Semantic::TexCoords(_)) => matches!(kind, (D::Vec2, T::F32 | T::U8 | T::U16)),
        Some(Semantic::Colors(0)) => {
            matches!(kind, (D::Vec3 | D::Vec4, T::F32 | T::U8 | T::U16))
        }
        // Nobody reads it.
        Some(_) => return true,
    };
    let view = |view: gltf::buffer::View<'_>, offset: usize, size: usize| {
        let strided = view.stride().is_none_or(|stride| stride >= size);
        strided
            && [view.offset(), view.length(), offset]
                .iter()
                .all(|n| (*n as u64) < FARTHEST_BYTE)
    };
    let size = accessor.size();
    let sound = accessor
        .view()
        .is_none_or(|v| view(v, accessor.offset(), size));
    let sparse = accessor.sparse().is_none_or(|sparse| {
        let (indices, values) = (sparse.indices(), sparse.values());
        (1..=accessor.count()).contains(&sparse.count())
            && view(
                indices.view(),
                indices.offset(),
                indices.index_type().size(),
            )
            && view(values.view(), values.offset(), size)
    });
    fits && sound && sparse && (1..=3 * MAX_TRIANGLES).contains(&accessor.count())
}

/// A value within its bounds; what is not finite is the lower one.
fn finite(x: f32, low: f32, high: f32) -> f32 {
    if x.is_finite() {
        x.clamp(low, high)
    } else {
        low
    }
}

struct Reader<'a, 'f> {
    path: &'a Path,
    folder: &'a Path,
    files: &'a mut Files<'f>,
    buffers: Vec<Vec<u8>>,
    /// By number, with their opacity or without; `None` for what cannot be drawn.
    images: HashMap<(usize, bool), Option<Arc<Texture>>>,
    /// What the file asks for and is not drawn, each once.
    missing: BTreeSet<String>,
    loaded: LoadedGltf,
}

impl Reader<'_, '_> {
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
                source: Source::Point(world.transform_point3(Vec3::ZERO)),
                color: light.color(),
                intensity: light.intensity(),
            }),
            // It shines along its −z.
            Kind::Directional => self.loaded.lights.push(Light {
                source: Source::Toward(world.transform_vector3(Vec3::Z).normalize_or(Vec3::Y)),
                color: light.color(),
                intensity: light.intensity(),
            }),
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
        let attributes = primitive.attributes();
        let named = attributes.map(|(semantic, accessor)| (Some(semantic), accessor));
        for (semantic, accessor) in named.chain(primitive.indices().map(|a| (None, a))) {
            if !is_readable(&accessor, semantic.as_ref()) {
                let what = semantic.map_or_else(|| "indices".into(), |s| s.to_string());
                return Err(self.fail(format!(
                    "{place}: accessor {} does not hold what {what} are made of; export it again",
                    accessor.index()
                )));
            }
        }
        let reader = primitive.reader(|b| self.buffers.get(b.index()).map(Vec::as_slice));
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
        let colors: Option<Vec<[f32; 4]>> = reader.read_colors(0).map(|colors| {
            let unit = |c: f32| {
                if c.is_finite() {
                    c.clamp(0.0, 1.0)
                } else {
                    0.0
                }
            };
            colors.into_rgba_f32().map(|c| c.map(unit)).collect()
        });
        if primitive.morph_targets().len() > 0 {
            self.missing.insert("morph targets".into());
        }
        // Opacity of corners counts for what blends or has holes.
        let is_opaque = primitive.material().alpha_mode() == AlphaMode::Opaque;
        let (material, placing) = self.material(&primitive.material());
        let reader = primitive.reader(|b| self.buffers.get(b.index()).map(Vec::as_slice));
        let uvs: Option<Vec<Vec2>> = reader.read_tex_coords(placing.set).map(|uvs| {
            let (turned, moved) = placing.transform;
            let place = |uv: [f32; 2]| turned * Vec2::from(uv) + moved;
            let sound = |uv: Vec2| if uv.is_finite() { uv } else { Vec2::ZERO };
            uvs.into_f32().map(|uv| sound(place(uv))).collect()
        });
        let n = positions.len();
        let corners = PartGeometry {
            uvs: uvs.filter(|uvs| uvs.len() == n),
            colors: colors.filter(|c| c.len() == n).map(|mut colors| {
                if is_opaque {
                    colors.iter_mut().for_each(|c| c[3] = 1.0);
                }
                colors
            }),
            positions,
            normals,
            triangles,
        };
        let part = Part {
            name: mesh.name().unwrap_or(&place).to_owned(),
            triangles: 0..0,
            material,
        };
        let lost = self.loaded.mesh.push(corners, part);
        self.missing.extend(lost);
        Ok(())
    }

    /// An image, read once; `None`, and told, where it cannot be drawn. An `opaque` one is without what opacity its file holds.
    fn image(&mut self, image: &gltf::Image<'_>, opaque: bool) -> Option<Arc<Texture>> {
        let key = (image.index(), opaque);
        if let Some(known) = self.images.get(&key) {
            return known.clone();
        }
        if opaque {
            let whole = self.image(image, false);
            let found = whole.map(|whole| {
                if !whole.has_alpha() {
                    return whole;
                }
                let opaque = |t: [u8; 4], _| [t[0], t[1], t[2], 255];
                Arc::new(Texture::joined(&whole, &whole, opaque))
            });
            self.images.insert(key, found.clone());
            return found;
        }
        let name = image
            .name()
            .map_or_else(|| format!("image {}", image.index()), str::to_owned);
        let decoded = match image.source() {
            gltf::image::Source::View { view, .. } => {
                let bytes = self.buffers.get(view.buffer().index());
                let end = view.offset().saturating_add(view.length());
                bytes
                    .and_then(|b| b.get(view.offset()..end))
                    .ok_or_else(|| "lies beyond its buffer".to_owned())
                    .and_then(|bytes| Texture::decode(&name, bytes))
            }
            gltf::image::Source::Uri { uri, .. } => {
                read_uri(uri, self.folder, FileKind::Image, self.files)
                    .map_err(|e| format!("cannot be read: {e}"))
                    .and_then(|bytes| Texture::decode(&name, &bytes))
            }
        };
        let found = match decoded {
            Ok(texture) => Some(Arc::new(texture)),
            Err(why) => {
                self.missing.insert(format!("{name}, which {why}"));
                None
            }
        };
        self.images.insert(key, found.clone());
        found
    }

    /// A material's maps, and where they lie.
    fn maps(&mut self, m: &gltf::Material<'_>) -> (Maps, Placing) {
        let pbr = m.pbr_metallic_roughness();
        let infos = [
            pbr.base_color_texture(),
            pbr.metallic_roughness_texture(),
            m.emissive_texture(),
        ];
        let normal = m.normal_texture();
        let occlusion = m.occlusion_texture();
        // The crate does not tell the transforms of normal and occlusion maps: they are taken to be the first of the others'.
        let shared = infos.iter().flatten().map(Placing::of).next();
        let transform = shared.unwrap_or(Placing::PLAIN).transform;
        let of_info = |i: usize| {
            let info: &Option<gltf::texture::Info<'_>> = &infos[i];
            info.as_ref().map(|t| (t.texture(), Placing::of(t)))
        };
        let textures = [
            of_info(0),
            normal.as_ref().map(|t| {
                let set = t.tex_coord();
                (t.texture(), Placing { set, transform })
            }),
            of_info(1),
            occlusion.as_ref().map(|t| {
                let set = t.tex_coord();
                (t.texture(), Placing { set, transform })
            }),
            of_info(2),
        ];
        let placing = textures
            .iter()
            .flatten()
            .map(|(_, placing)| *placing)
            .next();
        let placing = placing.unwrap_or(Placing::PLAIN);
        let samplers: Vec<_> = textures
            .iter()
            .flatten()
            .map(|(t, _)| {
                let sampler = t.sampler();
                (sampler.wrap_s(), sampler.wrap_t(), sampler.mag_filter())
            })
            .collect();
        if samplers.windows(2).any(|w| w[0] != w[1]) {
            self.missing
                .insert("samplers of its own for a map (the first map's is taken)".into());
        }
        // Of the first, the base colour.
        let mut opaque = m.alpha_mode() == AlphaMode::Opaque;
        let images = textures.map(|texture| {
            let opaque = std::mem::take(&mut opaque);
            let (texture, own) = texture?;
            if own.transform != placing.transform {
                self.missing.insert(
                    "texture transforms of its own for a map (the first map's is taken)".into(),
                );
            }
            if own.set != placing.set {
                self.missing
                    .insert("maps on other texture coordinates than the first map's".into());
                return None;
            }
            self.image(&texture.source(), opaque)
        });
        let (wrap_s, wrap_t, filter) =
            samplers
                .first()
                .copied()
                .unwrap_or((WrappingMode::Repeat, WrappingMode::Repeat, None));
        let wrap = |mode| match mode {
            WrappingMode::Repeat => Wrap::Repeat,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
            WrappingMode::ClampToEdge => Wrap::Clamp,
        };
        let [
            color,
            normal_map,
            metallic_roughness,
            occlusion_map,
            emissive,
        ] = images;
        let maps = Maps {
            color,
            normal: normal_map,
            metallic_roughness,
            occlusion: occlusion_map,
            emissive,
            normal_scale: finite(normal.map_or(1.0, |n| n.scale()), -100.0, 100.0),
            occlusion_strength: finite(occlusion.map_or(1.0, |o| o.strength()), 0.0, 1.0),
            wrap: [wrap(wrap_s), wrap(wrap_t)],
            nearest: filter == Some(MagFilter::Nearest),
        };
        (maps, placing)
    }

    /// A material, and where its maps lie.
    fn material(&mut self, m: &gltf::Material<'_>) -> (Material, Placing) {
        let (maps, placing) = self.maps(m);
        let pbr = m.pbr_metallic_roughness();
        let [r, g, b, a] = pbr.base_color_factor();
        let base = [r, g, b].map(|c| finite(c, 0.0, 1.0));
        let lighting = if m.unlit() {
            Lighting::Unlit
        } else {
            Lighting::Pbr
        };
        let strength = m.emissive_strength().unwrap_or(1.0);
        // What passes is not scattered: glTF's mix of both, as opacity and colour (McGuire and Mara 2016).
        let passing = m.transmission().map_or(0.0, |t| {
            if t.transmission_texture().is_some() {
                self.missing
                    .insert("transmission maps (the factor alone is drawn)".into());
            }
            finite(t.transmission_factor(), 0.0, 1.0)
        });
        let (alpha, blend, alpha_cutoff) = match m.alpha_mode() {
            AlphaMode::Opaque => (1.0, false, None),
            AlphaMode::Mask => (a, false, Some(m.alpha_cutoff().unwrap_or(0.5))),
            AlphaMode::Blend => (a, true, None),
        };
        let material = Material {
            name: m.name().unwrap_or("unnamed").to_owned(),
            color: base.map(|c| c * (1.0 - passing)),
            transmission: base.map(|c| c * passing),
            alpha: finite(alpha, 0.0, 1.0),
            metallic: finite(pbr.metallic_factor(), 0.0, 1.0),
            roughness: finite(pbr.roughness_factor(), 0.0, 1.0),
            emission: m.emissive_factor().map(|c| finite(c * strength, 0.0, 1e6)),
            maps,
            alpha_cutoff: alpha_cutoff.map(|c| finite(c, 0.0, 1.0)),
            double_sided: m.double_sided(),
            blend,
            ..Material::default_with(lighting)
        };
        (material, placing)
    }
}
