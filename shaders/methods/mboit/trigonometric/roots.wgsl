// Zeros of polynomials all of whose zeros are real, coefficients from the constant one up; as peelnet_core::methods::moments::roots.
// Loops: 1: a constant.

fn quadratic(c: vec3f) -> vec2f {
    let half = 0.5 * c.y;
    let root = sqrt(max(half * half - c.x * c.z, 0.0));
    let q = -(half + select(-root, root, half >= 0.0));
    if q == 0.0 {
        return vec2f(0.0);
    }
    return vec2f(q / c.z, c.x / q);
}

fn cubic(c: vec4f) -> vec3f {
    let reversed = abs(c.x) > abs(c.w);
    let inverse = 1.0 / select(c.w, c.x, reversed);
    let a = select(c.z, c.y, reversed) * inverse;
    let b = select(c.y, c.z, reversed) * inverse;
    let d = select(c.x, c.w, reversed) * inverse;
    let q = max(a * a / 9.0 - b / 3.0, 1e-30);
    let r = (2.0 * a * a * a - 9.0 * a * b + 27.0 * d) / 54.0;
    let angle = acos(clamp(r / (q * sqrt(q)), -1.0, 1.0)) / 3.0;
    let third = 2.0943951;
    let roots = -2.0 * sqrt(q) * cos(angle + vec3f(0.0, third, -third)) - a / 3.0;
    return clamp(select(roots, 1.0 / roots, vec3<bool>(reversed)), vec3f(-1e4), vec3f(1e4));
}

// The leading coefficient stands alone.
fn quartic(lower: vec4f, leading: f32) -> vec4f {
    let c = lower / leading;
    let side = select(1.0, -1.0, c.w > 0.0);
    var x = -0.25 * c.w + 0.75 * side * sqrt(max(c.w * c.w - 8.0 / 3.0 * c.z, 0.0));
    for (var i = 0; i < 6; i++) {
        let p = (((x + c.w) * x + c.z) * x + c.y) * x + c.x;
        let slope = ((4.0 * x + 3.0 * c.w) * x + 2.0 * c.z) * x + c.y;
        let bend = (12.0 * x + 6.0 * c.w) * x + 2.0 * c.z;
        let root = sqrt(max(9.0 * slope * slope - 12.0 * p * bend, 0.0));
        let divisor = slope + select(-root, root, slope >= 0.0);
        if divisor != 0.0 {
            x -= 4.0 * p / divisor;
        }
    }
    var d: vec3f;
    if abs(x) > 1.0 {
        d.x = -c.x / x;
        d.y = (d.x - c.y) / x;
        d.z = (d.y - c.z) / x;
    } else {
        d.z = c.w + x;
        d.y = c.z + x * d.z;
        d.x = c.y + x * d.y;
    }
    return vec4f(x, cubic(vec4f(d, 1.0)));
}
