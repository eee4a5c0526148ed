//! An exported network in a wgpu program of its own: four layers of glass, drawn in the wrong order and composited right.
//! peelnet contributes nothing but the text of `models/medium/model.wgsl`; the passes are those that the text describes, but for the small
//! texture: of a scene whose layers span its range of depth evenly, `peelnet_even()` says as much.
//!
//! `cargo run --example own_renderer -- IMAGE.png`

mod plain_wgpu;

use plain_wgpu::{Program, SIZE, Target};
use std::error::Error;
use wgpu::BlendOperation::{Add, Max};
use wgpu::Color;
use wgpu::TextureFormat::{Rgba8Unorm, Rgba16Float};

fn main() -> Result<(), Box<dyn Error>> {
    let network = peelnet::shipped_networks::find("medium").ok_or("no such network")?;
    let mut program = Program::new(&[network.wgsl, include_str!("layers.wgsl")].concat())?;

    let black = Color::TRANSPARENT;
    let target = |format, clear, blend| Target::new(&program.device, format, clear, blend);
    let absorbances = target(Rgba16Float, black, Some((Add, Add)));
    // What maxima of levels start from: the lowest half float.
    let [r, g, b] = [-65504.0; 3];
    let lowest = Color { r, g, b, a: 0.0 };
    let nearest = target(Rgba16Float, lowest, Some((Max, Add)));
    let farthest = target(Rgba16Float, lowest, Some((Max, Add)));
    let sums = target(Rgba16Float, black, Some((Add, Add)));
    let picture = target(Rgba8Unorm, black, None);

    let statistics = [&absorbances, &nearest, &farthest];
    let known = [(0, &absorbances), (1, &nearest), (2, &farthest)];
    let resolved = [(0, &absorbances), (3, &sums)];
    program.draw(["layer", "statistics"], 4, &[], &statistics);
    program.draw(["layer", "weighted"], 4, &known, &[&sums]);
    program.draw(["whole", "resolve"], 1, &resolved, &[&picture]);
    let pixels = program.finish(&picture)?;

    let path = std::env::args().nth(1);
    let path = path.unwrap_or_else(|| "own_renderer.png".into());
    image::save_buffer(&path, &pixels, SIZE, SIZE, image::ColorType::Rgba8)?;
    let middle = 4 * (SIZE * SIZE / 2 + SIZE / 2) as usize;
    let color = [0, 1, 2].map(|channel| f32::from(pixels[middle + channel]) / 255.0);
    println!("{path}: {color:.4?} in the middle, where it is [0.6125, 0.3625, 0.2375] exactly");
    Ok(())
}
