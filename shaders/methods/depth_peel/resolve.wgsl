// Depth peeling: what is left of C_0 behind all layers.

@group(0) @binding(0) var background: texture_2d<f32>;
// rgb: colour of all layers, a: transmittance of all layers.
@group(0) @binding(1) var layers: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let all = textureLoad(layers, pixel, 0);
    return vec4f(all.rgb + all.a * textureLoad(background, pixel, 0).rgb, 1.0 - all.a);
}
