// The least and the most of the rest's absorbance that can lie in front of a fragment, as shares, from its first four
// moments (Muenstermann et al. 2018). Statistics pass: one more target,
//     fourth   r16float (or r32float), cleared to 0, blending ONE, ONE, ADD: peelnet_statistics(..).fourth

fn peelnet_moment_bounds(alpha: f32, zeta: f32, f: PeelnetFeatures, fourth: f32) -> vec2f {
    let near = f.ends.z;
    let scale = 1.0 / max(f.ends.w - near, 2.0 / PEELNET_TOP);
    let z = vec3f(zeta, near, f.ends.w);
    let z4 = z * z * z * z;
    let taken = dot(vec3f(peelnet_absorbance(alpha), f.ends.xy), z4);
    let mean = vec4f(f.means.xyz, (fourth - taken) / f.means.w);
    // Moments over 0 .. 1, then over -1 .. 1, where the neutral measure is known.
    let t1 = f.mean_fraction;
    let t2 = (mean.y - near * (2.0 * mean.x - near)) * scale * scale;
    let t3 = (mean.z - near * (3.0 * mean.y - near * (3.0 * mean.x - near))) * scale * scale * scale;
    let t4 = (mean.w - near * (4.0 * mean.z - near * (6.0 * mean.y - near * (4.0 * mean.x - near))))
        * (scale * scale) * (scale * scale);
    let bias = 0.001;
    let m = mix(
        vec4f(
            2.0 * t1 - 1.0,
            4.0 * (t2 - t1) + 1.0,
            8.0 * t3 - 12.0 * t2 + 6.0 * t1 - 1.0,
            16.0 * t4 - 32.0 * t3 + 24.0 * t2 - 8.0 * t1 + 1.0,
        ),
        vec4f(0.0, 0.375, 0.0, 0.375),
        bias,
    );
    let x = 2.0 * f.depth_fraction - 1.0;
    // Cholesky factors of the Hankel matrix, the kernel polynomial, its roots: the bound's other two points.
    let variance = m.y - m.x * m.x;
    let l21_variance = m.z - m.x * m.y;
    let l21 = l21_variance / variance;
    let d22 = m.w - m.y * m.y - l21_variance * l21;
    let y1 = x - m.x;
    let y2 = x * x - m.y - l21 * y1;
    let c2 = y2 / d22;
    let c1 = y1 / variance - l21 * c2;
    let c0 = 1.0 - m.x * c1 - m.y * c2;
    let half_p = 0.5 * c1 / c2;
    let root = sqrt(max(half_p * half_p - c0 / c2, 0.0));
    let z1 = -half_p - root;
    let z2_ = -half_p + root;
    let f1 = select(0.0, 1.0, z1 < x);
    let f2 = select(0.0, 1.0, z2_ < x);
    // The quadratic through the three points, and its mean: without and with what lies at x itself.
    let f0 = vec2f(0.0, 1.0);
    let f01 = (f1 - f0) / (z1 - x);
    let f12 = (f2 - f1) / (z2_ - z1);
    let f012 = (f12 - f01) / (z2_ - x);
    let a0 = f0 - x * (f01 - f012 * z1);
    let a1 = f01 - f012 * (z1 + x);
    let share = a0 + a1 * m.x + f012 * m.y;
    // Points that coincide give NaN, which no comparison finds true.
    return select(vec2f(0.0), min(share, vec2f(1.0)), share >= vec2f(0.0));
}
