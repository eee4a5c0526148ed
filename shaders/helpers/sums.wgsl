// What a weighted method writes of a fragment. Grey scenes need one target: sums of grey and of weights, and the transmittance.
struct Sums {
    @location(0) color: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @if(!packed && !tinted) @location(1) alpha: f32,
    @if(tinted) @location(1) alpha: vec4f,
}

// What the shader of Papakostas' thesis (2022) sums, as printed: C w against w, and prod (1 - w) in the place of the transmittance.
fn printed_sums(color: vec4f, weight: f32) -> Sums {
    return sums_of(vec4f(color.rgb * weight, weight), vec3f(clamp(weight, 0.0, 1.0)));
}

// `weighted` is premultiplied colour and alpha times the fragment's weight, `covering` what it takes of the light behind.
fn sums_of(weighted: vec4f, covering: vec3f) -> Sums {
    @if(packed) return Sums(vec4f(weighted.xw, 0.0, covering.x));
    @if(tinted) return Sums(weighted, vec4f(covering, 0.0));
    @if(!packed && !tinted) return Sums(weighted, covering.x);
}
