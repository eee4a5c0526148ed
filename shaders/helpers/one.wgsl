// What a pixel that is drawn in one pass is given; as peelnet_core::methods::one::Tiles::at.

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
