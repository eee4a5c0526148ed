// avboit, pass 2: eq 6 with the transmittance of the four columns around the pixel, up to one slice in front of the fragment.
import package::helpers::guards::WEIGHT_FLOOR;
import package::helpers::range_of_pixel::place_in_frame;
import package::methods::avboit::grid::{columns, first_slice};
import package::parameters::{CELL, SLICES};
import package::scene::camera::camera;
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var<storage, read> voxels: array<u32>;

// Absorbance of a column up to a depth, in slices from the near end: linear within one.
fn up_to(column: vec2i, depth: f32) -> f32 {
    if depth <= 0.0 {
        return 0.0;
    }
    let last = vec2i(columns(camera.frame_size)) - 1;
    let first = first_slice(vec2u(clamp(column, vec2i(0), last)), camera.frame_size);
    let slice = u32(depth);
    let far = bitcast<f32>(voxels[first + slice]);
    var near = 0.0;
    if slice > 0u {
        near = bitcast<f32>(voxels[first + slice - 1u]);
    }
    return mix(near, far, depth - f32(slice));
}

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec4f {
    if !visible(surface) {
        discard;
    }
    // A slice nearer, so that the slice of the fragment, which holds its own share, does not count.
    let slices = f32(SLICES);
    let depth = min(place_in_frame(surface.depth_linear) * slices, slices - 0.5) - 1.0;
    let place = floor(surface.position.xy) + 0.5;
    let between = place / f32(CELL) - 0.5;
    let column = vec2i(floor(between));
    let t = between - floor(between);
    let above = mix(up_to(column, depth), up_to(column + vec2i(1, 0), depth), t.x);
    let below = mix(up_to(column + vec2i(0, 1), depth), up_to(column + vec2i(1, 1), depth), t.x);
    let weight = clamp(exp(-mix(above, below, t.y)), WEIGHT_FLOOR, 1.0);
    return shade(surface) * weight;
}
