// Whether a transparent fragment counts at all.
import package::scene::camera::camera;
@if(cutout || splat) import package::scene::shade::is_hole;
@if(mapped) import package::scene::maps::remember_footprint;
import package::helpers::hash::pixel_hash;
import package::scene::surface::Surface;

@if(opaque && !multisampled) @group(0) @binding(3) var opaque_depth: texture_depth_2d;
// Of several samples the first one counts.
@if(opaque && multisampled) @group(0) @binding(3) var opaque_depth: texture_depth_multisampled_2d;

// False in holes, behind opaque geometry, and outside of the pixel sample where one is taken.
//
// The opaque depth is compared here and not by the fixed-function test, because storage writes of a fragment
// shader happen before that test.
fn visible(surface: Surface) -> bool {
    @if(mapped) remember_footprint(surface.uv);
    // Of a pass over one pixel of 64, the middle one of those.
    @if(tiles) let pixel = vec2u(surface.position.xy * 8.0);
    @else let pixel = vec2u(surface.position.xy);
    @if(sampled) {
        if pixel_hash(camera.sample_seed, camera.sample_view, pixel.x, pixel.y) > camera.sample_threshold {
            return false;
        }
    }
    @if(opaque) {
        if surface.position.z >= textureLoad(opaque_depth, pixel, 0) {
            return false;
        }
    }
    @if(cutout || splat) {
        if is_hole(surface) {
            return false;
        }
    }
    return true;
}
