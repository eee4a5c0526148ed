// S-buffer: composites each sorted run front to back over C_0 (under-blending).
// Variants: none | tinted
import package::helpers::screen::screen_corner;
import package::peel::runs::{background, fragments, run_of};

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return screen_corner(index);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let run = run_of(pixel);
    var color = vec3f(0.0);
    @if(!tinted) var transmittance = 1.0;
    @if(tinted) var transmittance = vec3f(1.0);
    for (var i = run.begin; i < run.end; i++) {
        @if(!tinted) {
            let fragment = fragments[i];
            color += transmittance * fragment.rgb;
            transmittance *= 1.0 - fragment.a;
        }
        @if(tinted) {
            color += transmittance * fragments[2u * i].rgb;
            transmittance *= 1.0 - fragments[2u * i + 1u].rgb;
        }
    }
    let behind = textureLoad(background, pixel, 0).rgb;
    @if(!tinted) let covered = 1.0 - transmittance;
    @if(tinted) let covered = 1.0 - dot(transmittance, vec3f(1.0 / 3.0));
    return vec4f(color + transmittance * behind, covered);
}
