// nmt, pass 1: absorbance, the number of fragments, and four power moments.
import package::helpers::absorbance::warped_depth;
import package::learned::weight::peelnet_statistics;
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Statistics {
    @location(0) absorbance: vec2f,
    @location(1) moments: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Statistics {
    if !visible(surface) {
        discard;
    }
    let s = peelnet_statistics(opacity(surface), warped_depth(surface.depth_linear));
    return Statistics(s.absorbance, s.moments);
}
