// splat, between passes 1 and 2: the absorbance of the whole pixel, of what is hidden as well.
import package::helpers::guards::HALF_MAX;

@group(0) @binding(0) var bins_a: texture_2d<f32>;
@group(0) @binding(1) var bins_b: texture_2d<f32>;
@group(0) @binding(2) var bins_c: texture_2d<f32>;
@group(0) @binding(3) var bins_d: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let near = textureLoad(bins_a, pixel, 0) + textureLoad(bins_b, pixel, 0);
    let far = textureLoad(bins_c, pixel, 0) + textureLoad(bins_d, pixel, 0);
    return vec4f(min(dot(near + far, vec4f(1.0)), HALF_MAX));
}
