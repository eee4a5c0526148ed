// Dual depth peeling, first pass: the nearest and the farthest depth of every pixel.
import package::scene::surface::Surface;
import package::scene::visible::visible;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec2f {
    if !visible(surface) {
        discard;
    }
    return vec2f(-surface.depth_linear, surface.depth_linear);
}
