//! Draws the shipped network `deep-medium` into a texture of this program's own, over what it holds.
//!
//! `cargo run --example own_texture -- IMAGE.png`

use peelnet::gpu::wgpu;
use peelnet::{AdapterRequest, Gpu, LearnedWeight, MethodOptions, Recipe, Renderer, Target};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let gpu = Gpu::open(&AdapterRequest::Auto)?;
    let scene = peelnet::scene::suite::load("cups-held")?;
    let model = peelnet::Model::shipped(Recipe::Medium)?;
    let learned = LearnedWeight {
        recipe: Recipe::Medium,
        wgsl: peelnet::export::wgsl(&model, &Default::default())?,
    };
    let renderer = Renderer::new(&gpu, &scene)?;
    let options = MethodOptions::default().with(Some(&learned));
    let mut method = renderer.method(&"deep-medium".parse()?, options)?;

    // A window's surface texture serves as well.
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let usage = wgpu::TextureUsages::COPY_SRC;
    let view = gpu.texture("my texture", format, [640, 480], 1, usage)?;
    let mut encoder = gpu.encoder();
    let target = Target::cleared(&view);
    renderer.draw(&mut encoder, &mut method, &scene.views[0], &target)?;

    let pixels = gpu.storage("pixels", 640 * 480 * 4)?;
    let mut layout = wgpu::TexelCopyBufferLayout::default();
    (layout.bytes_per_row, layout.rows_per_image) = (Some(640 * 4), None);
    let copy = wgpu::TexelCopyBufferInfo {
        buffer: &pixels,
        layout,
    };
    let texture = view.texture();
    encoder.copy_texture_to_buffer(texture.as_image_copy(), copy, texture.size());
    gpu.queue.submit([encoder.finish()]);

    let bytes: Vec<u8> = gpu.read(&pixels, 0..pixels.size())?;
    let path = std::env::args().nth(1).unwrap_or("cups.png".into());
    image::save_buffer(&path, &bytes, 640, 480, image::ColorType::Rgba8)?;
    println!("{path}: cups-held by deep-medium");
    Ok(())
}
