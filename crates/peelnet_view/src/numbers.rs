//! How far the picture is from the exact one, measured while the view rests; and how many fragments its pixels have.

use crate::{
    slot::{Shot, Slot},
    stage::{Stage, View},
    task::{Fallible, Job, computed},
};
use peelnet_bench::metrics::{self, Differences};
use peelnet_render::gpu::wgpu;
use peelnet_render::{FrameStats, Image, MethodOptions, Renderer, role};
use std::{rc::Rc, sync::Arc};

pub(crate) const EXACT: &str = role::REFERENCE;

/// What an error was measured of.
#[derive(Clone, PartialEq)]
pub(crate) struct Key {
    pub view: View,
    pub method: String,
    pub network: Option<u64>,
}

pub(crate) struct Numbers {
    pub differences: Differences,
    /// Mean ꟻLIP; none in a page, for which its code is not compiled.
    pub flip: Option<f64>,
    exact: Arc<Image>,
    /// Of the exact method's frame.
    pub stats: FrameStats,
}

/// Measures again whenever the view or the method has changed and rests.
pub(crate) type ErrorJob = Job<Key, Numbers>;

impl ErrorJob {
    pub fn want(&mut self, stage: &Stage, slot: &Slot, key: Key) {
        if self.wants(&key) {
            let last = self.last.as_ref().filter(|(of, _)| of.view == key.view);
            let last = last.and_then(|(_, numbers)| numbers.as_ref().ok());
            let exact = last.map(|numbers| (Arc::clone(&numbers.exact), numbers.stats));
            let work = measured(slot.shot(stage, key.view.size), key.view, exact);
            self.begin(key, work);
        }
    }
}

async fn measured(
    shot: Shot,
    view: View,
    known: Option<(Arc<Image>, FrameStats)>,
) -> Fallible<Numbers> {
    let (exact, stats) = match known {
        Some(known) => known,
        None => {
            let exact = Shot {
                renderer: Rc::clone(&shot.renderer),
                spec: EXACT.parse()?,
                options: MethodOptions::sized(view.size),
            };
            let frame = exact.frame(&view.camera).await?;
            (Arc::new(frame.image), frame.stats)
        }
    };
    let image = shot.frame(&view.camera).await?.image;
    let judge = Arc::clone(&exact);
    let compared = computed(move || {
        let differences = metrics::differences(&judge.pixels, &image.pixels);
        (differences, flip(&judge, &image))
    });
    let (differences, flip) = compared.await?;
    Ok(Numbers {
        differences,
        flip,
        exact,
        stats,
    })
}

#[cfg(not(target_arch = "wasm32"))]
fn flip(exact: &Image, image: &Image) -> Option<f64> {
    use peelnet_bench::perceptual::Displayed;
    Some(Displayed::new(image).flip(&Displayed::new(exact)))
}

#[cfg(target_arch = "wasm32")]
const fn flip(_: &Image, _: &Image) -> Option<f64> {
    None
}

/// How many fragments each pixel has, as a texture; and the most.
pub(crate) struct LayerMap {
    pub texture: wgpu::TextureView,
    pub most: f32,
}

/// Counts layers when asked to, and keeps the last map.
pub(crate) type LayerCounter = Job<View, LayerMap>;

impl LayerCounter {
    pub fn want(&mut self, stage: &Stage, view: View) {
        if self.wants(&view) {
            self.begin(view, counted(Rc::clone(&stage.renderer), view));
        }
    }

    pub fn map(&self) -> Option<&LayerMap> {
        self.last.as_ref()?.1.as_ref().ok()
    }
}

async fn counted(renderer: Rc<Renderer>, view: View) -> Fallible<LayerMap> {
    let mut prepared = renderer.surfaces(view.size, 1)?;
    let frame = renderer.image_async(&mut prepared, &view.camera).await?;
    let pixels = frame.image.pixels;
    let gpu = renderer.gpu();
    let format = wgpu::TextureFormat::Rgba32Float;
    let usage = wgpu::TextureUsages::COPY_DST;
    let texture = gpu.texture("layers", format, view.size, 1, usage)?;
    gpu.queue.write_texture(
        texture.texture().as_image_copy(),
        bytemuck::cast_slice(&pixels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(view.size[0] * 16),
            rows_per_image: None,
        },
        texture.texture().size(),
    );
    let most = pixels.iter().map(|p| p[3]).fold(0.0, f32::max);
    Ok(LayerMap { texture, most })
}
