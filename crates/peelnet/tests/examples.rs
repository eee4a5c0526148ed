//! Runs every program of `examples/` and looks at what it wrote.

use crate::common::Folder;
use std::process::Command;

fn example(folder: &Folder, name: &str, arguments: &[&str]) -> String {
    // Examples lie beside the folder of tests.
    let tests = std::env::current_exe().unwrap();
    let examples = tests.ancestors().nth(2).unwrap().join("examples");
    let program = examples.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    let hint = "is missing: cargo build -p peelnet --examples";
    assert!(program.exists(), "{} {hint}", program.display());
    let mut command = Command::new(&program);
    let output = command.args(arguments).current_dir(folder.path()).output();
    let output = output.unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {stderr}");
    String::from_utf8(output.stdout).unwrap()
}

fn pixels(folder: &Folder, name: &str) -> image::RgbaImage {
    image::open(folder.at(name)).unwrap().into_rgba8()
}

#[test]
fn a_gltf_file_is_drawn() {
    let folder = Folder::new(&[]);
    let said = example(&folder, "render_gltf", &[]);
    assert!(said.contains("abuffer"), "{said}");
    let image = pixels(&folder, "glass.png");
    assert_eq!(image.dimensions(), (640, 480));
    // Panes of three colours cross one another, over a floor.
    let colors: std::collections::HashSet<_> = image.pixels().collect();
    assert!(colors.len() > 10, "{}", colors.len());
}

/// The network's picture in a texture of the program's own is the one that `render` gives, within a step of 8 bits and the rounding of
/// the blend.
#[test]
fn a_network_draws_into_a_texture_of_ones_own() {
    let folder = Folder::new(&[]);
    example(&folder, "own_texture", &[]);
    folder.prints("render cups-held --method deep-medium --size 640x480 --out want.png");
    let [drawn, want] = ["cups.png", "want.png"].map(|name| pixels(&folder, name).into_raw());
    assert_eq!(drawn.len(), want.len());
    let apart = drawn.iter().zip(&want).map(|(a, b)| a.abs_diff(*b));
    assert!(apart.max().unwrap() <= 2);
}

#[test]
fn rows_become_arrays() {
    let said = example(&Folder::new(&[]), "rows_to_ndarray", &[]);
    let says = said.contains("features [") && said.contains(", 3]");
    assert!(says, "{said}");
}

#[test]
fn a_network_is_trained_and_exported() {
    let folder = Folder::new(&[]);
    let said = example(&folder, "train_and_export", &["."]);
    assert!(said.contains("epoch 4"), "{said}");
    let text = String::from_utf8(folder.read("model.wgsl")).unwrap();
    assert!(text.contains("fn peelnet_weight"), "{text}");
}

/// The middle of the picture holds the four fragments whose exact colour the README gives.
#[test]
fn an_exported_text_draws_in_a_foreign_program() {
    let folder = Folder::new(&[]);
    example(&folder, "own_renderer", &[]);
    let middle = pixels(&folder, "own_renderer.png").get_pixel(128, 128).0;
    for (found, exact) in middle.into_iter().zip([0.6125, 0.3625, 0.2375]) {
        let off = f64::from(found) / 255.0 - exact;
        // Four layers in slabs of their own are known. Half a step of the picture, and four roundings of half floats.
        assert!(off.abs() < 0.5 / 255.0 + 4.0 / 2048.0, "{middle:?}");
    }
}
