// Where in depth a pixel's layers are, as peelnet_core::methods::quantiles has it.
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_cut, peelnet_even, peelnet_zeta_in};
import package::scene::camera::camera;

// A depth on the scale of the frame without the gaps between boxes, -1 .. 1.
fn zeta_of(depth: f32) -> f32 {
    return peelnet_cut(peelnet_zeta_in(depth, transparent_range()), camera.gaps);
}

// What a small texture of tiles of 8 by 8 pixels says of a place in the frame, linear between tiles.
fn around_of(tiles: texture_2d<f32>, bilinear: sampler, position: vec2f) -> vec4f {
    return textureSampleLevel(tiles, bilinear, position * 0.125 / vec2f(textureDimensions(tiles)), 0.0);
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
