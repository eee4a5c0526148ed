// Slabs, pass 1: the exported text's range of a pixel, by MAX blending of 8 bits.
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_pixel_range, peelnet_zeta_in};
import package::scene::surface::Surface;
import package::scene::visible::visible;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec2f {
    if !visible(surface) {
        discard;
    }
    return peelnet_pixel_range(peelnet_zeta_in(surface.depth_linear, transparent_range()));
}
