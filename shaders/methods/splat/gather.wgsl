// splat, pass 3: eq 6 with the transmittance that follows from the slabs in front and from the mean depth of what shares the fragment's.
// Variants: none | packed | tinted
import package::helpers::absorbance::absorbance;
import package::helpers::guards::WEIGHT_FLOOR;
import package::helpers::sums::{Sums, sums_of};
import package::methods::splat::place::{place_of, slab_of};
@if(tinted) import package::scene::shade::covering;
import package::scene::shade::shade;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var quantiles: texture_2d<f32>;
@group(1) @binding(1) var bilinear: sampler;
@group(1) @binding(2) var borders_near: texture_2d<f32>;
@group(1) @binding(3) var borders_far: texture_2d<f32>;
@group(1) @binding(4) var ends_of_pixel: texture_2d<f32>;
@group(1) @binding(5) var absorbances_near: texture_2d<f32>;
@group(1) @binding(6) var absorbances_far: texture_2d<f32>;
@group(1) @binding(7) var firsts_near: texture_2d<f32>;
@group(1) @binding(8) var firsts_far: texture_2d<f32>;

// The channels of slabs before this one, together.
fn before(near: vec4f, far: vec4f, number: f32) -> f32 {
    let numbers = vec4f(0.0, 1.0, 2.0, 3.0);
    let first = select(vec4f(0.0), near, numbers < vec4f(number));
    let second = select(vec4f(0.0), far, numbers + 4.0 < vec4f(number));
    return dot(first + second, vec4f(1.0));
}

fn channel(near: vec4f, far: vec4f, number: f32) -> f32 {
    let numbers = vec4f(0.0, 1.0, 2.0, 3.0);
    let first = select(vec4f(0.0), near, numbers == vec4f(number));
    let second = select(vec4f(0.0), far, numbers + 4.0 == vec4f(number));
    return dot(first + second, vec4f(1.0));
}

// The share of what lies in a slab in front of a place in it, where its density is linear in depth, as steep as its mean depth asks for.
fn share_in_front(place: f32, mean: f32) -> f32 {
    let slope = clamp(3.0 - 6.0 * mean, -1.0, 1.0);
    return place + slope * (place - place * place);
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let place = place_of(surface.depth_linear, quantiles, bilinear, surface.position.xy);
    let ends = textureLoad(ends_of_pixel, pixel, 0).xy;
    let slab = slab_of(place, textureLoad(borders_near, pixel, 0), textureLoad(borders_far, pixel, 0), ends);
    // Sums of 16-bit targets may become infinite.
    let near = min(textureLoad(absorbances_near, pixel, 0), vec4f(65504.0));
    let far = min(textureLoad(absorbances_far, pixel, 0), vec4f(65504.0));
    let first = channel(textureLoad(firsts_near, pixel, 0), textureLoad(firsts_far, pixel, 0), slab.number);
    let b = absorbance(color.a);
    let others = max(channel(near, far, slab.number) - b, 0.0);
    let mean = clamp((first - b * slab.inside) / max(others, 1e-6), 0.0, 1.0);
    let in_front = before(near, far, slab.number) + others * share_in_front(slab.inside, mean);
    let weight = clamp(exp(-in_front), WEIGHT_FLOOR, 1.0);
    @if(tinted) return sums_of(color * weight, covering(surface));
    @else return sums_of(color * weight, vec3f(color.a));
}
