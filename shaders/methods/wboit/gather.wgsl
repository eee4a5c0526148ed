// wboit (McGuire & Bavoil 2013, eq 6): sum C w, sum alpha w and the transmittance of the whole pixel.
import package::helpers::weights::{weight_eq7, weight_eq8, weight_eq9, weight_eq10, weight_inverse_power, weight_papakostas};
import package::parameters::{FACTOR, POWER, EPSILON};
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Sums {
    @location(0) color: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @location(1) alpha: f32,
}

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
    @if(papakostas) let weight = weight_papakostas(surface.depth_linear, color.a);
    return Sums(color * weight, color.a);
}
