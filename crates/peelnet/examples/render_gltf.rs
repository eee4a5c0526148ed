//! Draws a glTF file off screen and saves the picture.
//!
//! `cargo run --example render_gltf -- SCENE.gltf IMAGE.png METHOD`; by default three panes of glass, exactly.

use peelnet::{AdapterRequest, Gpu, MethodOptions, MethodSpec, Renderer, Scene};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let glass = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/glass.gltf");
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().unwrap_or_else(|| glass.into());
    let image = arguments.next().unwrap_or_else(|| "glass.png".into());
    let method: MethodSpec = arguments.next().as_deref().unwrap_or("abuffer").parse()?;

    let scene = Scene::load(&file)?;
    for warning in &scene.warnings {
        eprintln!("warning: {warning}");
    }
    let gpu = Gpu::open(&AdapterRequest::Auto)?;
    let renderer = Renderer::new(&gpu, &scene)?;
    let mut prepared = renderer.method(&method, MethodOptions::sized([640, 480]))?;
    let frame = renderer.image(&mut prepared, &scene.views[0])?;
    frame.image.save(image.as_ref())?;
    let layers = frame.stats.max_layers;
    println!("{image}: {method}, up to {layers:?} layers");
    Ok(())
}
