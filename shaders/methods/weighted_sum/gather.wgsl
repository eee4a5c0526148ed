// weighted-sum (Meshkin 2007): sum C and sum alpha.
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec4f {
    if !visible(surface) {
        discard;
    }
    let color = shade(surface);
    return color;
}
