// bins and wavelet over a pixel's own range: the warped depths of its nearest fragment, negated, and of its farthest, by MAX blending.
import package::helpers::absorbance::warped_depth;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec2f {
    if !visible(surface) {
        discard;
    }
    let zeta = warped_depth(surface.depth_linear);
    return vec2f(-zeta, zeta);
}
