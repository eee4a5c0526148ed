
// What follows the exported text: four layers, and the passes that the text describes.

// Colour and opacity; distance to the camera. Drawn in this order, which is neither front to back nor back to front.
const COLORS = array(vec4f(0.0, 0.0, 1.0, 0.5), vec4f(1.0, 1.0, 1.0, 0.9), vec4f(1.0, 0.0, 0.0, 0.5), vec4f(0.0, 1.0, 0.0, 0.5));
const DEPTHS = array(4.0, 8.0, 1.0, 2.0);
const LOWEST = array(vec2f(-0.6, -0.6), vec2f(-1.0, -1.0), vec2f(-0.2, -0.9), vec2f(-0.9, -0.2));

struct Varyings {
    @builtin(position) position: vec4f,
    @location(0) color: vec4f,
    @location(1) depth: f32,
}

@vertex
fn layer(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Varyings {
    var colors = COLORS;
    var depths = DEPTHS;
    var lowest = LOWEST;
    let corner = vec2f(f32(vertex & 1u), f32(vertex >> 1u));
    return Varyings(vec4f(mix(lowest[instance], -lowest[instance], corner), 0.5, 1.0), colors[instance], depths[instance]);
}

@vertex
fn whole(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32(vertex & 1u), f32(vertex >> 1u)) * 2.0 - 1.0, 0.5, 1.0);
}

@group(0) @binding(0) var absorbances: texture_2d<f32>;
@group(0) @binding(1) var nearest: texture_2d<f32>;
@group(0) @binding(2) var farthest: texture_2d<f32>;
@group(0) @binding(3) var sums: texture_2d<f32>;

// In the range of depth that the layers span.
fn zeta(depth: f32) -> f32 {
    return peelnet_zeta(depth, 1.0, 8.0);
}

struct Statistics {
    @location(0) absorbances: vec4f,
    @location(1) nearest: vec4f,
    @location(2) farthest: vec4f,
}

@fragment
fn statistics(in: Varyings) -> Statistics {
    let s = peelnet_statistics(in.color.a, zeta(in.depth), peelnet_even());
    return Statistics(s.absorbances, s.nearest, s.farthest);
}

@fragment
fn weighted(in: Varyings) -> @location(0) vec4f {
    let at = vec2u(in.position.xy);
    let w = peelnet_fragment(
        in.color.a,
        zeta(in.depth),
        peelnet_even(),
        textureLoad(absorbances, at, 0),
        textureLoad(nearest, at, 0),
        textureLoad(farthest, at, 0),
    ).x;
    return vec4f(in.color.rgb, 1.0) * in.color.a * w;
}

@fragment
fn resolve(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2u(position.xy);
    let absorbance = dot(textureLoad(absorbances, at, 0).xyz, vec3f(1.0));
    let color = peelnet_resolve(textureLoad(sums, at, 0), absorbance, vec3f(0.0));
    // The background is opaque.
    return vec4f(color.rgb, 1.0);
}
