// Where in depth a pixel's layers are, as peelnet_core::methods::quantiles has it.
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_cut, peelnet_even, peelnet_zeta_in};
import package::scene::camera::camera;

// A depth on the scale of the frame without the gaps between boxes, -1 .. 1.
fn zeta_of(depth: f32) -> f32 {
    return peelnet_cut(peelnet_zeta_in(depth, transparent_range()), camera.gaps);
}

// The four tiles of 8 by 8 pixels whose middles a pixel lies between, by number, in rows, and how far it lies from the first.
struct Tiles {
    numbers: vec4u,
    part: vec2f,
}

// size: of the frame.
fn tiles_around(pixel: vec2u, size: vec2u) -> Tiles {
    let count = (size + 7u) / 8u;
    let last = vec2i(count) - 1;
    let place = (vec2f(pixel) + 0.5) * 0.125 - 0.5;
    let low = vec2i(floor(place));
    let a = vec2u(clamp(low, vec2i(0), last));
    let b = vec2u(clamp(low + 1, vec2i(0), last));
    return Tiles(vec2u(a.y, b.y).xxyy * count.x + vec4u(a.x, b.x, a.x, b.x), place - floor(place));
}

// What four texels hold, of 8 bits a number, linear between them.
fn between(texels: vec4u, part: vec2f) -> vec4f {
    let above = mix(unpack4x8unorm(texels.x), unpack4x8unorm(texels.y), part.x);
    let below = mix(unpack4x8unorm(texels.z), unpack4x8unorm(texels.w), part.x);
    return mix(above, below, part.y);
}

// The ends of a pixel that a depth alone would have, in 8 bits: its level counted from the far end, rounded down from the near one, and its level,
// rounded up. Of each the most is kept.
fn range_of(zeta: f32) -> vec2f {
    let level = 127.5 * (zeta + 1.0);
    return vec2f(255.0 - floor(level), ceil(level)) / 255.0;
}

// Quantiles that are even between the ends of a pixel, at least a level apart.
fn in_range(range: vec2f) -> vec4f {
    let levels = floor(range * 255.0 + 0.5);
    let nearest = 255.0 - levels.x;
    let extent = max(levels.y - nearest, 1.0);
    return (vec4f(nearest) + peelnet_even() * extent) / 255.0;
}
