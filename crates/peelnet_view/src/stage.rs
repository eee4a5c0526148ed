//! The scene that is open, on the GPU, and the changes that people make to it.

use crate::eye::Sphere;
use peelnet_files::shown;
use peelnet_gpu::Gpu;
use peelnet_render::{LayerView, RenderError, Renderer};
use peelnet_scene::{Camera, Effect, Light, Material, Scene, SceneError, file::Edited, suite};
use std::{
    collections::HashMap,
    error::Error,
    io,
    path::{Path, PathBuf},
    rc::Rc,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

/// Where a scene was read from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Source {
    /// A file, or the name of a shipped scene.
    Named(PathBuf),
    /// Files that were dropped onto a page: the name of the scene, and all by name.
    #[cfg_attr(
        not(target_arch = "wasm32"),
        allow(dead_code, reason = "a window opens dropped files by their paths")
    )]
    Dropped(PathBuf, Arc<HashMap<PathBuf, Vec<u8>>>),
}

impl Source {
    /// Its name, for titles and messages.
    pub fn name(&self) -> String {
        let (Self::Named(path) | Self::Dropped(path, _)) = self;
        shown(path)
    }

    /// The text of the scene file; none of a mesh file.
    fn text(&self) -> Option<String> {
        let is_scene = |path: &Path| {
            path.extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("toml"))
        };
        match self {
            Self::Named(path) => match path.to_str().and_then(suite::find) {
                Some(shipped) if !path.is_file() => Some(shipped.text.to_owned()),
                _ if is_scene(path) => std::fs::read_to_string(path).ok(),
                _ => None,
            },
            Self::Dropped(path, files) => {
                let bytes = files.get(path).filter(|_| is_scene(path));
                bytes.and_then(|b| String::from_utf8(b.clone()).ok())
            }
        }
    }

    /// The folder that names in the scene's files are relative to.
    pub fn folder(&self) -> PathBuf {
        let (Self::Named(path) | Self::Dropped(path, _)) = self;
        path.parent()
            .filter(|_| path.is_file())
            .map(PathBuf::from)
            .unwrap_or_default()
    }

    fn load(&self, time: Option<f32>) -> Result<Scene, SceneError> {
        match self {
            Self::Named(path) => suite::open(path, time),
            Self::Dropped(path, files) => {
                let read = |path: &Path| {
                    // What a file names lies beside it: dropped files have no folders.
                    let name = path.file_name().map(PathBuf::from).unwrap_or_default();
                    let found = files.get(path).or_else(|| files.get(&name));
                    found.cloned().ok_or_else(|| {
                        io::Error::new(
                            io::ErrorKind::NotFound,
                            "it was not dropped; drop it together with the scene",
                        )
                    })
                };
                Scene::from_bytes_at(path, time, read)
            }
        }
    }
}

/// An error with its causes, as one line that is safe to show, however long it is.
pub(crate) fn one_line(error: &dyn Error) -> String {
    peelnet_files::one_line(&peelnet_files::error_line(error)).into_owned()
}

/// What of a scene is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shown {
    /// Layers, one of them highlighted, in place of transparency.
    pub layers: Option<LayerView>,
    /// With layers: whether all of them are shaded, to see what that costs; by default the highlighted one alone is.
    pub shade_all: bool,
    /// Effects that are left out.
    pub off: Vec<Effect>,
}

impl Shown {
    fn of(&self, scene: &Scene) -> Result<Scene, SceneError> {
        let all = scene.clone();
        let drawn = self.off.iter().fold(all, |scene, &e| scene.without(e));
        match self.layers {
            None => Ok(drawn),
            Some(view) => drawn.layer_view(view.highlight, self.shade_all),
        }
    }
}

/// A scene, drawn by one renderer.
#[derive(Debug)]
pub(crate) struct Stage {
    pub gpu: Gpu,
    pub source: Source,
    /// As it was loaded, at the time that is shown.
    loaded: Scene,
    /// With all changes. What is drawn besides is said by `shown`.
    scene: Scene,
    renderer: Rc<Renderer>,
    /// Around all objects as they were loaded.
    pub all: Sphere,
    shown: Shown,
    /// Another number for every renderer, of this scene or another.
    renderer_number: u64,
    /// Another number for every change, of this scene or another.
    version: u64,
}

/// A number that was never given before.
fn next_number() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

impl Stage {
    /// Loads a scene and puts it on the GPU.
    ///
    /// # Errors
    /// What is wrong with the file, or why the GPU does not take it; one line.
    pub fn open(gpu: &Gpu, source: Source, time: Option<f32>) -> Result<Self, String> {
        let scene = source.load(time).map_err(|e| one_line(&e))?;
        Self::of_scene(gpu, source, scene)
    }

    /// Puts a scene that is loaded on the GPU.
    ///
    /// # Errors
    /// Why the GPU does not take it; one line.
    pub fn of_scene(gpu: &Gpu, source: Source, scene: Scene) -> Result<Self, String> {
        let renderer = Renderer::new(gpu, &scene).map_err(|e| one_line(&e))?;
        gpu.check().map_err(|e| one_line(&e))?;
        Ok(Self {
            gpu: gpu.clone(),
            source,
            all: Sphere::around(&scene),
            renderer: Rc::new(renderer),
            loaded: scene.clone(),
            scene,
            shown: Shown::default(),
            renderer_number: next_number(),
            version: next_number(),
        })
    }

    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    pub const fn renderer(&self) -> &Rc<Renderer> {
        &self.renderer
    }

    /// Methods are made ready for one renderer.
    pub const fn renderer_number(&self) -> u64 {
        self.renderer_number
    }

    pub const fn version(&self) -> u64 {
        self.version
    }

    /// As it was loaded.
    pub const fn loaded(&self) -> &Scene {
        &self.loaded
    }

    pub const fn shown(&self) -> &Shown {
        &self.shown
    }

    pub const fn layers(&self) -> Option<LayerView> {
        self.shown.layers
    }

    /// Shows the scene at another time of its timeline. What was changed by hand is lost.
    ///
    /// # Errors
    /// See [`Self::open`]; the scene then stays as it was.
    pub fn set_time(&mut self, time: f32) -> Result<(), String> {
        let scene = self.source.load(Some(time)).map_err(|e| one_line(&e))?;
        self.show(scene.clone(), self.shown.clone())?;
        self.loaded = scene;
        Ok(())
    }

    /// Draws something else of the scene.
    ///
    /// # Errors
    /// A layer that the scene does not have.
    pub fn set_shown(&mut self, shown: Shown) -> Result<(), String> {
        self.show(self.scene.clone(), shown)
    }

    /// The text of a scene file with all changes and this camera, and what it cannot say.
    ///
    /// # Errors
    /// A scene file that cannot be read any more.
    pub fn edited(&self, camera: &Camera) -> Result<Edited, String> {
        let text = self.source.text();
        let edited = self
            .scene
            .edited(&self.loaded, text.as_deref(), Some(camera));
        edited.map_err(|e| one_line(&e))
    }

    /// Takes all changes back.
    ///
    /// # Errors
    /// See [`Self::open`].
    pub fn reset(&mut self) -> Result<(), String> {
        self.show(self.loaded.clone(), Shown::default())
    }

    fn show(&mut self, scene: Scene, shown: Shown) -> Result<(), String> {
        let drawn = shown.of(&scene).map_err(|e| one_line(&e))?;
        let renderer = Renderer::new(&self.gpu, &drawn).map_err(|e| one_line(&e))?;
        self.renderer = Rc::new(renderer);
        self.renderer_number = next_number();
        (self.scene, self.shown) = (scene, shown);
        self.version = next_number();
        Ok(())
    }

    /// Moves an object.
    ///
    /// # Errors
    /// An object that the scene does not have.
    pub fn set_transform(
        &mut self,
        object: usize,
        world_from_object: glam::Mat4,
    ) -> Result<(), String> {
        self.scene.objects[object].world_from_object = world_from_object;
        self.edit(|renderer| renderer.set_transform(object, world_from_object))
    }

    /// Gives a part of an object another material.
    ///
    /// # Errors
    /// See [`Renderer::set_material`].
    pub fn set_material(
        &mut self,
        object: usize,
        part: usize,
        material: Material,
    ) -> Result<(), String> {
        self.scene.objects[object].materials[part] = material.clone();
        self.edit(|renderer| renderer.set_material(object, part, material))
    }

    /// Replaces all lights.
    ///
    /// # Errors
    /// See [`Renderer::set_lights`].
    pub fn set_lights(&mut self, lights: Vec<Light>) -> Result<(), String> {
        self.scene.lights.clone_from(&lights);
        self.edit(|renderer| renderer.set_lights(lights))
    }

    /// Changes the renderer in place; where something is still measured with it, or shows layers, another one is made.
    fn edit(
        &mut self,
        change: impl FnOnce(&mut Renderer) -> Result<(), RenderError>,
    ) -> Result<(), String> {
        self.version = next_number();
        let is_all = self.shown == Shown::default();
        match Rc::get_mut(&mut self.renderer) {
            Some(renderer) if is_all => change(renderer).map_err(|e| one_line(&e)),
            _ => self.show(self.scene.clone(), self.shown.clone()),
        }
    }
}
