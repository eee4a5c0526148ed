// Slabs, pass 1: the exported text's absorbances of bins of depth, by adding 8 bits, and the pixel's two ends, by MAX blending.
import package::helpers::slabs::zeta_of;
import package::learned::weight::peelnet_bins;
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Bins {
    @location(0) front: vec4f,
    @location(1) back: vec4f,
    @location(2) range: vec2f,
}

@fragment
fn fragment_main(surface: Surface) -> Bins {
    if !visible(surface) {
        discard;
    }
    let bins = peelnet_bins(opacity(surface), zeta_of(surface.depth_linear));
    return Bins(bins.front, bins.back, bins.range);
}
