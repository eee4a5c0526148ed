//! A few small pictures, by which people see what a change did: drawn again and compared. `PEELNET_UPDATE=1` makes them again, which a change
//! of what is drawn on purpose needs; look at them before they are committed.

use peelnet_render::Image;
use peelnet_scene::suite;
use peelnet_tests::{draw, gpu};
use std::{env, fs, path::Path};

/// Scene and method of each, the file's name.
const PICTURES: [(&str, &str); 6] = [
    ("still-life", "abuffer"),
    ("panes", "dual-peel"),
    ("sixteen-050", "wboit-eq9"),
    ("smoke-held", "mboit4"),
    ("foliage-held", "deep-medium"),
    ("mist", "avboit"),
];

const SIZE: [u32; 2] = [96, 72];

/// A channel's difference that nobody sees, of 255: two roundings to bytes, and as much for how an adapter filters textures and adds half floats.
const STEPS: u8 = 4;

/// The fraction of pixels that may differ by more: those at silhouettes, where adapters snap vertices to other sub-pixels.
const SILHOUETTES: f64 = 0.02;

fn picture(image: &Image) -> image::RgbImage {
    image::RgbImage::from_raw(image.width, image.height, image.to_srgb8()).unwrap()
}

/// The fraction of the pixels, of three bytes each, of which a channel is off by more than so many steps.
fn fraction_off(a: &[u8], b: &[u8], steps: u8) -> f64 {
    let pixels = a.chunks(3).zip(b.chunks(3));
    let off = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > steps));
    off.count() as f64 / (a.len() / 3) as f64
}

#[test]
fn pictures_are_the_committed_ones() {
    let gpu = gpu();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut problems = Vec::new();
    for (scene, method) in PICTURES {
        let name = format!("{scene}-{method}");
        let file = root.join("pictures").join(format!("{name}.png"));
        let found = picture(&draw(&gpu, &suite::load(scene).unwrap(), method, SIZE));
        if env::var_os("PEELNET_UPDATE").is_some() {
            found.save(&file).unwrap();
            continue;
        }
        let want = image::open(&file).unwrap().to_rgb8();
        assert_eq!(found.dimensions(), want.dimensions(), "{name}");
        let differences = image::RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
            let (a, b) = (found.get_pixel(x, y).0, want.get_pixel(x, y).0);
            image::Rgb([0, 1, 2].map(|k| a[k].abs_diff(b[k])))
        });
        let fraction = fraction_off(&found, &want, STEPS);
        if fraction > SILHOUETTES {
            let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pictures");
            fs::create_dir_all(&folder).unwrap();
            let [actual, difference] =
                ["actual", "difference"].map(|what| folder.join(format!("{name}-{what}.png")));
            found.save(&actual).unwrap();
            differences.save(&difference).unwrap();
            problems.push(format!(
                "{name}: {:.1} % of the pixels differ from {file:?}: see {actual:?} and {difference:?}",
                100.0 * fraction
            ));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// The fraction of pixels of lines and labels over translucent areas that may differ from the exact image by more than two steps of a display:
/// what users of a globe would call right (Cesium's issues 4170 and 13722).
const LINES_OFF: f64 = 0.001;

/// The exact method, the one that is judged, and what it is compared with.
const LINES_METHODS: [&str; 6] = [
    "abuffer",
    "deep-small",
    "deep-medium",
    "deep-large",
    "mboit4",
    "wboit-eq9",
];

#[test]
fn lines_of_alpha_one_cover_translucent_areas() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/lines.toml");
    let scene = peelnet_scene::Scene::load(&file).unwrap();
    let gpu = gpu();
    let [exact, others @ ..] = LINES_METHODS.map(|m| draw(&gpu, &scene, m, [512, 384]).to_srgb8());
    let off = others.map(|image| fraction_off(&image, &exact, 2));
    for (method, off) in LINES_METHODS[1..].iter().zip(off) {
        println!("{method}: {:.3} % of the pixels", 100.0 * off);
    }
    let [learned, .., of_weights] = off;
    assert!(learned <= LINES_OFF, "{:.3} %", 100.0 * learned);
    // Else the scene shows nothing.
    assert!(of_weights > 20.0 * LINES_OFF, "{:.3} %", 100.0 * of_weights);
}
