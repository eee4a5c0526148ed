// weighted-average: the average colour with coverage 1 - (1 - mean alpha)^n.
import package::helpers::resolve::normalised;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sums: texture_2d<f32>;
@group(0) @binding(2) var counts: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let sum = textureLoad(sums, pixel, 0);
    let count = textureLoad(counts, pixel, 0).x;
    var transmittance = 1.0;
    if sum.a > 0.0 {
        let through = 1.0 - sum.a / count;
        // pow(0, n) is 0 but some compilers make it exp2(n * log2(0)).
        transmittance = select(0.0, pow(max(through, 1e-30), count), through > 0.0);
    }
    return normalised(sum, transmittance, textureLoad(background, pixel, 0).rgb);
}
