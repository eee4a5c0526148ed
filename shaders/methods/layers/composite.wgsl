// The view of layers (of a renderer of ageing materials, 2018): the nearest fragment of the highlighted layer takes the share
// HIGHLIGHT_SHARE of the pixel, all in front of it the rest in equal parts, and what lies behind is not seen.
// Variants: none | increasing
import package::parameters::{HIGHLIGHT, HIGHLIGHT_SHARE};
import package::peel::runs::{background, fragments, image, run_of};

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let run = run_of(id);
    if !run.inside {
        return;
    }
    var others = vec3f(0.0);
    var count = 0.0;
    @if(increasing) var deepest = -1.0;
    for (var i = run.begin; i < run.end; i++) {
        // Radiance and number of the layer.
        let fragment = fragments[i];
        // Inwards only: the object's own far side is no further layer.
        @if(increasing) {
            if fragment.a <= deepest {
                continue;
            }
            deepest = fragment.a;
        }
        if fragment.a == HIGHLIGHT {
            let rest = others / max(count, 1.0);
            let share = select(1.0, HIGHLIGHT_SHARE, count > 0.0);
            textureStore(image, run.pixel, vec4f(mix(rest, fragment.rgb, share), 1.0));
            return;
        }
        others += fragment.rgb;
        count += 1.0;
    }
    let behind = textureLoad(background, run.pixel, 0).rgb;
    let seen = select(vec4f(behind, 0.0), vec4f(others / max(count, 1.0), 1.0), count > 0.0);
    textureStore(image, run.pixel, seen);
}
