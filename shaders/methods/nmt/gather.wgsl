// nmt, pass 2: eq 6 with the weight that the exported network gives.
import package::helpers::range::transparent_range;
import package::learned::weight::{peelnet_fragment, peelnet_zeta_in};
import package::scene::camera::camera;
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var totals: texture_2d<f32>;
@group(1) @binding(1) var moments: texture_2d<f32>;
@group(1) @binding(2) var extents: texture_2d<f32>;

@fragment
fn fragment_main(surface: Surface) -> @location(0) vec4f {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let weight = peelnet_fragment(
        peelnet_zeta_in(surface.depth_linear, transparent_range()),
        textureLoad(totals, pixel, 0),
        textureLoad(moments, pixel, 0),
        textureLoad(extents, pixel, 0).xy,
    );
    return color * weight;
}
