// S-buffer: composites each sorted run front to back over C_0 (under-blending).
// Variants: none | tinted
import package::peel::runs::{background, fragments, image, run_of};

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let run = run_of(id);
    if !run.inside {
        return;
    }
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
    let behind = textureLoad(background, run.pixel, 0).rgb;
    @if(!tinted) let covered = 1.0 - transmittance;
    @if(tinted) let covered = 1.0 - dot(transmittance, vec3f(1.0 / 3.0));
    textureStore(image, run.pixel, vec4f(color + transmittance * behind, covered));
}
