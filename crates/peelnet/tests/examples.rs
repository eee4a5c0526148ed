//! Runs every program of `examples/` and looks at what it wrote.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use std::path::Path;
use std::process::Command;

/// Runs an example and returns what it printed.
fn example(name: &str, arguments: &[&Path]) -> String {
    // Examples lie beside the folder of tests.
    let tests = std::env::current_exe().unwrap();
    let target = tests.ancestors().nth(2).unwrap();
    let program = target
        .join("examples")
        .join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    assert!(
        program.exists(),
        "{} is missing: cargo build -p peelnet --examples",
        program.display()
    );
    let output = Command::new(&program).args(arguments).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {stderr}");
    String::from_utf8(output.stdout).unwrap()
}

fn pixels(path: &Path) -> image::RgbaImage {
    image::open(path).unwrap().into_rgba8()
}

#[test]
fn a_gltf_file_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("glass.png");
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/glass.gltf");
    let said = example("render_gltf", &[&file, &out]);
    assert!(said.contains("abuffer"), "{said}");
    let image = pixels(&out);
    assert_eq!(image.dimensions(), (640, 480));
    // Panes of three colours cross one another, over a floor.
    let colors: std::collections::HashSet<_> = image.pixels().collect();
    assert!(colors.len() > 10, "{}", colors.len());
}

/// The network's picture in a texture of the program's own is the one that `Renderer::image` gives, within a step of 8 bits and the
/// rounding of the blend.
#[test]
fn a_network_draws_into_a_texture_of_ones_own() {
    use peelnet::{AdapterRequest, Gpu, LearnedWeight, MethodOptions, Recipe, Renderer};
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("cups.png");
    example("own_texture", &[&out]);
    let drawn = image::open(&out).unwrap().into_rgb8();
    let gpu = Gpu::open(&AdapterRequest::Auto).unwrap();
    let scene = peelnet::scene::suite::load("cups-held").unwrap();
    let model = peelnet::Model::shipped(Recipe::MEDIUM).unwrap();
    let learned = LearnedWeight {
        recipe: Recipe::MEDIUM,
        wgsl: peelnet::export::wgsl(&model).unwrap(),
    };
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let options = MethodOptions::sized([640, 480]).with(Some(&learned));
    let mut method = renderer
        .method(&"deep-medium".parse().unwrap(), options)
        .unwrap();
    let frame = renderer.image(&mut method, &scene.views[0]).unwrap();
    let expected = frame.image.to_srgb8();
    assert_eq!(drawn.as_raw().len(), expected.len());
    let apart = drawn
        .as_raw()
        .iter()
        .zip(&expected)
        .map(|(a, b)| a.abs_diff(*b));
    assert!(apart.max().unwrap() <= 2);
}

#[test]
fn rows_become_arrays() {
    let said = example("rows_to_ndarray", &[]);
    assert!(
        said.contains("features [") && said.contains(", 3]"),
        "{said}"
    );
}

#[test]
fn a_network_is_trained_and_exported() {
    let folder = tempfile::tempdir().unwrap();
    let said = example("train_and_export", &[folder.path()]);
    assert!(said.contains("epoch 4"), "{said}");
    let text = std::fs::read_to_string(folder.path().join("model.wgsl")).unwrap();
    assert!(text.contains("fn peelnet_weight"), "{text}");
}

/// The middle of the picture holds the four fragments whose exact colour the README gives.
#[test]
fn an_exported_text_draws_in_a_foreign_program() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("layers.png");
    example("own_renderer", &[&out]);
    let middle = pixels(&out).get_pixel(128, 128).0;
    for (found, exact) in middle.into_iter().zip([0.6125, 0.3625, 0.2375]) {
        let off = f64::from(found) / 255.0 - exact;
        // Four layers in slabs of their own are known. Half a step of the picture, and four roundings of half floats.
        assert!(off.abs() < 0.5 / 255.0 + 4.0 / 2048.0, "{middle:?}");
    }
}
