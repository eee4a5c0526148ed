struct PeelnetStatistics {
    // Colour, not premultiplied, and alpha of a fragment behind the two nearest.
    behind: vec4f,
    // Premultiplied colour and alpha of any fragment.
    all: vec4f,
    // 1 for a fragment behind the two nearest.
    count: f32,
}

// What a fragment adds to its pixel's statistics. color: not premultiplied, with alpha. front: whether it is one of the two nearest.
fn peelnet_statistics(color: vec4f, front: bool) -> PeelnetStatistics {
    let behind = select(1.0, 0.0, front);
    return PeelnetStatistics(color * behind, vec4f(color.rgb * color.a, color.a), behind);
}

// The colour and coverage of a pixel. front: premultiplied colour and transmittance of the two nearest fragments. behind, all, count:
// the statistics.
fn peelnet_resolve(front: vec4f, behind: vec4f, all: vec4f, count: f32, background: vec3f) -> vec4f {
    // Up to two fragments are exact. Where nothing is covered, nothing shows.
    let few = count == 0.0;
    let color = select(peelnet_network(front, behind, all, count), vec3f(0.0), all.a == 1.0);
    let transmittance = select(all.a, front.a, few);
    return vec4f(select(color, front.rgb, few) + transmittance * background, 1.0 - transmittance);
}
