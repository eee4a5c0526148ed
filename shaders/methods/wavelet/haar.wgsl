// The absorbance in front of a depth as a step function in Haar wavelets of rank 3 (Aizenshtein, Smal & McGuire,
// "Wavelet Transparency", 2022): the average over the whole range, then half the difference of the averages of every
// block's halves, for blocks of 16, 8, 4 and 2 of 16 bins. Twin of peelnet_core::methods::wavelet.
import package::helpers::absorbance::warped_depth;
import package::scene::surface::Surface;

// In this order: average, 1 block of 16, 2 of 8 | 4 of 4 | 8 of 2.
struct Coefficients {
    @location(0) whole: vec4f,
    @location(1) quarters: vec4f,
    @location(2) near: vec4f,
    @location(3) far: vec4f,
}

// Depth in bins, 0 .. 15: the last bin lies behind everything.
fn in_bins(surface: Surface) -> f32 {
    return 7.5 * warped_depth(surface.depth_linear) + 7.5;
}

// Half the difference of the averages of both halves of a block, of a unit step at t of it, 0 .. 1.
fn difference(t: f32) -> f32 {
    return min(t, 1.0 - t);
}

fn step_at(position: f32, b: f32) -> Coefficients {
    let four = floor(position * 0.25);
    let two = floor(position * 0.5);
    let eighth = difference(fract(position * 0.125)) * b;
    let quarter = difference(fract(position * 0.25)) * b;
    let half = difference(fract(position * 0.5)) * b;
    let index = vec4f(0.0, 1.0, 2.0, 3.0);
    return Coefficients(
        vec4f(
            b * (1.0 - position * 0.0625),
            difference(position * 0.0625) * b,
            select(eighth, 0.0, position >= 8.0),
            select(0.0, eighth, position >= 8.0),
        ),
        select(vec4f(0.0), vec4f(quarter), index == vec4f(four)),
        select(vec4f(0.0), vec4f(half), index == vec4f(two)),
        select(vec4f(0.0), vec4f(half), index == vec4f(two - 4.0)),
    );
}

// Average absorbance in front, over a bin.
fn average(c: Coefficients, bin: i32) -> f32 {
    if bin < 0 {
        return 0.0;
    }
    let bit = vec4<bool>((bin & 8) != 0, (bin & 4) != 0, (bin & 2) != 0, (bin & 1) != 0);
    let half = select(c.near[(bin >> 1) & 3], c.far[(bin >> 1) & 3], bit.x);
    let d = vec4f(c.whole.y, c.whole[2 + (bin >> 3)], c.quarters[bin >> 2], half);
    return c.whole.x + dot(select(-d, d, bit), vec4f(1.0));
}
