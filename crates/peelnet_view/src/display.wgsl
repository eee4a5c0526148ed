// What the window shows of one or two pictures: encoded for a display where they are in linear light, compared, or as a map.

struct View {
    // See `Mode` in compare.rs.
    show: u32,
    // Column that divides the pictures, pixels.
    divider: u32,
    // Levels of 255 at which the map ends, or layers.
    scale: f32,
    // Whether pictures hold what a display shows already.
    is_encoded: u32,
}

@group(0) @binding(0) var first: texture_2d<f32>;
@group(0) @binding(1) var second: texture_2d<f32>;
@group(0) @binding(2) var<uniform> view: View;

const SECOND: u32 = 1u;
const SPLIT: u32 = 2u;
const BESIDE: u32 = 3u;
const ERROR: u32 = 4u;
const LAYERS: u32 = 5u;

// The sRGB curve of 0 … 1; what is not a number is black, as in files.
fn encoded(linear: f32) -> f32 {
    if !(linear > 0.0) {
        return 0.0;
    }
    let x = min(linear, 1.0);
    if x <= 0.0031308 {
        return 12.92 * x;
    }
    return 1.055 * pow(x, 1.0 / 2.4) - 0.055;
}

fn shown(color: vec4f) -> vec3f {
    if view.is_encoded == 1u {
        return saturate(color.rgb);
    }
    return vec3f(encoded(color.r), encoded(color.g), encoded(color.b));
}

// Dark blue, violet, red, orange, yellow: lightness grows evenly, so the map reads without hues. Values of the colour map "inferno"
// (Smith and van der Walt 2015) at sixths.
fn heat(share: f32) -> vec3f {
    let x = clamp(share, 0.0, 1.0) * 6.0;
    let k = min(u32(x), 5u);
    var stops = array<vec3f, 7>(
        vec3f(0.001, 0.000, 0.014),
        vec3f(0.156, 0.044, 0.326),
        vec3f(0.397, 0.083, 0.433),
        vec3f(0.626, 0.168, 0.388),
        vec3f(0.830, 0.283, 0.259),
        vec3f(0.962, 0.490, 0.084),
        vec3f(0.988, 0.998, 0.645),
    );
    return mix(stops[k], stops[k + 1u], x - f32(k));
}

@fragment
fn fragment_main(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2u(position.xy);
    var color = vec3f(0.0);
    switch view.show {
        case SECOND: {
            color = shown(textureLoad(second, at, 0));
        }
        case SPLIT: {
            color = shown(textureLoad(first, at, 0));
            if at.x >= view.divider {
                color = shown(textureLoad(second, at, 0));
            }
        }
        case BESIDE: {
            color = shown(textureLoad(first, min(at, textureDimensions(first) - 1u), 0));
            if at.x >= view.divider {
                let there = vec2u(at.x - view.divider, at.y);
                color = shown(textureLoad(second, min(there, textureDimensions(second) - 1u), 0));
            }
        }
        case ERROR: {
            let difference = abs(shown(textureLoad(first, at, 0)) - shown(textureLoad(second, at, 0)));
            color = heat(255.0 * max(difference.r, max(difference.g, difference.b)) / view.scale);
        }
        case LAYERS: {
            color = heat(textureLoad(first, at, 0).a / view.scale);
        }
        default: {
            color = shown(textureLoad(first, at, 0));
        }
    }
    return vec4f(color, 1.0);
}
