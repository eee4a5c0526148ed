// Learned methods with anchors, pass 1: the exported text's statistics.
import package::learned::weight::{peelnet_statistics, peelnet_zeta};
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
    let zeta = peelnet_zeta(surface.depth_linear, camera.range_near, camera.range_far);
    let s = peelnet_statistics(opacity(surface), zeta);
    return Statistics(s.moments, s.extent);
}
