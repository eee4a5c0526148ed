// Where a slab ends and the next begins, in the pixel, and the number of the last slab.
const PEELNET_FIRST_END: f32 = 0.4;
const PEELNET_SECOND_END: f32 = 0.75;
const PEELNET_THIRD_END: f32 = 1.0;
const PEELNET_LAST_SLAB: f32 = 2.0;

struct PeelnetStatistics {
    // Absorbance of each of three slabs; absorbance times depth in the slab, of the first.
    absorbances: vec4f,
    // Levels of the slabs' nearest fragments; absorbance times depth in the slab, of the second.
    nearest: vec4f,
    // Levels of the slabs' farthest fragments; absorbance times depth in the slab, of the third.
    farthest: vec4f,
}

// What a fragment adds to its pixel's statistics.
fn peelnet_statistics(alpha: f32, zeta: f32, quantiles: vec4f) -> PeelnetStatistics {
    let place = peelnet_place(alpha, zeta, quantiles);
    let halves = peelnet_records(alpha, place);
    let absorbances = peelnet_in_slab(place.absorbance, place.slab, 0.0);
    let nearest = peelnet_in_slab(halves.x, place.slab, PEELNET_EMPTY);
    let firsts = peelnet_in_slab(place.absorbance * place.inside, place.slab, 0.0);
    let farthest = peelnet_in_slab(halves.y, place.slab, PEELNET_EMPTY);
    return PeelnetStatistics(
        vec4f(absorbances.xyz, firsts.x),
        vec4f(nearest.xyz, firsts.y),
        vec4f(farthest.xyz, firsts.z),
    );
}

// The weight of a fragment, and whether it is known without the network.
fn peelnet_fragment(alpha: f32, zeta: f32, quantiles: vec4f, absorbances: vec4f, nearest: vec4f, farthest: vec4f) -> vec2f {
    let place = peelnet_place(alpha, zeta, quantiles);
    let firsts = vec4f(absorbances.w, nearest.w, farthest.w, 0.0);
    return peelnet_weigh(place, alpha >= PEELNET_FAINT, absorbances, firsts, nearest, farthest, 3.0);
}
