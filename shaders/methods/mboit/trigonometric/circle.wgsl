// Depths as angles, and complex numbers; as peelnet_core::methods::moments::trigonometric.

// Behind the farthest depth, an angle that no depth has.
const WRAPPING_ZONE: f32 = 0.31415927;

fn angle(zeta: f32) -> f32 {
    return (zeta + 1.0) * (3.1415927 - 0.5 * WRAPPING_ZONE);
}

fn turn(angle: f32) -> vec2f {
    return vec2f(cos(angle), sin(angle));
}

fn times(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

fn conjugate(a: vec2f) -> vec2f {
    return vec2f(a.x, -a.y);
}
