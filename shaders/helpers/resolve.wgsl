// The resolve of every normalised method: (sum C w / sum alpha w)(1 - T) + C_0 T.
// As peelnet_core::methods::wboit::normalised.
import package::helpers::guards::{SUM_FLOOR, HALF_MAX};

// What is left of sums where their targets ended: colours of 16-bit targets stop at the largest half, and some GPUs give
// infinity there. 32-bit targets do not end.
fn within(sums: vec4f) -> vec4f {
    @if(full_sums) {
        return sums;
    }
    @else {
        return min(sums, vec4f(HALF_MAX));
    }
}

// The sum of weights as a divisor: not below the smallest number that its target can hold.
fn divisor(weights: f32) -> f32 {
    @if(full_sums) {
        return max(weights, 1.17549435e-38);
    }
    @else {
        return max(weights, SUM_FLOOR);
    }
}

// `sums` holds sum C w and sum alpha w, `transmittance` T of the whole pixel. Returns colour and coverage.
fn normalised(sums: vec4f, transmittance: f32, background: vec3f) -> vec4f {
    // A pixel that nothing covers keeps C_0 bit for bit.
    if transmittance == 1.0 {
        return vec4f(background, 0.0);
    }
    // Where a 16-bit target overflowed every component is at its ceiling at best: grey of the average is the best guess left.
    let finite = within(sums);
    let average = finite.rgb / divisor(finite.a);
    return vec4f(average * (1.0 - transmittance) + background * transmittance, 1.0 - transmittance);
}

// The same where light takes a colour on its way (McGuire and Mara 2016, without their diffusion and refraction): what surfaces show is
// weighed by the mean of what they cover, which is exact for one surface, and what is behind them passes channel by channel.
fn normalised_by_channel(sums: vec4f, transmittance: vec3f, background: vec3f) -> vec4f {
    if all(transmittance == vec3f(1.0)) {
        return vec4f(background, 0.0);
    }
    let finite = within(sums);
    let covered = 1.0 - dot(transmittance, vec3f(1.0 / 3.0));
    return vec4f(finite.rgb / divisor(finite.a) * covered + background * transmittance, covered);
}
