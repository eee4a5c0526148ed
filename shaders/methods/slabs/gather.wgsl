// slabs, pass 3: eq 6 with the transmittance in front of each fragment: known where it is its slab's nearest or farthest, and else the
// middle between the bounds.
// Variants: none | few | apart | tinted | few tinted | apart tinted
import package::helpers::absorbance::warped_depth;
import package::methods::slabs::slab::{BINS, CHANNELS, EMPTY, FAINT, OPACITIES, Place, absorbance_of, levels_of, middle_of, of_slab, place_of};
import package::scene::shade::shade;
@if(tinted) import package::scene::shade::covering;
import package::scene::surface::Surface;
import package::scene::visible::visible;

@group(1) @binding(0) var range: texture_2d<f32>;
@group(1) @binding(1) var absorbances: texture_2d<f32>;
@group(1) @binding(2) var firsts: texture_2d<f32>;
@group(1) @binding(3) var nearest: texture_2d<f32>;
@group(1) @binding(4) var farthest: texture_2d<f32>;
@if(!few) @group(1) @binding(5) var farthest_third: texture_2d<f32>;

struct Sums {
    @location(0) between: vec4f,
    @if(apart) @location(1) ends: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @if(tinted && !apart) @location(1) covering: vec4f,
    @if(tinted && apart) @location(2) covering: vec4f,
}

// Absorbance in front of a fragment between its slab's ends, within the slab. `total` and `first` are the slab's sums, `levels` its
// nearest and farthest fragment.
fn in_front(place: Place, total: f32, first: f32, levels: vec2f) -> f32 {
    let b = place.absorbance;
    let others = max(total - b, 0.0);
    let noise = max(total * 0.0009765625, 1e-6);
    let near_back = floor(levels.x / OPACITIES);
    let near_bin = BINS - 1.0 - near_back;
    let near_level = levels.x + (near_bin - near_back) * OPACITIES;
    let known = absorbance_of(levels.x);
    // All others, as far as the level's rounding and the sum's can tell.
    let step = 0.6 / (OPACITIES - 1.0);
    let all = known > others - (step * (1.0 + known) * (1.0 + known) + noise);
    let near = select(select(known, others, all), 0.0, near_bin > place.bin);
    let far_bin = floor(levels.y / OPACITIES);
    let is_one = levels.y == near_level || levels.y < 0.0;
    let far = select(absorbance_of(levels.y), 0.0, is_one || far_bin < place.bin);
    var begin = middle_of(near_bin);
    var end = select(middle_of(far_bin), 1.0, is_one);
    let rest = total - b - near - far;
    let moment = first - b * place.inside - near * begin - far * end;
    begin = select(begin, -1.0, begin > place.inside);
    end = select(end, 1.0, end < place.inside);
    let extent = max(end - begin, 2.0 / BINS);
    let x = clamp((place.inside - begin) / extent, 0.0, 1.0);
    let depth = clamp(moment / max(rest, noise), begin, end);
    let mean = clamp((depth - begin) / extent, 0.0, 1.0);
    // Markov's bounds of the share in front.
    let before = x < mean;
    let low = select((x - mean) / max(x, 1e-6), 0.0, before);
    let high = select(1.0, (1.0 - mean) / max(1.0 - x, 1e-6), before);
    @if(few) let share = select(0.5, 0.5 * (low + high), place.slab < 2.0);
    @else let share = 0.5 * (low + high);
    return near + share * max(rest, 0.0);
}

@fragment
fn fragment_main(surface: Surface) -> Sums {
    if !visible(surface) {
        discard;
    }
    let pixel = vec2u(surface.position.xy);
    let color = shade(surface);
    let place = place_of(color.a, warped_depth(surface.depth_linear), textureLoad(range, pixel, 0).xy);
    let sums = textureLoad(absorbances, pixel, 0);
    let total = of_slab(sums, place.slab);
    let first = of_slab(textureLoad(firsts, pixel, 0), place.slab);
    let first_two = textureLoad(farthest, pixel, 0).xy;
    @if(few) let last = vec4f(first_two.x, EMPTY, EMPTY, EMPTY);
    @else let last = vec4f(first_two, textureLoad(farthest_third, pixel, 0).x, EMPTY);
    let halves = vec2f(of_slab(textureLoad(nearest, pixel, 0), place.slab), of_slab(last, place.slab));
    // Slabs without a record of their farthest fragment have none.
    @if(few) let kept = place.slab < 1.0;
    @else let kept = place.slab < 3.0;
    let levels = select(vec2f(levels_of(halves).x, -1.0), levels_of(halves), kept);
    let before = select(vec4f(0.0), sums, CHANNELS < vec4f(place.slab));
    let counts = color.a >= FAINT;
    let is_near = counts && place.near == levels.x;
    let is_far = counts && place.far == levels.y && !is_near;
    var inside = select(0.0, max(total - place.absorbance, 0.0), is_far);
    if !(is_near || is_far) {
        inside = in_front(place, total, first, levels);
    }
    // The nearest fragment's weight is 1: their sum cannot vanish.
    let sum = color * exp(-(before.x + before.y + before.z + inside));
    @if(tinted) let covers = vec4f(covering(surface), 0.0);
    @if(apart) {
        let known = is_near || is_far;
        let between = select(sum, vec4f(0.0), known);
        let ends = select(vec4f(0.0), sum, known);
        @if(tinted) return Sums(between, ends, covers);
        @else return Sums(between, ends);
    }
    @else {
        @if(tinted) return Sums(sum, covers);
        @else return Sums(sum);
    }
}
