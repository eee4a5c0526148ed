//! An application that draws into an image and reads it.

use super::{
    cards::{self, BACKGROUND, Card, EYE},
    exact::{self, Errors},
};
use bevy::{
    app::PluginsState,
    camera::{Hdr, RenderTarget},
    core_pipeline::tonemapping::{DebandDither, Tonemapping},
    prelude::*,
    render::{
        RenderPlugin,
        gpu_readback::{Readback, ReadbackComplete},
        render_resource::{TextureFormat, TextureUsages},
        settings::WgpuSettings,
    },
    window::ExitCondition,
};
use bevy_peelnet::{Gravity, LearnedTransparency, PeelnetMessages, PeelnetPlugin};
use std::sync::{
    Arc, Mutex,
    atomic::{AtomicBool, Ordering},
};

/// Frames after which all pipelines are there: Bevy's come in one frame, ours a frame later, and a shader may come late.
const FRAMES_TO_SETTLE: u32 = 8;
const FRAMES_TO_READ: u32 = 100;

static LOGGED: AtomicBool = AtomicBool::new(false);

pub struct Headless {
    pub app: App,
    pub camera: Entity,
    size: UVec2,
    image: Handle<Image>,
}

impl Headless {
    /// A camera that sees cards. The width must be a multiple of 64: rows are read as they are copied.
    pub fn new(size: UVec2, msaa: Msaa, plugin: impl Into<PeelnetPlugin>, scene: &[Card]) -> Self {
        let mut headless = Self::with_settings(size, msaa, plugin.into(), WgpuSettings::default());
        cards::spawn(&mut headless.app, scene);
        headless
    }

    pub fn with_settings(
        size: UVec2,
        msaa: Msaa,
        plugin: PeelnetPlugin,
        settings: WgpuSettings,
    ) -> Self {
        assert!(size.x.is_multiple_of(64));
        let window = WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        };
        let render = RenderPlugin {
            render_creation: settings.into(),
            synchronous_pipeline_compilation: true,
            ..default()
        };
        let plugins = DefaultPlugins
            .set(window)
            .set(render)
            .set(bevy::log::LogPlugin {
                level: bevy::log::Level::WARN,
                filter: String::new(),
                ..default()
            })
            // Several applications in one process would each want to be told.
            .disable::<bevy::app::TerminalCtrlCHandlerPlugin>();
        let mut app = App::new();
        // The first of a process logs for all.
        if LOGGED.swap(true, Ordering::Relaxed) {
            app.add_plugins(plugins.disable::<bevy::log::LogPlugin>());
        } else {
            app.add_plugins(plugins);
        }
        app.add_plugins(plugin)
            .insert_resource(ClearColor(BACKGROUND.into()));
        let mut image =
            Image::new_target_texture(size.x, size.y, TextureFormat::Rgba8UnormSrgb, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        let camera = (
            Camera3d::default(),
            RenderTarget::Image(image.clone().into()),
            Hdr,
            Tonemapping::None,
            DebandDither::Disabled,
            msaa,
            Transform::from_translation(EYE).looking_at(Vec3::ZERO, Vec3::Y),
        );
        let camera = app.world_mut().spawn(camera).id();
        Self {
            app,
            camera,
            size,
            image,
        }
    }

    pub fn learned(mut self) -> Self {
        self.camera().insert(LearnedTransparency::default());
        self
    }

    pub fn sort(&mut self) {
        self.camera().remove::<LearnedTransparency>();
    }

    /// How far the picture is from the exact one of a scene.
    pub fn errors(&mut self, scene: &[Card]) -> Errors {
        let msaa = self.app.world().get::<Msaa>(self.camera);
        let samples = msaa.map_or(1, Msaa::samples);
        let errors = exact::picture(scene, self.size, samples).errors_of(&self.picture());
        // The rest is edges.
        assert!(errors.judged > 0.85, "{errors:?}");
        errors
    }

    pub fn messages(&self) -> Vec<(Gravity, String)> {
        self.app.world().resource::<PeelnetMessages>().all()
    }

    /// Draws frames. Plugins are made ready first: the last one is added by now.
    pub fn run(&mut self, frames: u32) {
        while self.app.plugins_state() == PluginsState::Adding {
            bevy::tasks::tick_global_task_pools_on_main_thread();
        }
        if self.app.plugins_state() == PluginsState::Ready {
            self.app.finish();
            self.app.cleanup();
        }
        for _ in 0..frames {
            self.app.update();
        }
    }

    /// The picture of a settled frame: four bytes a pixel, encoded as for a screen.
    pub fn picture(&mut self) -> Vec<u8> {
        self.run(FRAMES_TO_SETTLE);
        let bytes: Arc<Mutex<Option<Vec<u8>>>> = Arc::default();
        let into = Arc::clone(&bytes);
        // Not `ReadbackOnce`: Bevy removes one before the frame if it was spawned between two frames.
        let reader = self
            .app
            .world_mut()
            .spawn(Readback::texture(self.image.clone()))
            .observe(move |event: On<ReadbackComplete>| {
                if let Ok(mut bytes) = into.lock() {
                    *bytes = Some(event.data.clone());
                }
            })
            .id();
        for _ in 0..FRAMES_TO_READ {
            self.app.update();
            let read = bytes.lock().ok().and_then(|mut bytes| bytes.take());
            if let Some(read) = read {
                self.app.world_mut().despawn(reader);
                return read;
            }
        }
        panic!("the image was not read back within {FRAMES_TO_READ} frames");
    }

    pub fn camera(&mut self) -> EntityWorldMut<'_> {
        self.app.world_mut().entity_mut(self.camera)
    }
}
