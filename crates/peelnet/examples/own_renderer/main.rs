//! An exported network in a wgpu program of its own: four layers of glass, drawn in the wrong order and composited right.
//! peelnet contributes nothing but the text of `models/medium/model.wgsl`; the passes are those that the text describes.
//!
//! `cargo run --example own_renderer -- IMAGE.png`

mod plain_wgpu;

use plain_wgpu::{Pass, Program, SIZE, Target};
use std::error::Error;
use wgpu::BlendOperation::{Add, Max};
use wgpu::Color;
use wgpu::TextureFormat::{Rgba8Unorm, Rgba16Float};

/// What a maximum starts from: the lowest half float.
const LOWEST: Color = Color {
    r: -65504.0,
    g: -65504.0,
    b: -65504.0,
    a: 0.0,
};

fn main() -> Result<(), Box<dyn Error>> {
    let network = peelnet::models::find("medium").ok_or("no such network")?;
    let mut program = Program::new(&[network.wgsl, include_str!("layers.wgsl")].concat())?;

    let black = Color::TRANSPARENT;
    let target = |clear, blend| Target::new(&program.device, Rgba16Float, clear, blend);
    let moments = target(black, Some((Add, Add)));
    let extent = target(LOWEST, Some((Max, Add)));
    let sums = target(black, Some((Add, Add)));
    let ends = target(black, Some((Add, Add)));
    let picture = Target::new(&program.device, Rgba8Unorm, black, None);

    program.draw(&Pass {
        entry_points: ["layer", "statistics"],
        instances: 4,
        reads: &[],
        targets: &[&moments, &extent],
    });
    program.draw(&Pass {
        entry_points: ["layer", "weighted"],
        instances: 4,
        reads: &[(0, &moments), (1, &extent)],
        targets: &[&sums, &ends],
    });
    program.draw(&Pass {
        entry_points: ["whole", "resolve"],
        instances: 1,
        reads: &[(0, &moments), (2, &sums), (3, &ends)],
        targets: &[&picture],
    });
    let pixels = program.finish(&picture)?;

    let path = std::env::args().nth(1);
    let path = path.unwrap_or_else(|| "own_renderer.png".into());
    image::save_buffer(&path, &pixels, SIZE, SIZE, image::ColorType::Rgba8)?;
    let middle = 4 * (SIZE * SIZE / 2 + SIZE / 2) as usize;
    let color: Vec<f32> = pixels[middle..middle + 3]
        .iter()
        .map(|&v| f32::from(v) / 255.0)
        .collect();
    println!("{path}: {color:.4?} in the middle, where it is [0.6125, 0.3625, 0.2375] exactly");
    Ok(())
}
