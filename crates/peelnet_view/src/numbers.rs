//! How far the picture is from the exact one, measured while the view rests.

use crate::{
    slot::Slot,
    stage::{Stage, one_line},
    task::{Task, computed},
};
use peelnet_eval::metrics;
#[cfg(not(target_arch = "wasm32"))]
use peelnet_eval::perceptual::Displayed;
use peelnet_gpu::wgpu;
use peelnet_render::{
    FrameStats, Image, LearnedWeight, MethodOptions, MethodSpec, Prepared, RenderError, Renderer,
    Role,
};
use peelnet_scene::Camera;
use std::{rc::Rc, sync::Arc};

/// The method that others are judged by.
pub(crate) const EXACT: &str = Role::Reference.method();

/// What an error was measured of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Key {
    version: u64,
    camera: Camera,
    size: [u32; 2],
    method: String,
    network: Option<std::path::PathBuf>,
}

impl Key {
    /// Whether both are of the same view, whatever the method.
    pub fn has_view_of(&self, other: &Self) -> bool {
        (self.version, self.camera, self.size) == (other.version, other.camera, other.size)
    }

    pub const fn camera(&self) -> Camera {
        self.camera
    }

    pub fn of(stage: &Stage, slot: &Slot, camera: &Camera, size: [u32; 2]) -> Self {
        Self {
            version: stage.version(),
            camera: *camera,
            size,
            method: slot.spec().to_string(),
            network: slot.network().map(|n| n.path.clone()),
        }
    }
}

/// Errors of a picture against the exact one.
#[derive(Clone, Debug)]
pub(crate) struct Numbers {
    pub mse255: f64,
    pub psnr: Option<f64>,
    pub max_error: f64,
    /// Mean ꟻLIP; none in a page, for which its code is not compiled.
    pub flip: Option<f64>,
    pub non_finite: u64,
    /// Of the exact method's frame.
    pub stats: FrameStats,
}

/// The exact image of a view.
#[derive(Clone, Debug)]
struct Exact {
    version: u64,
    camera: Camera,
    image: Arc<Image>,
    stats: FrameStats,
}

/// The exact image that was compared with, and the errors.
type Judged = Result<(Exact, Numbers), String>;

/// Measures again whenever the view or the method has changed and rests.
#[derive(Debug, Default)]
pub(crate) struct Judge {
    task: Option<(Key, Task<Judged>)>,
    exact: Option<Exact>,
    pub last: Option<(Key, Result<Numbers, String>)>,
}

impl Judge {
    /// Whether it is measuring.
    pub const fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    /// Ends what goes on, so that the scene may change.
    pub fn cancel(&mut self) {
        self.task = None;
    }

    /// The numbers of what is shown, where they are known.
    pub fn of(&self, key: &Key) -> Option<&Result<Numbers, String>> {
        let (of, numbers) = self.last.as_ref()?;
        (of == key).then_some(numbers)
    }

    /// Begins to measure what is shown, unless that is known.
    pub fn want(&mut self, stage: &Stage, slot: &Slot, key: Key) {
        if self.task.is_some() || self.of(&key).is_some() {
            return;
        }
        let known = self.exact.clone().filter(|e| {
            let size = [e.image.width, e.image.height];
            (e.version, e.camera, size) == (key.version, key.camera, key.size)
        });
        let renderer = Rc::clone(stage.renderer());
        let work = measured(
            renderer,
            key.clone(),
            slot.spec().clone(),
            slot.learned().cloned(),
            known,
        );
        self.task = Some((key, Task::new(work)));
    }

    /// Goes on.
    pub fn poll(&mut self, ui: &egui::Context) {
        let Some((_, task)) = &mut self.task else {
            return;
        };
        if let Some(result) = task.poll(ui)
            && let Some((key, _)) = self.task.take()
        {
            let numbers = result.map(|(exact, numbers)| {
                self.exact = Some(exact);
                numbers
            });
            self.last = Some((key, numbers));
        }
    }
}

async fn measured(
    renderer: Rc<Renderer>,
    key: Key,
    method: MethodSpec,
    learned: Option<LearnedWeight>,
    known: Option<Exact>,
) -> Judged {
    let readable = |e: RenderError| one_line(&e);
    let exact = match known {
        Some(exact) => exact,
        None => {
            let spec: MethodSpec = EXACT.parse().map_err(readable)?;
            let mut prepared = renderer
                .method(&spec, MethodOptions::sized(key.size))
                .map_err(readable)?;
            let frame = renderer.image_async(&mut prepared, &key.camera).await;
            let frame = frame.map_err(readable)?;
            Exact {
                version: key.version,
                camera: key.camera,
                image: Arc::new(frame.image),
                stats: frame.stats,
            }
        }
    };
    let options = MethodOptions::sized(key.size).with(learned.as_ref());
    let mut prepared = renderer.method(&method, options).map_err(readable)?;
    let frame = renderer.image_async(&mut prepared, &key.camera).await;
    let image = frame.map_err(readable)?.image;
    let (judge, stats) = (Arc::clone(&exact.image), exact.stats);
    let numbers = computed(move || {
        let differences = metrics::differences(&judge.pixels, &image.pixels)?;
        Ok::<_, peelnet_eval::EvalError>(Numbers {
            mse255: differences.mse255,
            psnr: differences.psnr,
            max_error: differences.max_error,
            flip: flip(&judge, &image),
            non_finite: differences.non_finite_pixels,
            stats,
        })
    });
    match numbers.await {
        Some(numbers) => Ok((exact, numbers.map_err(|e| one_line(&e))?)),
        None => Err("the comparison failed".into()),
    }
}

/// Mean ꟻLIP.
#[cfg(not(target_arch = "wasm32"))]
fn flip(exact: &Image, image: &Image) -> Option<f64> {
    Some(Displayed::new(image).flip(&Displayed::new(exact)))
}

#[cfg(target_arch = "wasm32")]
const fn flip(_: &Image, _: &Image) -> Option<f64> {
    None
}

/// How many fragments each pixel has, as a texture; and the most.
#[derive(Debug)]
pub(crate) struct LayerMap {
    key: (u64, Camera, [u32; 2]),
    pub texture: wgpu::TextureView,
    pub most: f32,
}

/// Counts layers when asked to, and keeps the last map.
#[derive(Debug, Default)]
pub(crate) struct LayerCounter {
    task: Option<Task<Result<LayerMap, String>>>,
    pub map: Option<Result<LayerMap, String>>,
}

impl LayerCounter {
    pub fn cancel(&mut self) {
        self.task = None;
    }

    /// Begins to count, unless the map is of this view.
    pub fn want(&mut self, stage: &Stage, camera: &Camera, size: [u32; 2]) {
        let key = (stage.version(), *camera, size);
        let is_known = self
            .map
            .as_ref()
            .is_some_and(|m| m.as_ref().is_ok_and(|m| m.key == key));
        if self.task.is_none() && !is_known {
            let renderer = Rc::clone(stage.renderer());
            self.task = Some(Task::new(counted(renderer, key)));
        }
    }

    pub fn poll(&mut self, ui: &egui::Context) {
        if let Some(task) = &mut self.task
            && let Some(map) = task.poll(ui)
        {
            self.map = Some(map);
            self.task = None;
            ui.request_repaint();
        }
    }
}

async fn counted(renderer: Rc<Renderer>, key: (u64, Camera, [u32; 2])) -> Result<LayerMap, String> {
    let readable = |e: RenderError| one_line(&e);
    let size = key.2;
    let mut prepared: Prepared = renderer.surfaces(size, 1).map_err(readable)?;
    let frame = renderer.image_async(&mut prepared, &key.1).await;
    let image = frame.map_err(readable)?.image;
    let gpu = renderer.gpu();
    let format = wgpu::TextureFormat::Rgba32Float;
    let texture = gpu
        .texture("layers", format, size, 1, wgpu::TextureUsages::COPY_DST)
        .map_err(|e| one_line(&e))?;
    gpu.queue.write_texture(
        texture.texture().as_image_copy(),
        bytemuck::cast_slice(&image.pixels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(size[0] * 16),
            rows_per_image: None,
        },
        texture.texture().size(),
    );
    let most = image.pixels.iter().map(|p| p[3]).fold(0.0, f32::max);
    Ok(LayerMap { key, texture, most })
}
