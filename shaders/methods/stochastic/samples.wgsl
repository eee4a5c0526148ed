// Which of its pixel's samples a fragment covers (Enderton et al. 2010); as peelnet_render::methods::stochastic.
import package::helpers::hash::{pcg, pixel_hash};
import package::parameters::SAMPLES;
import package::scene::camera::camera;
import package::scene::surface::Surface;

struct Covered {
    count: u32,
    offset: u32,
    stride: u32,
}

// As many samples as opacity asks for, rounded up or down at random; which, is a random walk through all of them with an odd
// stride, so that each is as likely as any other, whatever samples other fragments cover.
fn covered(surface: Surface, alpha: f32) -> Covered {
    let pixel = vec2u(surface.position.xy);
    let h = pixel_hash(0u, surface.triangle, pixel.x, pixel.y);
    let count = u32(alpha * f32(SAMPLES) + f32(h >> 8u) / 16777216.0);
    let walk = pcg(h);
    return Covered(min(count, SAMPLES), walk, (walk >> 16u) | 1u);
}

// Index of the t-th covered sample.
fn sample(pixel: vec2u, c: Covered, t: u32) -> u32 {
    return (pixel.y * camera.frame_size.x + pixel.x) * SAMPLES + ((c.offset + t * c.stride) & (SAMPLES - 1u));
}
