//! An exported network in a wgpu program of its own: four layers of glass, drawn in the wrong order and composited right.
//! peelnet contributes nothing but the text of `models/medium/model.wgsl`; the passes are those that the text describes.
//!
//! `cargo run --example own_renderer -- IMAGE.png`

mod plain_wgpu;

use plain_wgpu::{Pass, Program, SIZE, Target};
use std::error::Error;
use wgpu::BlendOperation::{Add, Max};
use wgpu::Color;
use wgpu::TextureFormat::{Rg8Unorm, Rgba8Unorm, Rgba16Float};

/// What maxima of levels start from: the lowest half float.
const LOWEST: Color = Color {
    r: -65504.0,
    g: -65504.0,
    b: -65504.0,
    a: -65504.0,
};

fn main() -> Result<(), Box<dyn Error>> {
    let network = peelnet::models::find("medium").ok_or("no such network")?;
    let mut program = Program::new(&[network.wgsl, include_str!("layers.wgsl")].concat())?;

    let black = Color::TRANSPARENT;
    let target = |format, clear, blend| Target::new(&program.device, format, clear, blend);
    let range = target(Rg8Unorm, black, Some((Max, Max)));
    let absorbances = target(Rgba16Float, black, Some((Add, Add)));
    let lowest = Color { a: 0.0, ..LOWEST };
    let nearest = target(Rgba16Float, lowest, Some((Max, Add)));
    let farthest = target(Rgba16Float, lowest, Some((Max, Add)));
    let sums = target(Rgba16Float, black, Some((Add, Add)));
    let picture = target(Rgba8Unorm, black, None);

    program.draw(&Pass {
        entry_points: ["layer", "range_of_pixel"],
        instances: 4,
        reads: &[],
        targets: &[&range],
    });
    program.draw(&Pass {
        entry_points: ["layer", "statistics"],
        instances: 4,
        reads: &[(0, &range)],
        targets: &[&absorbances, &nearest, &farthest],
    });
    program.draw(&Pass {
        entry_points: ["layer", "weighted"],
        instances: 4,
        reads: &[
            (0, &range),
            (1, &absorbances),
            (2, &nearest),
            (3, &farthest),
        ],
        targets: &[&sums],
    });
    program.draw(&Pass {
        entry_points: ["whole", "resolve"],
        instances: 1,
        reads: &[(1, &absorbances), (4, &sums)],
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
