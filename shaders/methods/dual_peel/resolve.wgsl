// Dual depth peeling: fronts over backs over C_0.

@group(0) @binding(0) var background: texture_2d<f32>;
// rgb: colour, a: transmittance, of the layers peeled from the front and from the back.
@group(0) @binding(1) var fronts: texture_2d<f32>;
@group(0) @binding(2) var backs: texture_2d<f32>;

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let front = textureLoad(fronts, pixel, 0);
    let back = textureLoad(backs, pixel, 0);
    let behind = back.rgb + back.a * textureLoad(background, pixel, 0).rgb;
    return vec4f(front.rgb + front.a * behind, 1.0 - front.a * back.a);
}
