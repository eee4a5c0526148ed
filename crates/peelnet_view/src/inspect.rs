//! One pixel: its fragments front to back, and how much of each the method takes to be seen.

use crate::{numbers::Key, slot::Slot, stage::Stage, task::Job};
use peelnet_render::PixelFragment;
use std::rc::Rc;

/// A fragment, the exact transmittance in front of it, and the one that the method's weights stand for.
pub(crate) struct Layer {
    pub fragment: PixelFragment,
    pub object: String,
    pub exact: f64,
    pub believed: Option<f64>,
}

#[derive(Default)]
pub(crate) struct Inspector {
    /// The pixel, from the upper left corner.
    pub pixel: Option<[u32; 2]>,
    pub job: Job<(Key, [u32; 2]), Vec<Layer>>,
}

impl Inspector {
    pub fn layers(&self) -> Option<&Result<Vec<Layer>, String>> {
        let ((_, pixel), layers) = self.job.last.as_ref()?;
        (Some(*pixel) == self.pixel).then_some(layers)
    }

    /// Begins to look, unless what is shown is known.
    pub fn want(&mut self, stage: &Stage, slot: &Slot, key: Key) {
        let view = key.view;
        let is_inside = |p: &[u32; 2]| p[0] < view.size[0] && p[1] < view.size[1];
        let Some(pixel) = self.pixel.filter(is_inside) else {
            return;
        };
        let key = (key, pixel);
        if !self.job.wants(&key) {
            return;
        }
        let renderer = Rc::clone(&stage.renderer);
        let (spec, model) = (slot.spec.clone(), slot.model());
        self.job.begin(key, async move {
            let fragments = renderer.pixel_async(&view.camera, view.size, pixel).await?;
            let points: Vec<(f32, f32)> = fragments.iter().map(|f| (f.depth, f.alpha)).collect();
            let warp = renderer.depth_warp(&view.camera);
            let believed = spec.transmittances(&points, &warp, model.as_ref());
            let mut exact = 1.0;
            let layers = fragments.iter().enumerate().map(|(i, fragment)| {
                let scene = renderer.scene();
                let object = fragment.object(scene).map(|k| &scene.objects[k].name);
                let name = object.map(|name| peelnet_core::files::printable(name).to_string());
                let layer = Layer {
                    fragment: *fragment,
                    object: name.unwrap_or_default(),
                    exact,
                    believed: believed.as_ref().map(|all| all[i]),
                };
                exact *= 1.0 - f64::from(fragment.alpha);
                layer
            });
            Ok(layers.collect())
        });
    }
}
