// Opaque objects: their colour becomes C_0, their depth hides transparent fragments.
import package::scene::shade::shade;
import package::scene::surface::Surface;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec4f {
    return vec4f(shade(surface).rgb, 1.0);
}
