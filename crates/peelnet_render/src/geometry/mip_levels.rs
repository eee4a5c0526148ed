use peelnet_core::srgb;
use peelnet_scene::Texture;
use rayon::prelude::*;
use std::{borrow::Cow, sync::LazyLock};

/// Linear light of every byte of sRGB.
static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| srgb::decode(byte as f32 / 255.0)));

/// A size, and the texels of an image of it.
type Level<'a> = ([u32; 2], Cow<'a, [u8]>);

/// Light, times opacity, and opacity.
type Texel = [f32; 4];

/// An image at every size down to one texel. Colours are averaged as light, and count by their opacity: what cannot be seen leaves no
/// fringe. The image itself is neither copied nor converted as a whole: that would take eight times its memory.
pub(crate) fn levels(map: &Texture, srgb: bool) -> Vec<Level<'_>> {
    let mut all = vec![(map.size, Cow::Borrowed(map.texels.as_flattened()))];
    let mut size = map.size;
    let mut image: Vec<Texel> = Vec::new();
    while size != [1, 1] {
        let smaller = size.map(|side| (side / 2).max(1));
        let width = size[0] as usize;
        image = if all.len() == 1 {
            let decode = |t: &[u8; 4]| decode(*t, srgb);
            resized(size, smaller, |y| {
                map.texels[y * width..][..width].iter().map(decode)
            })
        } else {
            resized(size, smaller, |y| {
                image[y * width..][..width].iter().copied()
            })
        };
        size = smaller;
        let mut bytes = vec![0; 4 * image.len()];
        let texels = bytes.as_chunks_mut::<4>().0.par_iter_mut();
        texels
            .zip(&image)
            .for_each(|(bytes, texel)| *bytes = encode(*texel, srgb));
        all.push((size, Cow::Owned(bytes)));
    }
    all
}

fn decode(t: [u8; 4], srgb: bool) -> Texel {
    let alpha = f32::from(t[3]) / 255.0;
    let channel = |byte: u8| {
        if srgb {
            LINEAR[usize::from(byte)] * alpha
        } else {
            f32::from(byte) / 255.0
        }
    };
    [channel(t[0]), channel(t[1]), channel(t[2]), alpha]
}

fn encode(t: Texel, srgb: bool) -> [u8; 4] {
    let byte = |x: f32| (x * 255.0).round().clamp(0.0, 255.0) as u8;
    let channel = |x: f32| {
        if srgb {
            byte(srgb::encode(x / t[3].max(1e-6)))
        } else {
            byte(x)
        }
    };
    [channel(t[0]), channel(t[1]), channel(t[2]), byte(t[3])]
}

/// An image at a smaller size by a triangle filter as wide as two of its new texels, row by row of the new image.
fn resized<Row: Iterator<Item = Texel>>(
    [width, height]: [u32; 2],
    [new_width, new_height]: [u32; 2],
    row: impl Fn(usize) -> Row + Sync,
) -> Vec<Texel> {
    let (across, down) = (taps(width, new_width), taps(height, new_height));
    let mut new = vec![[0.0; 4]; new_width as usize * new_height as usize];
    let rows = new.par_chunks_mut(new_width as usize).zip(&down);
    rows.for_each(|(new, (first, weights))| {
        let mut mixed = vec![[0.0; 4]; width as usize];
        for (y, weight) in (*first..).zip(weights) {
            for (sum, texel) in mixed.iter_mut().zip(row(y)) {
                add(sum, texel, *weight);
            }
        }
        for (sum, (first, weights)) in new.iter_mut().zip(&across) {
            for (texel, weight) in mixed[*first..].iter().zip(weights) {
                add(sum, *texel, *weight);
            }
        }
    });
    new
}

fn add(sum: &mut Texel, texel: Texel, weight: f32) {
    for (sum, x) in sum.iter_mut().zip(texel) {
        *sum += x * weight;
    }
}

/// For every new texel along a side, the first old one and the weights from there on.
fn taps(old: u32, new: u32) -> Vec<(usize, Vec<f32>)> {
    let ratio = old as f32 / new as f32;
    let tap = |k: u32| {
        let middle = (k as f32 + 0.5) * ratio;
        let first = (middle - ratio).floor().max(0.0) as u32;
        let last = ((middle + ratio).ceil() as u32).min(old);
        let weight = |i: u32| (1.0 - ((i as f32 + 0.5 - middle) / ratio).abs()).max(0.0);
        let weights: Vec<f32> = (first..last).map(weight).collect();
        let sum: f32 = weights.iter().sum();
        let weights = weights.iter().map(|w| w / sum).collect();
        (first as usize, weights)
    };
    (0..new).map(tap).collect()
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
        assert_eq!(*all[3].1, [188, 188, 188, 255]);
        assert_eq!(*levels(&checker, false)[3].1, [128, 128, 128, 255]);
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

    /// Odd sides, and sides of one texel: weights add up to 1, and a ramp stays one.
    #[test]
    fn sides_of_any_length() {
        for (old, new) in [(8, 4), (7, 3), (3, 1), (2, 1), (1, 1)] {
            for (first, weights) in taps(old, new) {
                assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
                assert!(first + weights.len() <= old as usize);
            }
        }
        let ramp = Texture::of("ramp", [64, 1], |x, _| [4 * x as u8; 4]);
        let all = levels(&ramp, false);
        let half: Vec<u8> = all[1].1.iter().step_by(4).copied().collect();
        for (x, value) in half.iter().enumerate().skip(1).take(30) {
            assert_eq!(usize::from(*value), 8 * x + 2);
        }
        assert_eq!(all.len(), 7);
    }
}
