// S-buffer: composites each sorted run front to back over C_0 (under-blending).
import package::peel::tile::Tile;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> colors: array<vec4f>;
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
    var color = vec3f(0.0);
    @if(!tinted) var transmittance = 1.0;
    @if(tinted) var transmittance = vec3f(1.0);
    for (var i = offsets[index] - tile.base; i < offsets[index + 1u] - tile.base; i++) {
        @if(!tinted) {
            let fragment = colors[i];
            color += transmittance * fragment.rgb;
            transmittance *= 1.0 - fragment.a;
        }
        @if(tinted) {
            color += transmittance * colors[2u * i].rgb;
            transmittance *= 1.0 - colors[2u * i + 1u].rgb;
        }
    }
    let behind = textureLoad(background, pixel, 0).rgb;
    @if(!tinted) let covered = 1.0 - transmittance;
    @if(tinted) let covered = 1.0 - dot(transmittance, vec3f(1.0 / 3.0));
    textureStore(image, pixel, vec4f(color + transmittance * behind, covered));
}
