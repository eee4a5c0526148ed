// What a method writes of a fragment where the weight is an estimate of the transmittance in front of it, and the pixel's own is known.
import package::helpers::guards::WEIGHT_FLOOR;
@if(tinted) import package::scene::shade::covering;
import package::scene::surface::Surface;

struct Sums {
    @location(0) color: vec4f,
    // Blended multiplicatively: dst * (1 - src).
    @if(tinted) @location(1) covering: vec4f,
}

// `color` is premultiplied colour and alpha.
fn sums_of(surface: Surface, color: vec4f, transmittance: f32) -> Sums {
    let weighted = color * max(transmittance, WEIGHT_FLOOR);
    @if(tinted) return Sums(weighted, vec4f(covering(surface), 0.0));
    @else return Sums(weighted);
}
