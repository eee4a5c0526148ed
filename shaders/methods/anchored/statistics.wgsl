// Learned methods with anchors, pass 1: the exported text's statistics.
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_statistics, peelnet_zeta_in};
import package::scene::camera::camera;
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Statistics {
    @location(0) moments: vec4f,
    @location(1) extent: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Statistics {
    if !visible(surface) {
        discard;
    }
    let zeta = peelnet_zeta_in(surface.depth_linear, transparent_range());
    let s = peelnet_statistics(opacity(surface), zeta);
    return Statistics(s.moments, s.extent);
}
