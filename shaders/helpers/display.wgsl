// The transfer function of sRGB, for scenes that blend as displays show and for splats in those that do not; as peelnet_core::srgb.

// What a display shows for linear light; what is brighter than white stays so.
fn shown_of(light: vec3f) -> vec3f {
    let x = max(light, vec3f(0.0));
    return select(1.055 * pow(x, vec3f(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3f(0.0031308));
}

// And back.
fn light_of(shown: vec3f) -> vec3f {
    return select(pow((shown + 0.055) / 1.055, vec3f(2.4)), shown / 12.92, shown <= vec3f(0.04045));
}
