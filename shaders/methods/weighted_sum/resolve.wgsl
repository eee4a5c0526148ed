// weighted-sum: sum C + C_0 (1 - sum alpha). Leaves the gamut where alphas add up to more than 1, as does the coverage:
// reported, not hidden.

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sums: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let sum = textureLoad(sums, pixel, 0);
    let behind = textureLoad(background, pixel, 0).rgb;
    return vec4f(sum.rgb + behind * (1.0 - sum.a), sum.a);
}
