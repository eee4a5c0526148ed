// A range of depths: 1 / near, 0 where depths are on a linear scale; near; 2 / its extent on the scale, 0 for a flat range.
struct PeelnetRange {
    inverse_near: f32,
    near: f32,
    scale: f32,
}

// near, far: the nearest and the farthest z that transparent surfaces have in this frame. The same for all fragments: it may be
// computed once a frame and passed in.
fn peelnet_range(near: f32, far: f32) -> PeelnetRange {
    let linear = near <= 0.0;
    let inverse_near = select(1.0 / max(near, 1.17549435e-38), 0.0, linear);
    let extent = select(log(max(far * inverse_near, 1.0)), far - near, linear);
    // Closer than that, depths hardly differ.
    let flat = extent <= select(1e-6, 0.0, linear);
    return PeelnetRange(inverse_near, near, select(2.0 / max(extent, 1e-30), 0.0, flat));
}

// The depth z on the scale of a range, -1 at near and 1 at far.
fn peelnet_zeta_in(z: f32, range: PeelnetRange) -> f32 {
    // The logarithm of a ratio: the difference of two would depend on the scene's unit by their rounding.
    let logarithmic = log(max(z * range.inverse_near, 1.0));
    let from_near = select(logarithmic, z - range.near, range.inverse_near == 0.0);
    return clamp(from_near * range.scale - 1.0, -1.0, 1.0);
}

// Depth on a logarithmic scale, -1 at near and 1 at far. z: distance along the view axis. Where near is not above 0 the scale is
// linear: with an orthographic camera call peelnet_zeta(z - near, 0.0, far - near). A flat range has one value, -1.
fn peelnet_zeta(z: f32, near: f32, far: f32) -> f32 {
    return peelnet_zeta_in(z, peelnet_range(near, far));
}
