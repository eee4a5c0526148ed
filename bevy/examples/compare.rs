//! Draws one scene with Bevy's sorted blending, Bevy's own order-independent transparency and learned weights, switching between them on one
//! camera, and says how far each is from the exact image.
//!
//! `cargo run --example compare -- [--cards N] [--samples 1|4] [--out FOLDER]`
//!
//! Needs no window. The exact image is computed from the cards' planes, by rays in 64 bits.

mod support;

use bevy::{core_pipeline::oit::OrderIndependentTransparencySettings, prelude::*};
use bevy_peelnet::{PeelnetModel, PeelnetPlugin};
use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
};
use support::{cards, exact, headless::Headless};

const SIZE: UVec2 = UVec2::new(640, 480);

fn main() -> Result<(), Box<dyn Error>> {
    let (mut card_count, mut samples, mut out) = (40, 1, PathBuf::from("out/compare"));
    let mut arguments = std::env::args().skip(1);
    while let Some(name) = arguments.next() {
        let value = arguments.next();
        let value = value.ok_or_else(|| format!("{name} needs a value"))?;
        match name.as_str() {
            "--cards" => card_count = value.parse()?,
            "--samples" => samples = value.parse()?,
            "--out" => out = value.into(),
            _ => return Err(format!("{name} is not known: --cards, --samples or --out").into()),
        }
    }
    if ![1, 4].contains(&samples) {
        return Err("--samples takes 1 or 4".into());
    }
    let scene = cards::many(card_count);
    let exact = exact::picture(&scene, SIZE, samples);

    let msaa = Msaa::from_samples(samples);
    let mut headless = Headless::new(SIZE, msaa, PeelnetPlugin::default(), &scene);

    let mut pictures = vec![("exact", exact::bytes_of(&exact))];
    pictures.push(("sorted", headless.picture()));
    // Bevy's own technique has no multisampling.
    if samples == 1 {
        let usual = OrderIndependentTransparencySettings::default();
        let many = OrderIndependentTransparencySettings {
            sorted_fragment_max_count: 32,
            fragments_per_pixel_average: 32.0,
            ..usual
        };
        for (name, settings) in [("linked-lists", usual), ("linked-lists-32", many)] {
            headless.camera().insert(settings);
            pictures.push((name, headless.picture()));
        }
        let mut camera = headless.camera();
        camera.remove::<OrderIndependentTransparencySettings>();
    }
    pictures.push(("medium", headless.learned().picture()));
    // An application has one network.
    for (name, model) in [
        ("small", PeelnetModel::small()),
        ("large", PeelnetModel::large()),
        ("one", PeelnetModel::one()),
    ] {
        let headless = Headless::new(SIZE, msaa, model, &scene);
        pictures.push((name, headless.learned().picture()));
    }

    fs::create_dir_all(&out)?;
    println!(
        "{card_count} cards, {SIZE}, {samples} samples a pixel; errors of 255 against the exact image"
    );
    println!("method           rmse    max  pixels off by more than 2");
    for (name, picture) in &pictures {
        let errors = exact::errors_of(&exact, picture);
        println!(
            "{name:15} {:5.2}  {:5.1}  {:.1} %",
            errors.rmse,
            errors.max,
            100.0 * errors.visible
        );
        save(&out.join(format!("{name}.png")), &[picture])?;
    }
    let all: Vec<&Vec<u8>> = pictures.iter().map(|(_, picture)| picture).collect();
    println!(
        "judged: {:.1} % of the pixels; in the others an edge or a cut passes a sample within 0.02 pixels",
        100.0 * exact::errors_of(&exact, all[0]).judged
    );
    let path = out.join("all.png");
    save(&path, &all)?;
    println!(
        "{}: the pictures in this order, from left to right",
        path.display()
    );
    Ok(())
}

/// Writes pictures in a row.
fn save(path: &Path, pictures: &[&Vec<u8>]) -> Result<(), Box<dyn Error>> {
    let row = 4 * SIZE.x as usize;
    let mut bytes = Vec::new();
    for y in 0..SIZE.y as usize {
        for picture in pictures {
            bytes.extend_from_slice(&picture[y * row..][..row]);
        }
    }
    let width = SIZE.x * pictures.len() as u32;
    image::save_buffer(path, &bytes, width, SIZE.y, image::ColorType::Rgba8)?;
    Ok(())
}
