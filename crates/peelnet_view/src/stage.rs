//! The scene that is open, on the GPU, and the changes that people make to it.

use crate::{eye::Sphere, task::Fallible};
use peelnet_core::files::shown;
use peelnet_render::gpu::Gpu;
use peelnet_render::{LayerView, RenderError, Renderer};
use peelnet_scene::{Camera, Effect, Light, Material, Scene, SceneError, file::Edited, suite};
use std::{
    collections::HashMap,
    fs,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
    rc::Rc,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

pub(crate) type Files = HashMap<PathBuf, Vec<u8>>;

#[derive(Clone)]
pub(crate) struct Source {
    /// A file, or the name of a shipped scene.
    pub path: PathBuf,
    /// The files that were dropped onto a page with it.
    pub dropped: Option<Arc<Files>>,
    /// See [`Scene::load_with`].
    pub files_from: Vec<PathBuf>,
}

impl Source {
    pub fn named(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            dropped: None,
            files_from: Vec::new(),
        }
    }

    pub fn name(&self) -> String {
        shown(&self.path)
    }

    pub fn bytes(&self) -> Fallible<Vec<u8>> {
        if let Some(files) = &self.dropped {
            return Ok(files.get(&self.path).cloned().unwrap_or_default());
        }
        let bytes = fs::read(&self.path);
        bytes.map_err(|e| format!("{}: cannot be read: {e}", self.name()).into())
    }

    /// The text of the scene file; none of a mesh file.
    fn text(&self) -> Option<String> {
        let shipped = self.path.to_str().and_then(suite::find);
        if let Some(shipped) = shipped.filter(|_| self.dropped.is_none() && !self.path.is_file()) {
            return Some(shipped.text.to_owned());
        }
        let ending = self.path.extension()?;
        let bytes = ending.eq_ignore_ascii_case("toml").then(|| self.bytes())?;
        String::from_utf8(bytes.ok()?).ok()
    }

    /// The folder that names in the scene's files are relative to.
    pub fn folder(&self) -> PathBuf {
        let folder = self.path.parent().filter(|_| self.path.is_file());
        folder.map(PathBuf::from).unwrap_or_default()
    }

    fn load(&self, time: Option<f32>) -> Result<Scene, SceneError> {
        let Some(files) = &self.dropped else {
            return suite::open_with(&self.path, time, &self.files_from);
        };
        let read = |path: &Path| {
            // What a file names lies beside it: dropped files have no folders.
            let name = path.file_name().map(PathBuf::from).unwrap_or_default();
            let found = files.get(path).or_else(|| files.get(&name));
            let hint = "it was not dropped; drop it together with the scene";
            (found.cloned()).ok_or_else(|| io::Error::new(ErrorKind::NotFound, hint))
        };
        Scene::from_bytes_at(&self.path, time, read)
    }
}

/// What of a scene is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shown {
    /// Layers, one of them highlighted, in place of transparency.
    pub layers: Option<LayerView>,
    /// With layers: whether all of them are shaded, to see what that costs; by default the highlighted one alone is.
    pub shade_all: bool,
    /// Names of effects that are left out.
    pub off: Vec<&'static str>,
}

/// What a picture shows, whatever the method.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct View {
    /// Of the stage.
    pub version: u64,
    pub camera: Camera,
    pub size: [u32; 2],
}

pub(crate) struct Stage {
    pub gpu: Gpu,
    pub source: Source,
    /// As it was loaded, at the time that is shown.
    pub loaded: Scene,
    /// With all changes. What is drawn besides is said by `shown`.
    pub scene: Scene,
    pub renderer: Rc<Renderer>,
    /// Around all objects as they were loaded.
    pub all: Sphere,
    pub shown: Shown,
    /// Another number for every renderer, of this scene or another: methods are made ready for one renderer.
    pub renderer_number: u64,
    /// Another number for every change, of this scene or another.
    version: u64,
}

/// A number that was never given before.
pub(crate) fn next_number() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

impl Stage {
    pub fn open(gpu: &Gpu, source: Source, time: Option<f32>) -> Fallible<Self> {
        let scene = source.load(time)?;
        Self::of_scene(gpu, source, scene)
    }

    /// Puts a scene that is loaded on the GPU.
    pub fn of_scene(gpu: &Gpu, source: Source, scene: Scene) -> Fallible<Self> {
        let renderer = Renderer::new(gpu, &scene)?;
        gpu.check()?;
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

    pub const fn view(&self, camera: Camera, size: [u32; 2]) -> View {
        View {
            version: self.version,
            camera,
            size,
        }
    }

    /// The first and the last time of its timeline.
    pub fn times(&self) -> Option<(f32, f32)> {
        let states = &self.scene.timeline;
        Some((states.first()?.time, states.last()?.time))
    }

    pub fn time(&self) -> Option<f32> {
        self.times().map(|_| self.scene.time)
    }

    /// Shows the scene at another time of its timeline. What was changed by hand is lost.
    pub fn set_time(&mut self, time: f32) -> Fallible<()> {
        let scene = self.source.load(Some(time))?;
        self.show(scene.clone(), self.shown.clone())?;
        self.loaded = scene;
        Ok(())
    }

    pub fn set_shown(&mut self, shown: Shown) -> Fallible<()> {
        self.show(self.scene.clone(), shown)
    }

    /// The text of a scene file with all changes and this camera, and what it cannot say.
    pub fn edited(&self, camera: &Camera) -> Fallible<Edited> {
        let text = self.source.text();
        let edited = (self.scene).edited(&self.loaded, text.as_deref(), Some(camera));
        Ok(edited?)
    }

    /// With all changes, without the effects that are off.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn without_effects(&self) -> Scene {
        without(&self.scene, &self.shown)
    }

    pub fn reset(&mut self) -> Fallible<()> {
        self.show(self.loaded.clone(), Shown::default())
    }

    /// Draws a scene, or a part of it; where that fails, all stays as it was.
    fn show(&mut self, scene: Scene, shown: Shown) -> Fallible<()> {
        let mut drawn = without(&scene, &shown);
        if let Some(layers) = shown.layers {
            drawn = drawn.layer_view(layers.highlight, shown.shade_all)?;
        }
        self.renderer = Rc::new(Renderer::new(&self.gpu, &drawn)?);
        self.renderer_number = next_number();
        (self.scene, self.shown) = (scene, shown);
        self.version = next_number();
        Ok(())
    }

    pub fn set_transform(&mut self, object: usize, to: glam::Mat4) -> Fallible<()> {
        self.scene.objects[object].world_from_object = to;
        self.edit(|renderer| renderer.set_transform(object, to))
    }

    pub fn set_material(&mut self, object: usize, part: usize, to: Material) -> Fallible<()> {
        self.scene.objects[object].materials[part] = to.clone();
        self.edit(|renderer| renderer.set_material(object, part, to))
    }

    pub fn set_lights(&mut self, lights: Vec<Light>) -> Fallible<()> {
        self.scene.lights.clone_from(&lights);
        self.edit(|renderer| renderer.set_lights(lights))
    }

    /// Changes the renderer in place; where something is still measured with it, or shows layers, another one is made.
    fn edit(
        &mut self,
        change: impl FnOnce(&mut Renderer) -> Result<(), RenderError>,
    ) -> Fallible<()> {
        self.version = next_number();
        let is_all = self.shown == Shown::default();
        match Rc::get_mut(&mut self.renderer) {
            Some(renderer) if is_all => Ok(change(renderer)?),
            _ => self.show(self.scene.clone(), self.shown.clone()),
        }
    }
}

fn without(scene: &Scene, shown: &Shown) -> Scene {
    let off = shown.off.iter().copied().filter_map(Effect::find);
    off.fold(scene.clone(), |scene, effect| scene.without(effect))
}
