// The view of layers (of a renderer of ageing materials, 2018): the nearest fragment of the highlighted layer takes the share
// HIGHLIGHT_SHARE of the pixel, all in front of it the rest in equal parts, and what lies behind is not seen. `printed` is that
// renderer's formula as it stands in print: all others are seen, and the rest is divided by the number of all fragments.
// Variants: none | increasing | printed | increasing printed
import package::helpers::screen::screen_corner;
import package::parameters::{HIGHLIGHT, HIGHLIGHT_SHARE};
import package::peel::runs::{background, fragments, run_of};

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return screen_corner(index);
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let run = run_of(pixel);
    var others = vec3f(0.0);
    var count = 0.0;
    // Of the highlighted layer, the nearest one.
    var highlighted = vec3f(0.0);
    var found = false;
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
        if !found && fragment.a == HIGHLIGHT {
            highlighted = fragment.rgb;
            found = true;
            @if(printed) {
                continue;
            }
            @else {
                break;
            }
        }
        others += fragment.rgb;
        count += 1.0;
    }
    if !found && count == 0.0 {
        return vec4f(textureLoad(background, pixel, 0).rgb, 0.0);
    }
    @if(printed) {
        let all = count + f32(found);
        return vec4f(HIGHLIGHT_SHARE * highlighted + (1.0 - HIGHLIGHT_SHARE) / all * others, 1.0);
    }
    @else {
        let rest = others / max(count, 1.0);
        let share = select(1.0, HIGHLIGHT_SHARE, count > 0.0);
        return vec4f(mix(rest, highlighted, select(0.0, share, found)), 1.0);
    }
}
