// One pass, where light takes a colour: what fragments cover of each channel, which its own targets have no room for.
import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec4f {
    if !visible(surface) {
        discard;
    }
    // Blended multiplicatively: dst * (1 - src).
    return vec4f(covering(surface), 0.0);
}
