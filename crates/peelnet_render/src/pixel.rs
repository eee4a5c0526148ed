//! The fragments of one pixel, for people who want to see what a method composites.

use crate::geometry::{
    PixelSample, SamplePoint, count::CountPass, frame::Output, sbuffer::SBuffer,
};
use crate::gpu::record::Recorder;
use crate::{RenderError, renderer::Renderer};
use peelnet_scene::Camera;

/// A transparent fragment of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFragment {
    /// Linear depth, scene units.
    pub depth: f32,
    /// Opacity.
    pub alpha: f32,
    /// Radiance, linear RGB, not multiplied with the opacity.
    pub color: [f32; 3],
    /// The triangle, in the order of the scene's objects.
    pub triangle: u32,
}

impl PixelFragment {
    /// The object that it belongs to, as a number in the scene's list.
    pub fn object(&self, scene: &peelnet_scene::Scene) -> Option<usize> {
        let mut end = 0;
        scene.objects.iter().position(|object| {
            end += object.mesh.triangles.len();
            (self.triangle as usize) < end
        })
    }
}

impl Renderer {
    /// The transparent fragments of one pixel of a frame of this size, nearest first. `pixel` counts from the upper left corner. What opaque
    /// surfaces hide is left out.
    ///
    /// The pixel is drawn as a frame of its own, so this takes no memory to speak of; positions are rounded otherwise than in the large
    /// frame, which moves depths by their last bits, and an edge that runs through the middle of the pixel may fall on its other side.
    ///
    /// # Errors
    /// A pixel outside the frame, a scene whose transmission is coloured, or a lost device.
    pub async fn pixel_async(
        &self,
        camera: &Camera,
        size: [u32; 2],
        pixel: [u32; 2],
    ) -> Result<Vec<PixelFragment>, RenderError> {
        let (gpu, scene) = (&self.gpu, &self.scene);
        if pixel[0] >= size[0] || pixel[1] >= size[1] {
            return Err(RenderError::Target(format!(
                "pixel {}, {} lies outside its {} x {} pixels",
                pixel[0], pixel[1], size[0], size[1]
            )));
        }
        if scene.tinted {
            return Err(RenderError::Target(
                "this scene's transmission is coloured: its fragments have no single opacity to list".into(),
            ));
        }
        let mut frame = scene.targets([1, 1], Output::Image, None)?;
        frame.aspect = size[0] as f32 / size[1] as f32;
        let mut sbuffer = SBuffer::new(scene, &frame, None, &["dataset"])?;
        let mut encoder = gpu.encoder();
        let mut recorder = Recorder::new(gpu, &mut encoder, None);
        let point = SamplePoint::of_pixel(size, pixel);
        scene.set_view(&mut recorder, camera, &frame, PixelSample::ALL, point);
        scene.draw_background(&mut recorder, &frame, None, true);
        sbuffer.count.encode(&mut recorder, scene, &frame);
        gpu.queue.submit([encoder.finish()]);
        let found = CountPass::parse(&gpu.read_async(&sbuffer.count.total).await?)?;
        let planned = sbuffer.plan(scene, &frame, found, None)?;
        let Some((tiles, _)) = planned.filter(|_| found.total > 0) else {
            return Ok(Vec::new());
        };
        let mut encoder = gpu.encoder();
        let mut recorder = Recorder::new(gpu, &mut encoder, None);
        for tile in &tiles {
            sbuffer.store_and_sort(&mut recorder, scene, &frame, tile);
        }
        gpu.queue.submit([encoder.finish()]);
        let Some(storage) = sbuffer.storage() else {
            return Ok(Vec::new());
        };
        CountPass::check(&gpu.read_async(&sbuffer.count.faults).await?, 1)?;
        let depths: Vec<f32> = gpu.read_async(&storage.depths).await?;
        let triangles: Vec<u32> = gpu.read_async(&storage.triangles).await?;
        let colors: Vec<[f32; 4]> = gpu.read_async(&storage.colors).await?;
        let order: Vec<u32> = match sbuffer.long_runs() {
            Some(long) => gpu.read_async(&long.order).await?,
            None => (0..found.total as u32).collect(),
        };
        let fragment = |slot: u32| {
            let slot = slot as usize;
            let [r, g, b, alpha] = colors[slot];
            PixelFragment {
                depth: depths[slot],
                alpha,
                color: [r, g, b],
                triangle: triangles[slot],
            }
        };
        Ok(order.into_iter().map(fragment).collect())
    }
}
