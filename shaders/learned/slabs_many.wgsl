struct PeelnetStatistics {
    // Absorbance of each slab.
    absorbances: vec4f,
    // Levels of the slabs' nearest fragments.
    nearest: vec4f,
    // Levels of the farthest fragments of the three nearer slabs; absorbance times depth in the slab, of the third.
    farthest: vec4f,
    // Absorbance times depth in the slab, of the first two.
    firsts: vec2f,
}

// What a fragment adds to its pixel's statistics. range: of the pixel, as the pass before left it.
fn peelnet_statistics(alpha: f32, zeta: f32, range: vec2f) -> PeelnetStatistics {
    let place = peelnet_place(alpha, zeta, range);
    let halves = peelnet_records(alpha, place);
    let farthest = peelnet_in_slab(halves.y, place.slab, PEELNET_EMPTY);
    let firsts = peelnet_in_slab(place.absorbance * place.inside, place.slab, 0.0);
    return PeelnetStatistics(
        peelnet_in_slab(place.absorbance, place.slab, 0.0),
        peelnet_in_slab(halves.x, place.slab, PEELNET_EMPTY),
        vec4f(farthest.xyz, firsts.z),
        firsts.xy,
    );
}

// The weight of a fragment, and whether it is known without the network.
fn peelnet_fragment(
    alpha: f32,
    zeta: f32,
    range: vec2f,
    absorbances: vec4f,
    nearest: vec4f,
    farthest: vec4f,
    firsts: vec2f,
) -> vec2f {
    let place = peelnet_place(alpha, zeta, range);
    let last = vec4f(farthest.xyz, PEELNET_EMPTY);
    let means = vec4f(firsts, farthest.w, 0.0);
    return peelnet_weigh(place, alpha >= PEELNET_FAINT, absorbances, means, nearest, last, vec2f(3.0, 3.0));
}
