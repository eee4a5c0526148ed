// What a weighted method writes of a fragment. Grey scenes need one target: sums of grey and of weights, and the transmittance.
struct Sums {
    @location(0) color: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @if(!packed && !tinted) @location(1) alpha: f32,
    @if(tinted) @location(1) alpha: vec4f,
}

// `weighted` is premultiplied colour and alpha times the fragment's weight, `covering` what it takes of the light behind.
fn sums_of(weighted: vec4f, covering: vec3f) -> Sums {
    @if(packed) return Sums(vec4f(weighted.xw, 0.0, covering.x));
    @if(tinted) return Sums(weighted, vec4f(covering, 0.0));
    @if(!packed && !tinted) return Sums(weighted, covering.x);
}
