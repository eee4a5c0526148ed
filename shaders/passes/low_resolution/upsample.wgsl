// Transparency drawn at a lower resolution over the full image. What is interpolated is normalised: premultiplied colour and
// coverage, never sums. Where there are opaque surfaces, a sample counts by how near its opaque depth is to the pixel's
// (joint bilateral upsampling, Kopf et al. 2007).
// Loops: 1: 4 texels.
@if(opaque) import package::scene::camera::Camera;

// The full resolution in pixels.
struct Extent {
    size: vec2u,
}

@group(0) @binding(0) var low: texture_2d<f32>;
@group(0) @binding(1) var background: texture_2d<f32>;
@group(0) @binding(2) var<uniform> full: Extent;
@if(opaque) @group(0) @binding(3) var low_depth: texture_depth_2d;
@if(opaque) @group(0) @binding(4) var full_depth: texture_depth_2d;
@if(opaque) @group(0) @binding(5) var<uniform> camera: Camera;

// Relative difference of depth that counts as the same surface. A sample on another surface, one depth further, keeps
// EPSILON squared of its weight.
const EPSILON: f32 = 0.02;

// What a sample keeps whatever its distance, so that one on the right surface counts at all.
const FLOOR: f32 = 0.0009765625;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let size = vec2f(textureDimensions(low));
    let at = position.xy * size / vec2f(full.size) - 0.5;
    let corner = floor(at);
    let part = at - corner;
    let pixel = vec2u(position.xy);
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let step = vec2f(f32(i & 1u), f32(i >> 1u));
        let sample = vec2u(clamp(corner + step, vec2f(0.0), size - 1.0));
        let near = mix(1.0 - part, part, step);
        var weight = near.x * near.y;
        @if(opaque) {
            // Inverse linear depths but for a common factor.
            let ours = camera.window_depth_at_infinity - textureLoad(full_depth, pixel, 0);
            let theirs = camera.window_depth_at_infinity - textureLoad(low_depth, sample, 0);
            let apart = (ours - theirs) / min(ours, theirs);
            weight = (weight + FLOOR) / (EPSILON * EPSILON + apart * apart);
        }
        sum += weight * textureLoad(low, sample, 0);
        weights += weight;
    }
    let color = sum / weights;
    return vec4f(color.rgb + (1.0 - color.a) * textureLoad(background, pixel, 0).rgb, color.a);
}
