// splat, pass 2: of each slab the absorbance, and that times the place in the slab. What lies behind the last border is not drawn.
import package::helpers::absorbance::absorbance;
import package::methods::splat::place::{in_channels, place_of, slab_of};
import package::scene::shade::opacity;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var quantiles: texture_2d<f32>;
@group(1) @binding(1) var bilinear: sampler;
@group(1) @binding(2) var borders_near: texture_2d<f32>;
@group(1) @binding(3) var borders_far: texture_2d<f32>;
@group(1) @binding(4) var ends_of_pixel: texture_2d<f32>;

struct Statistics {
    @location(0) absorbances_near: vec4f,
    @location(1) absorbances_far: vec4f,
    @location(2) firsts_near: vec4f,
    @location(3) firsts_far: vec4f,
}

@fragment
fn fragment_main(surface: Surface) -> Statistics {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let place = place_of(surface.depth_linear, quantiles, bilinear, surface.position.xy);
    let ends = textureLoad(ends_of_pixel, pixel, 0).xy;
    let slab = slab_of(place, textureLoad(borders_near, pixel, 0), textureLoad(borders_far, pixel, 0), ends);
    let b = absorbance(opacity(surface));
    let first = b * slab.inside;
    return Statistics(
        in_channels(b, slab.number, 0.0),
        in_channels(b, slab.number, 4.0),
        in_channels(first, slab.number, 0.0),
        in_channels(first, slab.number, 4.0),
    );
}
