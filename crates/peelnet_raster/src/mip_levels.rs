//! The smaller sizes of textures.

use peelnet_core::srgb;
use peelnet_scene::Texture;
use std::sync::LazyLock;

/// Linear light of every byte of sRGB.
static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| srgb::decode(byte as f32 / 255.0)));

/// An image at every size down to one texel. Colours are averaged as light, and count by their opacity: what cannot be seen leaves no
/// fringe.
pub(crate) fn levels(map: &Texture, srgb: bool) -> Vec<([u32; 2], Vec<u8>)> {
    let mut all = vec![(map.size, map.texels.concat())];
    let decode = |t: &[u8; 4]| {
        let alpha = f32::from(t[3]) / 255.0;
        let channel = |byte: u8| {
            if srgb {
                LINEAR[usize::from(byte)] * alpha
            } else {
                f32::from(byte) / 255.0
            }
        };
        [channel(t[0]), channel(t[1]), channel(t[2]), alpha]
    };
    let encode = |t: [f32; 4]| {
        let byte = |x: f32| (x * 255.0).round().clamp(0.0, 255.0) as u8;
        let channel = |x: f32| {
            if srgb {
                byte(srgb::encode(x / t[3].max(1e-6)))
            } else {
                byte(x)
            }
        };
        [channel(t[0]), channel(t[1]), channel(t[2]), byte(t[3])]
    };
    let [width, height] = map.size;
    let flat: Vec<f32> = map.texels.iter().flat_map(decode).collect();
    let Some(mut image) = image::Rgba32FImage::from_raw(width, height, flat) else {
        return all;
    };
    while image.width() > 1 || image.height() > 1 {
        let size = [(image.width() / 2).max(1), (image.height() / 2).max(1)];
        let filter = image::imageops::FilterType::Triangle;
        image = image::imageops::resize(&image, size[0], size[1], filter);
        let bytes = image.pixels().flat_map(|p| encode(p.0)).collect();
        all.push((size, bytes));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels go down to one texel, and light keeps its mean: half black and half white is 0.5 of white, byte 188. An image of one
    /// visible and one invisible colour keeps the visible one.
    #[test]
    fn levels_keep_light() {
        let checker = Texture::of("checker", [8, 4], |x, y| {
            let c = if (x + y) % 2 == 0 { 255 } else { 0 };
            [c, c, c, 255]
        });
        let all = levels(&checker, true);
        let sizes: Vec<_> = all.iter().map(|(size, _)| *size).collect();
        assert_eq!(sizes, [[8, 4], [4, 2], [2, 1], [1, 1]]);
        assert_eq!(all[3].1, [188, 188, 188, 255]);
        assert_eq!(levels(&checker, false)[3].1, [128, 128, 128, 255]);
        let leaf = Texture::of("leaf", [4, 4], |x, _| {
            if x % 2 == 0 {
                [0, 200, 0, 255]
            } else {
                [255, 0, 0, 0]
            }
        });
        let [r, g, b, a] = levels(&leaf, true)[2].1[..] else {
            panic!("one texel");
        };
        assert_eq!((r, g, b, a), (0, 200, 0, 128));
    }
}
