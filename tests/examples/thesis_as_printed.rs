//! The thesis's weighted blending as its shader is printed, and against its reference as printed, beside eq 6 and the exact image:
//! `cargo run --release -p peelnet_tests --example thesis_as_printed -- [--model MODEL] SCENE...`
//!
//! Scenes are shipped ones or files. Prints a table of mean squared errors (0–255, display-referred, whole frame, mean over the views).

use peelnet_eval::metrics::differences;
use peelnet_model::{Model, Recipe};
use peelnet_render::{Image, LearnedWeight, MethodOptions, MethodSpec, Renderer};
use peelnet_scene::{Scene, suite};
use std::{env, error::Error, path::Path};

/// The thesis's frames are larger; ratios hardly depend on the size.
const SIZE: [u32; 2] = [512, 384];

/// Dual peeling in four passes, colours in half floats.
const REFERENCES: [&str; 2] = ["abuffer", "dual-peel:passes=4,colors=f16"];

const METHODS: [&str; 5] = [
    "wboit-papakostas",
    "wboit-papakostas:composite=printed",
    "deep-thesis",
    "deep-thesis:composite=printed",
    "wboit-eq8",
];

fn main() -> Result<(), Box<dyn Error>> {
    let mut scenes: Vec<Scene> = Vec::new();
    let mut model = None;
    let mut args = env::args().skip(1);
    while let Some(arg) = args.next() {
        if arg == "--model" {
            model = Some(Model::load(args.next().ok_or("--model needs a file")?)?);
        } else {
            scenes.push(suite::open(Path::new(&arg), None)?);
        }
    }
    let model = model.map_or_else(|| Model::shipped(Recipe::THESIS), Ok)?;
    let learned = LearnedWeight {
        recipe: model.meta.recipe,
        wgsl: peelnet_export::wgsl(&model)?,
    };
    let gpu = peelnet_tests::gpu();
    print!("| scene | reference |");
    METHODS.iter().for_each(|m| print!(" {m} |"));
    println!(
        " the reference itself |\n|---|---|{}---:|",
        "---:|".repeat(METHODS.len())
    );
    for scene in &scenes {
        let renderer = Renderer::new(&gpu, scene)?;
        let draw = |method: &str| -> Result<Vec<Image>, Box<dyn Error>> {
            let spec: MethodSpec = method.parse()?;
            let learned = spec.method().learned.then_some(&learned);
            let options = MethodOptions::sized(SIZE).with(learned);
            let mut prepared = renderer.method(&spec, options)?;
            let views = scene.views.iter();
            let images = views.map(|view| Ok(renderer.image(&mut prepared, view)?.image));
            images.collect()
        };
        let exact = draw(REFERENCES[0])?;
        let error = |reference: &[Image], images: &[Image]| -> Result<f64, Box<dyn Error>> {
            let mut sum = 0.0;
            for (reference, image) in reference.iter().zip(images) {
                sum += differences(&reference.pixels, &image.pixels).mse255;
            }
            Ok(sum / reference.len() as f64)
        };
        let drawn: Vec<Vec<Image>> = METHODS.iter().map(|m| draw(m)).collect::<Result<_, _>>()?;
        for name in REFERENCES {
            let reference = draw(name)?;
            print!("| {} | {name} |", scene.name);
            for images in &drawn {
                print!(" {:.2} |", error(&reference, images)?);
            }
            println!(" {:.2} |", error(&exact, &reference)?);
        }
    }
    Ok(())
}
