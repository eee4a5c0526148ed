// deep-thesis, pass 1: sum alpha and the number of fragments.
import package::learned::weight::peelnet_statistics;
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec2f {
    if !visible(surface) {
        discard;
    }
    return peelnet_statistics(opacity(surface));
}
