// The two nearest fragments of each pixel are composited exactly (by depth peeling, or insertion); all others, the
// tail, are summed in one additive pass behind the second: (alpha * rgb, alpha) and (absorbance, 1). Then, per pixel,
// over the background C_0:
//     front.rgb + front.a * (1 - t) * tail_color + front.a * t * C_0,   t = exp(-sums.x)

struct PeelnetTail {
    color: vec3f,
    transmittance: f32,
}

fn peelnet_absorbance(alpha: f32) -> f32 {
    return -log(max(1.0 - alpha, 1.1253517e-7));
}

// front: premultiplied colour and transmittance of the two nearest. tail: sums of (alpha * rgb, alpha). sums: absorbance
// and number of the tail's fragments.
fn peelnet_tail(front: vec4f, tail: vec4f, sums: vec2f) -> PeelnetTail {
    let average = tail.rgb / max(tail.a, 1e-6);
    let transmittance = exp(-sums.x);
    let color = peelnet_tail_color(
        front.r, front.g, front.b, front.a,
        average.r, average.g, average.b, tail.a / max(sums.y, 1.0),
        transmittance, sums.y);
    // A tail of one fragment is its colour.
    return PeelnetTail(select(color, average, sums.y < 1.5), transmittance);
}
