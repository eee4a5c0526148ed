// avboit, pass 3, the only one at full resolution: eq 6 with the transmittance of the four columns around the pixel, up to two intervals in
// front of the fragment, so that it does not hide itself.
// Variants: none | packed | tinted
import package::helpers::guards::WEIGHT_FLOOR;
import package::helpers::sums::{Sums, sums_of};
import package::methods::avboit::grid::{Used, columns, first_slice, interval_of, place_of, word_of};
import package::scene::camera::camera;
import package::scene::shade::shade;
@if(tinted) import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var<storage, read> used: Used;
@group(1) @binding(1) var<storage, read> voxels: array<u32>;

// The transmittance of a column at a place in slices.
fn column_at(column: vec2i, place: f32) -> f32 {
    let last = vec2i(columns(camera.frame_size)) - 1;
    let slice = first_slice(vec2u(clamp(column, vec2i(0), last)), camera.frame_size) + u32(place);
    return mix(bitcast<f32>(voxels[slice]), bitcast<f32>(voxels[slice + 1u]), fract(place));
}

fn transmittance_at(position: vec2f, place: f32) -> f32 {
    if place < 0.0 {
        return 1.0;
    }
    let between = position * 0.125 - 0.5;
    let column = vec2i(floor(between));
    let t = between - floor(between);
    let above = mix(column_at(column, place), column_at(column + vec2i(1, 0), place), t.x);
    let below = mix(column_at(column + vec2i(0, 1), place), column_at(column + vec2i(1, 1), place), t.x);
    return mix(above, below, t.y);
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let color = shade(surface);
    let depth = interval_of(surface.depth_linear, used.intervals) - 2.0;
    let word = word_of(depth);
    let place = place_of(depth, used.bits[word], used.before[word]);
    let weighted = color * max(transmittance_at(surface.position.xy, place), WEIGHT_FLOOR);
    @if(tinted) return sums_of(weighted, covering(surface));
    @if(!tinted) return sums_of(weighted, vec3f(color.a));
}
