//! The texture that the window shows, made of the pictures of one or two methods.

use crate::{slot::size_of, task::Fallible};
use bytemuck::{Pod, Zeroable};
use eframe::egui_wgpu::RenderState;
use peelnet_render::geometry::fullscreen::FullscreenPass;
use peelnet_render::gpu::{Gpu, GpuError, bind::Bind, record::Recorder, wgpu};

/// Format of what egui shows: encoded values, as egui expects of textures.
const SHOWN: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Layout of `View` in `display.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable, PartialEq)]
pub(crate) struct View {
    pub show: u32,
    pub divider: u32,
    pub scale: f32,
    /// Whether the pictures are in display space.
    pub is_encoded: u32,
}

/// The last pass of the viewer, for these pictures, and its target.
pub(crate) struct Display {
    view: wgpu::Buffer,
    pass: Option<([wgpu::TextureView; 2], FullscreenPass)>,
    target: Option<(wgpu::TextureView, egui::TextureId)>,
}

impl Display {
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            view: gpu.upload("display", &[View::zeroed()], wgpu::BufferUsages::UNIFORM),
            pass: None,
            target: None,
        }
    }

    pub fn texture(&self) -> Option<egui::TextureId> {
        self.target.as_ref().map(|(_, id)| *id)
    }

    #[cfg(test)]
    pub fn texels(&self, gpu: &Gpu) -> Vec<[u8; 4]> {
        let (view, _) = self.target.as_ref().expect("something was drawn");
        gpu.read_texture(view).expect("reads back")
    }

    /// Records the pass. A second picture that is not read may be the first.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        egui: &RenderState,
        encoder: &mut wgpu::CommandEncoder,
        size: [u32; 2],
        pictures: [&wgpu::TextureView; 2],
        view: View,
    ) -> Fallible<()> {
        const SHADER: &str = "display";
        let target = self.sized(gpu, egui, size)?;
        (gpu.queue).write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        let pictures = pictures.map(wgpu::TextureView::clone);
        if self.pass.as_ref().is_none_or(|(of, _)| *of != pictures) {
            let text = [(SHADER, include_str!("display.wgsl"))];
            let [first, second] = pictures.each_ref().map(Bind::Texture);
            let view = Bind::Uniform(&self.view);
            let entries = [("first", first), ("second", second), ("view", view)];
            let targets = [Some(SHOWN.into())];
            let pass = FullscreenPass::new(gpu, SHADER, &[], &text, &entries, &targets, 1)?;
            self.pass = Some((pictures, pass));
        }
        if let Some((_, pass)) = &self.pass {
            let target = wgpu::RenderPassColorAttachment {
                view: &target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            };
            let mut recorder = Recorder::new(gpu, encoder, None);
            pass.draw(&mut recorder, &[Some(target)], None);
        }
        Ok(())
    }

    fn sized(
        &mut self,
        gpu: &Gpu,
        egui: &RenderState,
        size: [u32; 2],
    ) -> Result<wgpu::TextureView, GpuError> {
        if let Some((view, _)) = &self.target
            && size_of(view) == size
        {
            return Ok(view.clone());
        }
        let usage = wgpu::TextureUsages::COPY_SRC;
        let view = gpu.texture("display", SHOWN, size, 1, usage)?;
        let mut renderer = egui.renderer.write();
        let nearest = wgpu::FilterMode::Nearest;
        let id = match self.target.take() {
            Some((_, id)) => {
                renderer.update_egui_texture_from_wgpu_texture(&gpu.device, &view, nearest, id);
                id
            }
            None => renderer.register_native_texture(&gpu.device, &view, nearest),
        };
        self.target = Some((view.clone(), id));
        Ok(view)
    }
}
