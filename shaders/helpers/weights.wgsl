// Published weights (McGuire & Bavoil 2013, eq 7-10; Papakostas 2022); as peelnet_core::weights.
// Loops: 1: the parameter k, at most 16.
fn weight_eq7(z: f32, alpha: f32) -> f32 {
    let a = z / 5.0;
    let b = z / 200.0;
    return alpha * clamp(10.0 / (1e-5 + a * a + b * b * b * b * b * b), 1e-2, 3e3);
}

fn weight_eq8(z: f32, alpha: f32) -> f32 {
    let a = z / 10.0;
    let b = z / 200.0;
    return alpha * clamp(10.0 / (1e-5 + a * a * a + b * b * b * b * b * b), 1e-2, 3e3);
}

fn weight_eq9(z: f32, alpha: f32) -> f32 {
    let a = z / 200.0;
    return alpha * clamp(0.03 / (1e-5 + a * a * a * a), 1e-2, 3e3);
}

fn weight_eq10(window_depth: f32, alpha: f32, factor: f32) -> f32 {
    let a = 1.0 - window_depth;
    return alpha * max(1e-2, factor * a * a * a);
}

fn weight_inverse_power(z: f32, k: u32, epsilon: f32) -> f32 {
    var w = 1.0;
    for (var i = 0u; i < k; i++) {
        w /= z + epsilon;
    }
    return w;
}

fn weight_smoke(z: f32, k: f32) -> f32 {
    let a = z * k;
    return 10.0 / (1.0 + 10.0 * (a * a * a * a * a));
}

fn weight_papakostas(z: f32, alpha: f32) -> f32 {
    let a = (1.0 - z) / 200.0;
    return alpha * clamp(min(0.3 / (1e-5 + a * a * a * a), 8.0), 1e-2, 1.0);
}
