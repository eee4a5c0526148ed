// The bin of a fragment, and what it adds to it; as peelnet_render::methods::bins.
import package::helpers::absorbance::absorbance;
import package::parameters::BINS;

// Bin in x, place in it in y.
fn bin_of(place: f32) -> vec2f {
    let bin = min(floor(place * BINS), BINS - 1.0);
    return vec2f(bin, place * BINS - bin);
}

// Fragments beyond 0.99 hide all that is behind them; what others hide is capped.
fn capped_absorbance(alpha: f32) -> f32 {
    let b = absorbance(alpha);
    return select(min(b, 4.0), 16.0, alpha > 0.99);
}
