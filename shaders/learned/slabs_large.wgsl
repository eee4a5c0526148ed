// Where a slab ends and the next begins, in the pixel, and the number of the last slab.
const PEELNET_FIRST_END: f32 = 0.3;
const PEELNET_SECOND_END: f32 = 0.6;
const PEELNET_THIRD_END: f32 = 0.82;
const PEELNET_LAST_SLAB: f32 = 3.0;

struct PeelnetStatistics {
    // Absorbance of each of four slabs.
    absorbances: vec4f,
    // Levels of the slabs' nearest and farthest fragments.
    nearest: vec4f,
    farthest: vec4f,
    // Absorbance times depth in the slab.
    firsts: vec4f,
}

// What a fragment adds to its pixel's statistics.
fn peelnet_statistics(alpha: f32, zeta: f32, quantiles: vec4f) -> PeelnetStatistics {
    let place = peelnet_place(alpha, zeta, quantiles);
    let halves = peelnet_records(alpha, place);
    let absorbances = peelnet_in_slab(place.absorbance, place.slab, 0.0);
    let nearest = peelnet_in_slab(halves.x, place.slab, PEELNET_EMPTY);
    let firsts = peelnet_in_slab(place.absorbance * place.inside, place.slab, 0.0);
    let farthest = peelnet_in_slab(halves.y, place.slab, PEELNET_EMPTY);
    return PeelnetStatistics(absorbances, nearest, farthest, firsts);
}

// The weight of a fragment, and whether it is known without the network.
fn peelnet_fragment(
    alpha: f32,
    zeta: f32,
    quantiles: vec4f,
    absorbances: vec4f,
    nearest: vec4f,
    farthest: vec4f,
    firsts: vec4f,
) -> vec2f {
    let place = peelnet_place(alpha, zeta, quantiles);
    return peelnet_weigh(place, alpha >= PEELNET_FAINT, absorbances, firsts, nearest, farthest, 4.0);
}
