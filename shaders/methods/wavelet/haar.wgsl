// The absorbance in front of a depth as a step function in Haar wavelets (Aizenshtein, Smal & McGuire, "Wavelet Transparency",
// 2022): the average over the whole range, then half the difference of the averages of every block's halves, for blocks of all,
// halves, quarters and, of rank 3, eighths of the bins. The CPU reference is methods/wavelet/reference.rs.
import package::parameters::BINS;

struct Coefficients {
    // The average, the one block of all, two of halves.
    whole: vec4f,
    quarters: vec4f,
    near_eighths: vec4f,
    far_eighths: vec4f,
}

// Depth in bins, 0 .. BINS - 1, of a place in the range: the last bin lies behind everything.
fn in_bins(place: f32) -> f32 {
    return place * (BINS - 1.0);
}

// Half the difference of the averages of both halves of a block, of a unit step at t of it, 0 .. 1.
fn difference(t: f32) -> f32 {
    return min(t, 1.0 - t);
}

// What absorbance b at a depth in bins adds.
fn step_at(position: f32, b: f32) -> Coefficients {
    let t = position / BINS;
    let half = difference(fract(2.0 * t)) * b;
    let quarter = difference(fract(4.0 * t)) * b;
    let eighth = difference(fract(8.0 * t)) * b;
    let index = vec4f(0.0, 1.0, 2.0, 3.0);
    return Coefficients(
        vec4f(
            b * (1.0 - t),
            difference(t) * b,
            select(half, 0.0, t >= 0.5),
            select(0.0, half, t >= 0.5),
        ),
        select(vec4f(0.0), vec4f(quarter), index == vec4f(floor(4.0 * t))),
        select(vec4f(0.0), vec4f(eighth), index == vec4f(floor(8.0 * t))),
        select(vec4f(0.0), vec4f(eighth), index + 4.0 == vec4f(floor(8.0 * t))),
    );
}

// Average absorbance in front, over a bin.
fn average(c: Coefficients, bin: i32) -> f32 {
    if bin < 0 {
        return 0.0;
    }
    // In sixteenths; of eight bins all are even, and have no eighths.
    let place = bin * (16 / i32(BINS));
    let bit = vec4<bool>((place & 8) != 0, (place & 4) != 0, (place & 2) != 0, (place & 1) != 0);
    let eighth = select(c.near_eighths[(place >> 1) & 3], c.far_eighths[(place >> 1) & 3], bit.x);
    let d = vec4f(c.whole.y, c.whole[2 + (place >> 3)], c.quarters[place >> 2], eighth);
    return c.whole.x + dot(select(-d, d, bit), vec4f(1.0));
}
