// nmt, pass 1: absorbance, the number of fragments, four power moments, and the pixel's own range of depths.
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_statistics, peelnet_zeta_in};
import package::scene::camera::camera;
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Statistics {
    @location(0) totals: vec4f,
    @location(1) moments: vec4f,
    @location(2) extent: vec2f,
}

@fragment
fn fragment_main(surface: Surface) -> Statistics {
    if !visible(surface) {
        discard;
    }
    let zeta = peelnet_zeta_in(surface.depth_linear, transparent_range());
    let s = peelnet_statistics(opacity(surface), zeta);
    return Statistics(s.totals, s.moments, s.extent);
}
