// Where a slab ends and the next begins, in the pixel, and the number of the last slab.
const PEELNET_FIRST_END: f32 = 0.49;
const PEELNET_SECOND_END: f32 = 0.77;
const PEELNET_THIRD_END: f32 = 1.0;
const PEELNET_LAST_SLAB: f32 = 2.0;

struct PeelnetStatistics {
    // Absorbance of each of three slabs; absorbance times depth in the slab, of the first.
    absorbances: vec4f,
    // Levels of the slabs' nearest fragments, and of the farthest of the first.
    nearest: vec4f,
    // Absorbance times depth in the slab, of the other two.
    firsts: vec2f,
}

// What a fragment adds to its pixel's statistics.
fn peelnet_statistics(alpha: f32, zeta: f32, quantiles: vec4f) -> PeelnetStatistics {
    let place = peelnet_place(alpha, zeta, quantiles);
    let halves = peelnet_records(alpha, place);
    let absorbances = peelnet_in_slab(place.absorbance, place.slab, 0.0);
    let nearest = peelnet_in_slab(halves.x, place.slab, PEELNET_EMPTY);
    let firsts = peelnet_in_slab(place.absorbance * place.inside, place.slab, 0.0);
    let farthest = select(halves.y, PEELNET_EMPTY, place.slab > 0.0);
    return PeelnetStatistics(vec4f(absorbances.xyz, firsts.x), vec4f(nearest.xyz, farthest), firsts.yz);
}

// The weight of a fragment, and whether it is known without the network.
fn peelnet_fragment(alpha: f32, zeta: f32, quantiles: vec4f, absorbances: vec4f, nearest: vec4f, firsts: vec2f) -> vec2f {
    let place = peelnet_place(alpha, zeta, quantiles);
    let means = vec4f(absorbances.w, firsts, 0.0);
    let last = vec4f(nearest.w, vec3f(PEELNET_EMPTY));
    return peelnet_weigh(place, alpha >= PEELNET_FAINT, absorbances, means, nearest, last, 1.0);
}
