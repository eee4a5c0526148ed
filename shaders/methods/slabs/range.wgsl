// slabs, pass 1: the levels of the pixel's nearest and farthest depth, by MAX blending of 8 bits.
import package::helpers::absorbance::warped_depth;
import package::methods::slabs::slab::range_of;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec2f {
    if !visible(surface) {
        discard;
    }
    return range_of(warped_depth(surface.depth_linear));
}
