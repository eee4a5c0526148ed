// blended (McGuire & Bavoil 2013, eq 5): sum C, sum alpha and the transmittance of the whole pixel.
// Variants: none | packed | tinted
import package::helpers::sums::{Sums, sums_of};
import package::scene::shade::shade;
@if(tinted) import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let color = shade(surface);
    @if(tinted) return sums_of(color, covering(surface));
    @else return sums_of(color, vec3f(color.a));
}
