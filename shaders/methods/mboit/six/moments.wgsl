// mboit6, pass 1: absorbance and its first six power moments over warped depth.
import package::helpers::absorbance::{absorbance, warped_depth};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Moments {
    @location(0) zeroth: f32,
    @location(1) lower: vec4f,
    @location(2) higher: vec2f,
}

@fragment
fn fragment_main(surface: Surface) -> Moments {
    if !visible(surface) {
        discard;
    }
    let b = absorbance(opacity(surface));
    let z = warped_depth(surface.depth_linear);
    let z2 = z * z;
    let z4 = z2 * z2;
    return Moments(b, b * vec4f(z, z2, z2 * z, z4), b * vec2f(z4 * z, z4 * z2));
}
