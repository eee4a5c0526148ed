// Opaque objects: their colour becomes C_0, their depth hides transparent fragments.
@if(mapped) import package::scene::maps::remember_footprint;
@if(cutout || splat) import package::scene::shade::is_hole;
import package::scene::shade::opaque;
import package::scene::surface::Surface;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec4f {
    @if(mapped) remember_footprint(surface.uv);
    @if(cutout || splat) {
        if is_hole(surface) {
            discard;
        }
    }
    return vec4f(opaque(surface), 1.0);
}
