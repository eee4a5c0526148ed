// mboit4, pass 1: absorbance and its first four power moments over warped depth.
import package::helpers::absorbance::{absorbance, warped_depth};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Moments {
    @location(0) zeroth: f32,
    @location(1) higher: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Moments {
    if !visible(surface) {
        discard;
    }
    let b = absorbance(opacity(surface));
    let z = warped_depth(surface.depth_linear);
    let z2 = z * z;
    return Moments(b, b * vec4f(z, z2, z2 * z, z2 * z2));
}
