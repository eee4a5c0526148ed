//! `avboit` over several columns of pixels: what its CPU reference, of a pixel among its like, does not know.

use peelnet_core::{absorbance::absorbance, fragment::Fragment, methods::composite};
use peelnet_render::methods::avboit::reference::UNIT;
use peelnet_scene::Material;
use peelnet_tests::{assert_near, draw, gpu, object, rectangle, scene, wall};

/// Sums of three terms in 32 bits, and exponentials, which llvmpipe has to 1e-6.
const TOLERANCE: f32 = 1e-5;

const BACKGROUND: [f32; 3] = [0.25, 0.5, 0.75];

/// Of 16 x 16 pixels the column at the upper left has a layer more between the other two. How much of it is seen in front of the far one
/// falls linearly from the centre of that column to the centres of those beside it, and is even beyond them.
#[test]
fn columns_are_linear_between_their_centres() {
    let near = Fragment::new(1.0, 0.3, [0.9, 0.1, 0.2]);
    let between = Fragment::new(2.0, 0.6, [0.1, 0.8, 0.3]);
    let far = Fragment::new(4.0, 0.5, [0.2, 0.1, 0.7]);
    let material = |f: Fragment| Material::unlit(f.color, f.alpha);
    // In the upper left quarter of the frame.
    let quarter = rectangle([-2.0, 0.0], [0.0, 2.0], between.depth);
    let objects = vec![
        wall(near.depth, material(near)),
        object(&quarter, material(between)),
        wall(far.depth, material(far)),
    ];
    let scene = scene("three walls", BACKGROUND, objects);
    let image = draw(&gpu(), &scene, "avboit:targets=f32", [16, 16]);
    let t = |f: Fragment| (-(absorbance(f.alpha) / UNIT).round() * UNIT).exp();
    // Centres of columns are at 4 and 12.
    let share = |pixel: usize| 1.0 - ((pixel as f64 + 0.5 - 4.0) / 8.0).clamp(0.0, 1.0);
    for y in 0..16 {
        for x in 0..16 {
            let share = share(x) * share(y);
            let in_front = t(near) * (1.0 - share + share * t(between));
            let (mut seen, mut weights) = (vec![near, far], vec![1.0, in_front]);
            if x < 8 && y < 8 {
                seen.push(between);
                weights.push(t(near));
            }
            let want = composite(&seen, BACKGROUND, &weights);
            let pixel = image.pixels[y * 16 + x];
            assert_near(pixel, want, TOLERANCE, format!("({x}, {y})"));
        }
    }
}
