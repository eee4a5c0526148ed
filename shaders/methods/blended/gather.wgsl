// blended (McGuire & Bavoil 2013, eq 5): sum C, sum alpha and the transmittance of the whole pixel.
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
    return Sums(color, color.a);
}
