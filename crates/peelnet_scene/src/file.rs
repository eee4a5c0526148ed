//! The scene file: TOML, strict. A mesh file is a scene too, see [`Scene::load`].

mod edited;
mod loader;
mod materials;
mod mesh_scene;
mod objects;
pub(crate) mod raw;
mod timeline;
mod views;

pub use edited::Edited;

use crate::{
    budget::{self, MAX_COORDINATE, MAX_INSTANCED},
    camera::Camera,
    error::SceneError,
    files::{Files, MAX_TEXT},
    import,
    material::Lighting,
    scene::{Blending, Object, Scene, State},
};
use glam::Vec3;
use loader::Loader;
use peelnet_core::files::{MAX_SHOWN, check_name};
use raw::RawScene;
use std::{
    collections::BTreeSet,
    io,
    path::{Path, PathBuf},
};
use timeline::{NO_TIMELINE, Snapshot};

impl Scene {
    /// Reads a scene file and everything it names from the file system, a scene with a timeline in its first state. A mesh file (glTF, GLB,
    /// OBJ, PLY, STL, or splats: PLY, SPLAT, SPZ, glTF) is a scene too: with its own lights and cameras; where it has none, with two lights, and a
    /// camera that sees all of it from three sides. Its materials are as the file says: opaque ones stay opaque.
    ///
    /// # Errors
    /// The first thing that is wrong, with file, line or key, and a hint.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::load_at(path, None)
    }

    /// The same at a time of the scene's timeline: only the state shown is loaded; numbers of materials lie between its and the next one's.
    ///
    /// # Errors
    /// See [`Scene::load`]; a time outside of the timeline, or of a scene without one.
    pub fn load_at(path: impl AsRef<Path>, time: Option<f32>) -> Result<Self, SceneError> {
        Self::load_with(path, time, &[])
    }

    /// The same, where mesh files may also name files in these folders. Otherwise what a glTF, OBJ or MTL file names lies in its own folder
    /// or in that of the scene, or below: such files come from strangers.
    ///
    /// # Errors
    /// See [`Scene::load_at`].
    pub fn load_with(
        path: impl AsRef<Path>,
        time: Option<f32>,
        folders: &[PathBuf],
    ) -> Result<Self, SceneError> {
        let own = path.as_ref().parent().map(Path::to_owned);
        let folders: Vec<PathBuf> = own.into_iter().chain(folders.iter().cloned()).collect();
        load(path.as_ref(), Files::on_disk(&folders), time)
    }

    /// Reads the scene file `name` and everything it names through a function that returns a file's bytes, so that an archive, a web page
    /// or a test can be the file system. Names that a file contains are joined to its folder.
    ///
    /// ```
    /// # fn main() -> Result<(), peelnet_scene::SceneError> {
    /// let files = |path: &std::path::Path| match path.to_str() {
    ///     Some("room/scene.toml") => Ok(b"
    ///         [camera]
    ///         position = [0, 0, 6]
    ///         target = [0, 0, 0]
    ///         near = 0.1
    ///         far = 100
    ///         [[object]]
    ///         mesh = 'pane.obj'"
    ///         .to_vec()),
    ///     Some("room/pane.obj") => Ok(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3".to_vec()),
    ///     _ => Err(std::io::ErrorKind::NotFound.into()),
    /// };
    /// let scene = peelnet_scene::Scene::from_bytes("room/scene.toml", files)?;
    /// assert_eq!(scene.triangles(), 1);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// See [`Scene::load`].
    pub fn from_bytes(
        name: impl AsRef<Path>,
        read: impl Fn(&Path) -> io::Result<Vec<u8>>,
    ) -> Result<Self, SceneError> {
        Self::from_bytes_at(name, None, read)
    }

    /// The same at a time of the scene's timeline, see [`Scene::load_at`].
    ///
    /// # Errors
    /// See [`Scene::load_at`].
    pub fn from_bytes_at(
        name: impl AsRef<Path>,
        time: Option<f32>,
        read: impl Fn(&Path) -> io::Result<Vec<u8>>,
    ) -> Result<Self, SceneError> {
        load(name.as_ref(), Files::new(&|path, _| read(path)), time)
    }
}

/// Endings of the names of files that are scenes, in lower case.
pub const ENDINGS: [&str; 8] = ["toml", "gltf", "glb", "obj", "ply", "stl", "splat", "spz"];

fn load(path: &Path, mut files: Files<'_>, time: Option<f32>) -> Result<Scene, SceneError> {
    if let Some(load) = import::loader(path) {
        return match time {
            None => mesh_scene::load(path, load, files),
            Some(_) => Err(SceneError::value(path, "timeline", NO_TIMELINE)),
        };
    }
    let raw = parse(path, &mut files).map_err(|e| instead(path, e))?;
    if raw.light.is_empty() {
        files.lighting = Lighting::Unlit;
    }
    assemble(raw, Loader::new(path, files), time)
}

/// The error of what is no scene file, where its name says what it is.
fn instead(path: &Path, error: SceneError) -> SceneError {
    let kind = match &error {
        SceneError::Read { source, .. } => source.kind(),
        _ => io::ErrorKind::InvalidData,
    };
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let what = match (kind, &*ending.to_lowercase()) {
        (io::ErrorKind::IsADirectory, _) => "is a folder, such as a dataset",
        (io::ErrorKind::InvalidData, "safetensors") => "is a network",
        (io::ErrorKind::InvalidData, ending) if !matches!(ending, "" | "toml") => "is no scene",
        _ => return error,
    };
    let endings = ENDINGS.join(", .");
    SceneError::file(
        path,
        None,
        format!("{what}; name a scene file (.{endings}), or a shipped scene"),
    )
}

/// A background as bright as this was hardly meant.
const MUCH_BRIGHTER: f32 = 16.0;

fn parse(path: &Path, files: &mut Files<'_>) -> Result<RawScene, SceneError> {
    let bytes = files.read(path, MAX_TEXT)?;
    let text = String::from_utf8(bytes)
        .map_err(|_| SceneError::file(path, None, "is no text in UTF-8; save it as that"))?;
    // A byte order mark is no TOML, but some editors write one.
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    if let Ok(mut table) = toml::from_str::<toml::Table>(text) {
        // Neither changes a pixel; nor do comments and the order of keys.
        table.retain(|key, _| key != "name" && key != "held_out");
        files.scene_shows(&table.to_string());
    }
    toml::from_str(text).map_err(|e| {
        let line = e.span().map_or(1, |s| {
            1 + text[..s.start.min(text.len())].matches('\n').count()
        });
        let mut message = e.message().trim().replace('\n', "; ");
        if message.starts_with("invalid mantissa") {
            message += ": write 0.8, not .8";
        }
        SceneError::file(path, Some(line), message)
    })
}

/// Loads what a scene file names, and checks its values.
fn assemble(raw: RawScene, mut loader: Loader<'_>, time: Option<f32>) -> Result<Scene, SceneError> {
    let views = views::views(&loader, &raw)?;
    let lights = views::lights(&loader, &raw.light)?;
    // Whatever state is shown: no command that draws the scene may replace what another one shows.
    let named: BTreeSet<PathBuf> = raw.files().map(|file| loader.beside(file)).collect();
    let snapshot = Snapshot::of(&mut loader, raw.object, &raw.timeline, time)?;
    if !(raw.transparency_scale > 0.0 && raw.transparency_scale <= 1.0) {
        let message = format!("{} must be above 0 and at most 1", raw.transparency_scale);
        return Err(loader.value("transparency_scale", message));
    }
    if raw.background.iter().any(|c| !c.is_finite() || *c < 0.0) {
        return Err(loader.value("background", "must be finite and not negative"));
    }
    // It is radiance, so it may be brighter than white, as emission may.
    if raw.background.iter().any(|c| *c > MUCH_BRIGHTER) {
        let message = format!(
            "background: is brighter than {MUCH_BRIGHTER} times white: divide numbers of 0 … 255 by 255"
        );
        loader.files.warn(loader.path, &message);
    }
    let name = raw.name.unwrap_or_else(|| name_of(loader.path));
    check_name(&name).map_err(|e| loader.value("name", e))?;
    let mut objects = Vec::new();
    for (i, object) in snapshot.objects.iter().enumerate() {
        let next = &snapshot.next.get(i).unwrap_or(object).material;
        let field = format!("object {}", i + 1);
        let placed = objects::place(&mut loader, object, next, snapshot.share, field)?;
        objects.push(placed);
    }
    for (i, scatter) in raw.scatter.iter().enumerate() {
        let field = format!("scatter {}", i + 1);
        let placed = objects::scatter(&mut loader, scatter, &field, views[0].position)?;
        objects.extend(placed);
    }
    let all = objects.iter().map(|o| o.mesh.triangles.len() as u64);
    budget::check(all.sum(), MAX_INSTANCED, "triangles of all objects")
        .map_err(|e| loader.value("object", e))?;
    for object in &objects {
        check_reach(object, &views)
            .map_err(|e| loader.value(&peelnet_core::files::printable(&object.name), e))?;
    }
    if !raw.timeline.is_empty() {
        loader.files.hash_value(&snapshot.time.to_le_bytes());
        loader.files.used.extend(named);
    }
    let timeline = raw.timeline.into_iter().map(|s| State {
        time: s.time,
        label: s.label,
    });
    let blending = raw.blending.unwrap_or_else(|| Blending::of(&objects));
    Ok(Scene {
        blending,
        name,
        source: loader.path.to_owned(),
        hash: loader.files.hash(),
        content: loader.files.content(),
        warnings: loader.files.warnings.texts(),
        files: loader.files.used,
        background: raw.background,
        transparency_scale: raw.transparency_scale,
        views,
        lights,
        objects,
        held_out: raw.held_out,
        time: snapshot.time,
        timeline: timeline.collect(),
    })
}

fn name_of(path: &Path) -> String {
    path.file_stem().map_or_else(
        || "scene".into(),
        |s| s.to_string_lossy().chars().take(MAX_SHOWN).collect(),
    )
}

/// Farthest from the origin that an object of a scene file lies, in distances `far`: of the 24 bits of its vertices' coordinates, 8 are left for
/// what the camera sees. Rasterisers lose larger triangles, or halves of quads, without an error.
const MAX_REACH: f32 = 65_536.0;

/// Checks that the coordinates of an object in the world can be drawn.
fn check_reach(object: &Object, views: &[Camera]) -> Result<(), String> {
    let Some((low, high)) = object.mesh.bounds() else {
        return Ok(());
    };
    let vertex = |i: usize| Vec3::from_array([0, 1, 2].map(|k| [low, high][i >> k & 1][k]));
    let vertices = (0..8).map(|i| object.world_from_object.transform_point3(vertex(i)));
    let distances = vertices.map(|p| match p.is_finite() {
        true => p.abs().max_element(),
        false => f32::INFINITY,
    });
    let farthest = distances.fold(0.0, f32::max);
    let far = views.iter().fold(0.0f32, |m, view| m.max(view.far));
    let limit = (MAX_REACH * far).min(MAX_COORDINATE);
    if farthest <= limit {
        return Ok(());
    }
    Err(format!(
        "reaches {farthest:e} from the origin: at most {limit:e}, which is {MAX_REACH} times the camera's far or what 32-bit numbers hold; \
         make it smaller, or far larger"
    ))
}
