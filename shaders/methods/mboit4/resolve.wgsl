// mboit4: eq 6's resolve; the transmittance of the whole pixel is exp(-total absorbance).
import package::helpers::resolve::normalised;
import package::helpers::screen::screen_corner;

@group(0) @binding(0) var background: texture_2d<f32>;
@group(0) @binding(1) var sums: texture_2d<f32>;
@group(0) @binding(2) var zeroth: texture_2d<f32>;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return screen_corner(index);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    return normalised(
        textureLoad(sums, pixel, 0),
        exp(-textureLoad(zeroth, pixel, 0).x),
        textureLoad(background, pixel, 0).rgb,
    );
}
