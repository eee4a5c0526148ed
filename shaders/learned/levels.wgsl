// The half floats that stand for levels: all normal halves in ascending order, so that MAX blending of 16-bit targets
// distinguishes 61440 levels. A step of a half's bits is 8192 in those of 32 bits; no step here rounds. No level is in the middle.
fn peelnet_halves(levels: vec3f) -> vec3f {
    let from_middle = levels - 30719.5;
    return sign(from_middle) * bitcast<vec3f>(vec3i(abs(from_middle) * 8192.0 + 947908608.0));
}

fn peelnet_levels(halves: vec3f) -> vec3f {
    let from_middle = vec3f(bitcast<vec3i>(abs(halves))) * 0.0001220703125 - 115711.5;
    return 30719.5 + sign(halves) * from_middle;
}
