//! One pixel: its fragments front to back, and how much of each the method takes to be seen.

use crate::{
    numbers::Key,
    slot::{Slot, model_of},
    stage::{Stage, one_line},
    task::Task,
};
use peelnet_render::PixelFragment;
use std::rc::Rc;

/// A fragment, the exact transmittance in front of it, and the one that the method's weights stand for.
#[derive(Clone, Debug)]
pub(crate) struct Layer {
    pub fragment: PixelFragment,
    pub object: String,
    pub exact: f64,
    pub believed: Option<f64>,
}

/// Layers, or why there are none.
type Layers = Result<Vec<Layer>, String>;

/// The fragments of the pixel that was clicked.
#[derive(Debug, Default)]
pub(crate) struct Inspector {
    /// The pixel, from the upper left corner.
    pub pixel: Option<[u32; 2]>,
    task: Option<(Key, Task<Layers>)>,
    last: Option<(Key, [u32; 2], Layers)>,
}

impl Inspector {
    pub fn cancel(&mut self) {
        self.task = None;
    }

    /// The layers of the pixel, where they are known.
    pub fn layers(&self) -> Option<&Layers> {
        let (_, pixel, layers) = self.last.as_ref()?;
        (Some(*pixel) == self.pixel).then_some(layers)
    }

    /// Begins to look, unless what is shown is known.
    pub fn want(&mut self, stage: &Stage, slot: &Slot, key: Key, size: [u32; 2]) {
        let Some(pixel) = self.pixel.filter(|p| p[0] < size[0] && p[1] < size[1]) else {
            return;
        };
        let is_known = self
            .last
            .as_ref()
            .is_some_and(|(of, at, _)| (of, *at) == (&key, pixel));
        if is_known || self.task.is_some() {
            return;
        }
        let camera = key.camera();
        let renderer = Rc::clone(stage.renderer());
        let spec = slot.spec().clone();
        let model = model_of(&spec, slot.network());
        let work = async move {
            let fragments = renderer
                .pixel_async(&camera, size, pixel)
                .await
                .map_err(|e| one_line(&e))?;
            let points: Vec<(f32, f32)> = fragments.iter().map(|f| (f.depth, f.alpha)).collect();
            let warp = renderer.depth_warp(&camera);
            let believed = spec.transmittances(&points, &warp, model.as_ref());
            let mut exact = 1.0;
            let layers = fragments.iter().enumerate().map(|(i, fragment)| {
                let scene = renderer.scene();
                let object = fragment.object(scene).map(|k| &scene.objects[k].name);
                let layer = Layer {
                    fragment: *fragment,
                    object: object.map_or_else(String::new, |name| {
                        peelnet_files::printable(name).to_string()
                    }),
                    exact,
                    believed: believed.as_ref().map(|all| all[i]),
                };
                exact *= 1.0 - f64::from(fragment.alpha);
                layer
            });
            Ok(layers.collect())
        };
        self.task = Some((key, Task::new(work)));
    }

    pub fn poll(&mut self, ui: &egui::Context) {
        let Some((_, task)) = &mut self.task else {
            return;
        };
        if let Some(layers) = task.poll(ui)
            && let Some((key, _)) = self.task.take()
            && let Some(pixel) = self.pixel
        {
            self.last = Some((key, pixel, layers));
        }
    }
}
