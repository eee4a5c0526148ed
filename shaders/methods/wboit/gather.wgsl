// wboit (McGuire & Bavoil 2013, eq 6): sum C w, sum alpha w and the transmittance of the whole pixel.
// Variants: eq7 | eq8 | eq9 | eq10 | inverse_power | smoke | papakostas | papakostas printed | papakostas printed packed | papakostas printed tinted | eq7 packed | eq7 tinted
import package::helpers::weights::{weight_eq7, weight_eq8, weight_eq9, weight_eq10, weight_inverse_power, weight_smoke, weight_papakostas};
import package::parameters::{FACTOR, POWER, EPSILON};
import package::helpers::sums::{Sums, sums_of};
@if(printed) import package::helpers::sums::printed_sums;
import package::scene::shade::shade;
@if(tinted && !printed) import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let color = shade(surface);
    @if(eq7) let weight = weight_eq7(surface.depth_linear, color.a);
    @if(eq8) let weight = weight_eq8(surface.depth_linear, color.a);
    @if(eq9) let weight = weight_eq9(surface.depth_linear, color.a);
    @if(eq10) let weight = weight_eq10(surface.position.z, color.a, FACTOR);
    @if(inverse_power) let weight = weight_inverse_power(surface.depth_linear, POWER, EPSILON);
    @if(smoke) let weight = weight_smoke(surface.depth_linear, EPSILON);
    @if(papakostas) let weight = weight_papakostas(surface.depth_linear, color.a);
    @if(printed) return printed_sums(color, weight);
    @if(tinted && !printed) return sums_of(color * weight, covering(surface));
    @if(!tinted && !printed) return sums_of(color * weight, vec3f(color.a));
}
