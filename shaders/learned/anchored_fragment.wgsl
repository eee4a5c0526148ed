// The weight of a fragment, and its end (see PeelnetPlace). The network's answer is not used for the ends, whose weights are known.
// No branch around it: neighbouring fragments rarely all lie at an end, and then it only costs.
fn peelnet_fragment(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> vec2f {
    // Sums of 16-bit targets may become infinite.
    let finite_moments = clamp(moments, vec4f(-65504.0), vec4f(65504.0));
    let finite_extent = vec4f(extent.xyz, min(extent.w, 65504.0));
    let place = peelnet_place(alpha, zeta, finite_moments, finite_extent);
    let rest = peelnet_rest(place, finite_moments, finite_extent);
    let share = peelnet_network(rest);
    let between = select(rest.root_absorbance * rest.root_absorbance * share, 0.0, place.end > 0.0);
    return vec2f(exp(-(place.in_front + between)), place.end);
}
