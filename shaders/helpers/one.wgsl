// What a pixel that is drawn in one pass is told; as peelnet_core::methods::one::Tiles::at.
// The tiles of 8 by 8 pixels whose middles a pixel lies between, by number, and where between them it lies.
struct Corners {
    above: vec2u,
    below: vec2u,
    part: vec2f,
}

// size: of the frame.
fn corners_of(pixel: vec2u, size: vec2u) -> Corners {
    let count = (size + 7u) / 8u;
    let last = vec2i(count) - 1;
    let place = (vec2f(pixel) + 0.5) * 0.125 - 0.5;
    let low = vec2i(floor(place));
    let a = vec2u(clamp(low, vec2i(0), last));
    let b = vec2u(clamp(low + 1, vec2i(0), last));
    return Corners(a.y * count.x + vec2u(a.x, b.x), b.y * count.x + vec2u(a.x, b.x), place - floor(place));
}

// Quantiles as they are stored, and back.
fn stored(q: vec4f) -> u32 {
    return pack4x8unorm(q);
}

fn quantiles_of(texel: u32) -> vec4f {
    return unpack4x8unorm(texel);
}
