struct PeelnetStatistics {
    // Absorbance of each slab.
    absorbances: vec4f,
    // Levels of the slabs' nearest fragments, and of the farthest of the nearest slab.
    nearest: vec4f,
    farthest: f32,
    // Absorbance times depth in the slab, of the two nearer slabs.
    firsts: vec2f,
}

// What a fragment adds to its pixel's statistics. range: of the pixel, as the pass before left it.
fn peelnet_statistics(alpha: f32, zeta: f32, range: vec2f) -> PeelnetStatistics {
    let place = peelnet_place(alpha, zeta, range);
    let halves = peelnet_records(alpha, place);
    return PeelnetStatistics(
        peelnet_in_slab(place.absorbance, place.slab, 0.0),
        peelnet_in_slab(halves.x, place.slab, PEELNET_EMPTY),
        select(halves.y, PEELNET_EMPTY, place.slab > 0.0),
        peelnet_in_slab(place.absorbance * place.inside, place.slab, 0.0).xy,
    );
}

// The weight of a fragment, and whether it is known without the network.
fn peelnet_fragment(
    alpha: f32,
    zeta: f32,
    range: vec2f,
    absorbances: vec4f,
    nearest: vec4f,
    farthest: f32,
    firsts: vec2f,
) -> vec2f {
    let place = peelnet_place(alpha, zeta, range);
    let last = vec4f(farthest, vec3f(PEELNET_EMPTY));
    return peelnet_weigh(place, alpha >= PEELNET_FAINT, absorbances, vec4f(firsts, 0.0, 0.0), nearest, last, vec2f(2.0, 1.0));
}
