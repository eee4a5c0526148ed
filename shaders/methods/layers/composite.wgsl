// The view of layers (of a renderer of ageing materials, 2018): the nearest fragment of the highlighted layer takes the share
// HIGHLIGHT_SHARE of the pixel, all in front of it the rest in equal parts, and what lies behind is not seen.
import package::parameters::{HIGHLIGHT, HIGHLIGHT_SHARE};
import package::peel::tile::Tile;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
// Radiance and number of the layer.
@group(0) @binding(2) var<storage, read> fragments: array<vec4f>;
@group(0) @binding(3) var background: texture_2d<f32>;
@group(0) @binding(4) var image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let index = tile.begin + id.y * tile.groups * 64u + id.x;
    if index >= tile.end {
        return;
    }
    let width = textureDimensions(background).x;
    let pixel = vec2u(index % width, index / width);
    var others = vec3f(0.0);
    var count = 0.0;
    @if(increasing) var deepest = -1.0;
    for (var i = offsets[index] - tile.base; i < offsets[index + 1u] - tile.base; i++) {
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
            textureStore(image, pixel, vec4f(mix(rest, fragment.rgb, share), 1.0));
            return;
        }
        others += fragment.rgb;
        count += 1.0;
    }
    let behind = textureLoad(background, pixel, 0).rgb;
    textureStore(image, pixel, select(vec4f(behind, 0.0), vec4f(others / max(count, 1.0), 1.0), count > 0.0));
}
