// Depth on a logarithmic scale, -1 at near and 1 at far. z: distance along the view axis. near, far: the nearest and the
// farthest z that transparent surfaces have in this frame. Where near is not above 0 the scale is linear: with an orthographic
// camera call peelnet_zeta(z - near, 0.0, far - near). A flat range has one value, -1.
fn peelnet_zeta(z: f32, near: f32, far: f32) -> f32 {
    let linear = near <= 0.0;
    // The logarithm of a ratio: the difference of two would depend on the scene's unit by their rounding.
    let start = max(near, 1.17549435e-38);
    let depth = select(log(max(z / start, 1.0)), z - near, linear);
    let range = select(log(max(far / start, 1.0)), far - near, linear);
    // Closer than that, depths hardly differ.
    let flat = range <= select(1e-6, 0.0, linear);
    let scaled = select(depth * (2.0 / max(range, 1e-30)), 0.0, flat);
    return clamp(scaled - 1.0, -1.0, 1.0);
}
