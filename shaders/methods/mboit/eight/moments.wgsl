// mboit8, passes 1 and 2: absorbance and its first eight power moments over warped depth. In 32 bits they are more than the 32 bytes a
// pixel that one pass of portable WebGPU writes.
// Variants: lower | upper
import package::helpers::absorbance::{absorbance, warped_depth};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Moments {
    @if(lower) @location(0) zeroth: f32,
    @if(lower) @location(1) lower: vec4f,
    @if(upper) @location(0) upper: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Moments {
    if !visible(surface) {
        discard;
    }
    let b = absorbance(opacity(surface));
    let z = warped_depth(surface.depth_linear);
    let z2 = z * z;
    let powers = vec4f(z, z2, z2 * z, z2 * z2);
    @if(lower) return Moments(b, b * powers);
    @if(upper) return Moments(b * powers.w * powers);
}
