//! `avboit` over several blocks of pixels: what its CPU reference, of a pixel among its like, does not know.

use peelnet_core::absorbance::absorbance;
use peelnet_render::methods::avboit::reference::UNIT;
use peelnet_scene::Material;
use peelnet_tests::{draw, gpu, object, rectangle, scene, wall};

/// Sums of three terms in 32 bits, and exponentials, which llvmpipe has to 1e-6.
const TOLERANCE: f64 = 1e-5;

const BACKGROUND: [f32; 3] = [0.25, 0.5, 0.75];
const NEAR: ([f32; 3], f32) = ([0.9, 0.1, 0.2], 0.3);
const BETWEEN: ([f32; 3], f32) = ([0.1, 0.8, 0.3], 0.6);
const FAR: ([f32; 3], f32) = ([0.2, 0.1, 0.7], 0.5);

/// Of 16 x 16 pixels the block at the upper left has a layer more between the other two. How much of it counts in front of the far one
/// falls linearly from the centre of that block to the centres of those beside it, and is even beyond them.
#[test]
fn blocks_are_linear_between_their_centres() {
    let material = |(color, alpha): ([f32; 3], f32)| Material::unlit(color, alpha);
    let objects = vec![
        wall(1.0, material(NEAR)),
        // In the upper left quarter of the frame.
        object(&rectangle([-2.0, 0.0], [0.0, 2.0], 2.0), material(BETWEEN)),
        wall(4.0, material(FAR)),
    ];
    let scene = scene("three walls", BACKGROUND, objects);
    let image = draw(&gpu(), &scene, "avboit:targets=f32", [16, 16]);
    let b = |(_, alpha): ([f32; 3], f32)| (absorbance(alpha) / UNIT).round() * UNIT;
    // Centres of blocks are at 4 and 12.
    let share = |pixel: usize| 1.0 - ((pixel as f64 + 0.5 - 4.0) / 8.0).clamp(0.0, 1.0);
    for y in 0..16 {
        for x in 0..16 {
            let in_front = b(NEAR) + share(x) * share(y) * b(BETWEEN);
            let mut seen = vec![(NEAR, 1.0), (FAR, (-in_front).exp())];
            if x < 8 && y < 8 {
                seen.push((BETWEEN, (-b(NEAR)).exp()));
            }
            let (mut sums, mut transmittance) = ([0.0f64; 4], 1.0);
            for ((color, alpha), weight) in seen {
                let [r, g, b, alpha] = [color[0], color[1], color[2], alpha].map(f64::from);
                for (sum, c) in sums.iter_mut().zip([r, g, b, 1.0]) {
                    *sum += alpha * weight * c;
                }
                transmittance *= 1.0 - alpha;
            }
            let pixel = image.pixels[y * 16 + x];
            for k in 0..3 {
                let mean = sums[k] / sums[3];
                let want = mean * (1.0 - transmittance) + f64::from(BACKGROUND[k]) * transmittance;
                let error = (f64::from(pixel[k]) - want).abs();
                assert!(error <= TOLERANCE, "({x}, {y}): {pixel:?}, {want} in {k}");
            }
        }
    }
}
