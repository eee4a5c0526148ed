//! Draws the shipped network `deep-medium` into a texture of this program's own, with commands of its own.
//!
//! `cargo run --example own_texture -- IMAGE.png`

use peelnet::gpu::wgpu;
use peelnet::{AdapterRequest, Gpu, MethodOptions, Renderer, Target};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let gpu = Gpu::open(&AdapterRequest::Auto)?;
    let scene = peelnet::scene::suite::load("cups-held")?;
    let renderer = Renderer::new(&gpu, &scene)?;
    let mut method = renderer.method(&"deep-medium".parse()?, MethodOptions::default())?;

    // A window's surface texture serves as well.
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let usage = wgpu::TextureUsages::COPY_SRC;
    let view = gpu.texture("my texture", format, [640, 480], 1, usage)?;
    let mut encoder = gpu.encoder();
    let target = Target::cleared(&view);
    renderer.draw(&mut encoder, &mut method, &scene.views[0], &target)?;

    gpu.queue.submit([encoder.finish()]);

    let pixels: Vec<[u8; 4]> = gpu.read_texture(&view)?;
    let path = std::env::args().nth(1).unwrap_or("cups.png".into());
    let bytes = pixels.as_flattened();
    image::save_buffer(&path, bytes, 640, 480, image::ColorType::Rgba8)?;
    println!("{path}: cups-held by deep-medium");
    Ok(())
}
