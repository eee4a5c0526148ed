// Slabs, pass 1: the exported text's absorbances of bins of depth, by adding 8 bits.
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_bins, peelnet_zeta_in};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Bins {
    @location(0) front: vec4f,
    @location(1) back: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Bins {
    if !visible(surface) {
        discard;
    }
    let bins = peelnet_bins(opacity(surface), peelnet_zeta_in(surface.depth_linear, transparent_range()));
    return Bins(bins.front, bins.back);
}
