// avboit, pass 1: absorbance into the voxels of the grid, and the transmittance of the whole pixel.
import package::helpers::absorbance::absorbance;
import package::helpers::range_of_pixel::place_in_frame;
import package::methods::avboit::grid::{UNIT, first_slice};
import package::parameters::{CELL, SLICES};
import package::scene::camera::camera;
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var<storage, read_write> voxels: array<atomic<u32>>;

@fragment
fn fragment_main(surface: Surface) -> @location(0) f32 {
    if !visible(surface) {
        discard;
    }
    let alpha = opacity(surface);
    let column = vec2u(surface.position.xy) / CELL;
    let slice = min(u32(place_in_frame(surface.depth_linear) * f32(SLICES)), SLICES - 1u);
    atomicAdd(&voxels[first_slice(column, camera.frame_size) + slice], u32(absorbance(alpha) / UNIT + 0.5));
    return alpha;
}
