//! Draws a scene with a shipped network (`deep-medium`) into a texture of the program's own, in commands of its own.
//!
//! `cargo run --example draw_into_texture -- IMAGE.png`

use peelnet::{AdapterRequest, Gpu, MethodOptions, Renderer, Target, scene::suite};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let gpu = Gpu::open(&AdapterRequest::Auto)?;
    let scene = suite::load("cups")?;
    let renderer = Renderer::new(&gpu, &scene)?;
    let mut method = renderer.method(&"deep-medium".parse()?, MethodOptions::default())?;

    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d {
            width: 640,
            height: 480,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let mut encoder = gpu.encoder();
    let target = Target::cleared(&view);
    renderer.draw(&mut encoder, &mut method, &scene.views[0], &target)?;
    gpu.queue.submit([encoder.finish()]);

    let pixels: Vec<[u8; 4]> = gpu.read_texture(&view)?;
    let path = std::env::args().nth(1);
    let path = path.unwrap_or_else(|| "draw_into_texture.png".into());
    image::save_buffer(
        &path,
        pixels.as_flattened(),
        640,
        480,
        image::ColorType::Rgba8,
    )?;
    println!("{path}");
    Ok(())
}
