// avboit, pass 2, of one pixel in 64: absorbance into the two slices around each fragment.
// Variants: tiles
import package::helpers::absorbance::absorbance;
import package::methods::avboit::grid::{UNIT, Used, first_slice, interval_of, place_of, word_of};
import package::scene::camera::camera;
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var<storage, read> used: Used;
@group(1) @binding(1) var<storage, read_write> voxels: array<atomic<u32>>;

@fragment
fn fragment_main(surface: Surface) {
    if !visible(surface) {
        discard;
    }
    let b = absorbance(opacity(surface)) / UNIT;
    let depth = interval_of(surface.depth_linear, used.intervals);
    let word = word_of(depth);
    let place = place_of(depth, used.bits[word], used.before[word]);
    let slice = first_slice(vec2u(surface.position.xy), camera.frame_size) + u32(place);
    let far = u32(b * fract(place) + 0.5);
    atomicAdd(&voxels[slice], u32(b + 0.5) - far);
    atomicAdd(&voxels[slice + 1u], far);
}
