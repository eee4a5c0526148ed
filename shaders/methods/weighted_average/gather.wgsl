// weighted-average (Bavoil & Myers 2008): sum C, sum alpha and the number of fragments.
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

struct Sums {
    @location(0) color: vec4f,
    @location(1) count: f32,
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let color = shade(surface);
    return Sums(color, 1.0);
}
