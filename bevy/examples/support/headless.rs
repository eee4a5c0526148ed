//! An application that draws into an image and reads it.

use super::{
    cards::{self, BACKGROUND, Card, EYE},
    exact::{self, Errors},
};
use bevy::{
    app::{PluginsState, TerminalCtrlCHandlerPlugin},
    camera::{Hdr, RenderTarget},
    core_pipeline::tonemapping::{DebandDither, Tonemapping},
    log::{Level, LogPlugin},
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
    atomic::{AtomicBool, Ordering},
    mpsc,
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
        Self::with_settings(size, msaa, plugin, scene, WgpuSettings::default())
    }

    pub fn with_settings(
        size: UVec2,
        msaa: Msaa,
        plugin: impl Into<PeelnetPlugin>,
        scene: &[Card],
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
        let log = LogPlugin {
            level: Level::WARN,
            filter: String::new(),
            ..default()
        };
        let mut plugins = DefaultPlugins
            .set(window)
            .set(render)
            .set(log)
            // Several applications in one process would each want to be told.
            .disable::<TerminalCtrlCHandlerPlugin>();
        // The first of a process logs for all.
        if LOGGED.swap(true, Ordering::Relaxed) {
            plugins = plugins.disable::<LogPlugin>();
        }
        let mut app = App::new();
        app.add_plugins((plugins, plugin.into()))
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
        cards::spawn(&mut app, scene);
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
        let exact = exact::picture(scene, self.size, samples);
        let errors = exact::errors_of(&exact, &self.picture());
        // The rest is edges.
        assert!(errors.judged > 0.85, "{errors:?}");
        errors
    }

    /// No channel of a pixel is farther than this from the exact picture of a scene.
    pub fn assert_exact(&mut self, scene: &[Card], most: f64) {
        let errors = self.errors(scene);
        assert!(errors.max <= most, "{errors:?}");
    }

    /// Bevy sorts [two cards that face the camera](cards::facing) rightly, so that both techniques must give one picture. Returns it.
    pub fn same_when_sorted(mut self) -> Vec<u8> {
        let weighed = self.picture();
        self.sort();
        let sorted = self.picture();
        let apart = weighed.iter().zip(&sorted).map(|(a, b)| a.abs_diff(*b));
        let most = apart.max();
        assert!(most <= Some(1), "{most:?}");
        sorted
    }

    pub fn messages(&self) -> Vec<(Gravity, String)> {
        self.app.world().resource::<PeelnetMessages>().all()
    }

    /// The plugin reported one message, which says all of this.
    pub fn assert_said(&self, gravity: Gravity, says: &[&str]) {
        let said = self.messages();
        assert_eq!(said.len(), 1, "{said:?}");
        assert_eq!(said[0].0, gravity, "{said:?}");
        let all = says.iter().all(|text| said[0].1.contains(text));
        assert!(all, "{said:?}");
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
        let (sender, receiver) = mpsc::channel();
        // Not `ReadbackOnce`: Bevy removes one before the frame if it was spawned between two frames.
        let readback = Readback::texture(self.image.clone());
        let mut reader = self.app.world_mut().spawn(readback);
        reader.observe(move |event: On<ReadbackComplete>| {
            let _ = sender.send(event.data.clone());
        });
        let reader = reader.id();
        for _ in 0..FRAMES_TO_READ {
            self.app.update();
            if let Ok(bytes) = receiver.try_recv() {
                self.app.world_mut().despawn(reader);
                return bytes;
            }
        }
        panic!("the image was not read back within {FRAMES_TO_READ} frames");
    }

    pub fn camera(&mut self) -> EntityWorldMut<'_> {
        self.app.world_mut().entity_mut(self.camera)
    }
}
